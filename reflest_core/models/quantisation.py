# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""8-bit weights: one scale for each output channel, so that Grouplet fits the paper's 340 KB."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

SCALE_SUFFIX = ".scale"

Tensors = dict[str, NDArray[Any]]


def quantise(tensors: Tensors) -> Tensors:
    """Store every matrix as int8 beside ``<name>.scale``; vectors (biases) stay float32."""
    stored: Tensors = {}
    for name, tensor in tensors.items():
        if tensor.ndim < 2:
            stored[name] = tensor
            continue
        rows = tensor.reshape(len(tensor), -1)
        scale = np.maximum(np.abs(rows).max(axis=1), np.float32(1e-12)) / np.float32(127)
        stored[name] = np.rint(rows / scale[:, None]).astype(np.int8).reshape(tensor.shape)
        stored[name + SCALE_SUFFIX] = scale
    return stored


def dequantise(stored: Tensors) -> Tensors:
    """Float32 tensors from :func:`quantise`'s; tensors that are not int8 pass unchanged."""
    tensors: Tensors = {}
    for name, tensor in stored.items():
        if name.endswith(SCALE_SUFFIX):
            continue
        if tensor.dtype == np.int8:
            scale = stored[name + SCALE_SUFFIX]
            tensor = tensor.astype(np.float32) * scale.reshape(-1, *[1] * (tensor.ndim - 1))
        tensors[name] = tensor
    return tensors
