"""8-bit weights: one scale for each output channel, so that Grouplet fits the paper's 340 KB."""

from __future__ import annotations

import torch

SCALE_SUFFIX = ".scale"

Tensors = dict[str, torch.Tensor]


def quantise(tensors: Tensors) -> Tensors:
    """Store every matrix as int8 beside ``<name>.scale``; vectors (biases) stay float32."""
    stored: Tensors = {}
    for name, tensor in tensors.items():
        if tensor.ndim < 2:
            stored[name] = tensor
            continue
        scale = tensor.abs().flatten(1).amax(dim=1).clamp(min=1e-12) / 127
        rows = scale.view(-1, *[1] * (tensor.ndim - 1))
        stored[name] = torch.round(tensor / rows).to(torch.int8)
        stored[name + SCALE_SUFFIX] = scale
    return stored


def dequantise(stored: Tensors) -> Tensors:
    """Float32 tensors from :func:`quantise`'s; tensors that are not int8 pass unchanged."""
    tensors: Tensors = {}
    for name, tensor in stored.items():
        if name.endswith(SCALE_SUFFIX):
            continue
        if tensor.dtype == torch.int8:
            scale = stored[name + SCALE_SUFFIX]
            tensor = tensor.float() * scale.view(-1, *[1] * (tensor.ndim - 1))
        tensors[name] = tensor
    return tensors
