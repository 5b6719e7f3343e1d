# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A fully connected layer in NumPy."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.quantisation import Tensors

Array = NDArray[np.float32]


class DenseLayer(NamedTuple):
    """``weight``: (inputs, outputs) float32. ``bias``: (outputs,) float32."""

    weight: Array
    bias: Array

    @staticmethod
    def of(tensors: Tensors, name: str) -> DenseLayer:
        """The layer stored as PyTorch does, ``<name>.weight`` (outputs, inputs) and the bias."""
        return DenseLayer(
            np.ascontiguousarray(tensors[f"{name}.weight"].T), tensors[f"{name}.bias"]
        )

    def linear(self, values: Array, space: Array | None = None) -> Array:
        """(..., outputs) for (..., inputs), in the first rows of ``space`` if that is given."""
        out = None if space is None else space[: len(values)]
        products: Array = np.matmul(values, self.weight, out=out)
        products += self.bias
        return products

    def tanh(self, values: Array, space: Array | None = None) -> Array:
        """The same with tanh after it."""
        products = self.linear(values, space)
        return np.tanh(products, out=products)
