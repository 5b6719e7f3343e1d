# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""HemiCNN as it runs while scanning: NumPy alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from reflest_core.brdf.parameters import PARAMETERS
from reflest_core.inference.material import Explanation
from reflest_core.models.definition import Scores
from reflest_core.models.hemicnn.hemisphere_images import hemisphere_images
from reflest_core.models.linear_algebra import DenseLayer, one_blas_thread
from reflest_core.models.weights import Tensors
from reflest_core.surface.observed_surface import ObservedSurface

SHAPES: dict[str, tuple[int, ...]] = {
    "conv1.weight": (16, 3, 3, 3),
    "conv1.bias": (16,),
    "conv2.weight": (16, 16, 3, 3),
    "conv2.bias": (16,),
    "fc1.weight": (64, 16 * 3 * 3),
    "fc1.bias": (64,),
    "fc2.weight": (32, 64),
    "fc2.bias": (32,),
    "fc3.weight": (5, 32),
    "fc3.bias": (len(PARAMETERS),),
}

Array = NDArray[np.float32]


class LiveHemiCNN:
    """The network of ``models/hemicnn/network.py`` with ``tensors`` of :data:`SHAPES`."""

    def __init__(self, tensors: Tensors) -> None:
        """Take the weights.

        Args:
            tensors: The trained weights by name.
        """
        # The channel comes last here, so that a patch is copied in long runs.
        self._conv1 = _channels_last(tensors["conv1.weight"], tensors["conv1.bias"])
        self._conv2 = _channels_last(tensors["conv2.weight"], tensors["conv2.bias"])
        pooled = tensors["fc1.weight"].reshape(64, 16, 3, 3)
        self._fc1 = _channels_last(pooled, tensors["fc1.bias"])
        self._fc2 = DenseLayer.of(tensors, "fc2")
        self._fc3 = DenseLayer.of(tensors, "fc3")

    def scores(
        self,
        surface: ObservedSurface,
        choices: Sequence[NDArray[np.int64]],
        found: Explanation | None = None,
    ) -> list[Scores]:
        """Estimate from the hemisphere images of the voxels.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            choices: (N,) indices of voxels, all observed, of each choice.
            found: The material in the light of its scene; not used, for the network sees no light.
        """
        images = (hemisphere_images(surface, voxels) for voxels in choices)
        return [Scores(self.evaluate(of_choice)) for of_choice in images]

    def evaluate(self, images: Array) -> Array:
        """Estimate (5,) z-scored parameters.

        Args:
            images: (N, 3, 10, 10), colours in [0, 1].
        """
        with one_blas_thread():
            values: Array = np.ascontiguousarray(images.transpose(0, 2, 3, 1))
            values = _convolve(values, self._conv1)
            values = _convolve(values, self._conv2)
            pooled = values.reshape(-1, 3, 2, 3, 2, 16).max(axis=(2, 4))
            described = self._fc1.linear(pooled.reshape(len(images), -1))
            return self._fc3.linear(self._fc2.tanh(described.max(axis=0)))


def _channels_last(weight: Array, bias: Array) -> DenseLayer:
    """Weights (outputs, inputs, 3, 3) for patches (3 * 3 * inputs) with the channel last."""
    return DenseLayer(
        np.ascontiguousarray(weight.transpose(2, 3, 1, 0).reshape(-1, len(weight))), bias
    )


def _convolve(values: Array, layer: DenseLayer) -> Array:
    """Valid 3 x 3 convolution of (N, H, W, C) values, then ReLU."""
    patches = sliding_window_view(values, (3, 3), axis=(1, 2)).transpose(0, 1, 2, 4, 5, 3)
    products = layer.linear(patches.reshape(-1, len(layer.weight)))
    np.maximum(products, 0, out=products)
    return products.reshape(*patches.shape[:3], -1)
