# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Weight files: safetensors with everything that is needed to use and to check them.

Matrices may be stored as 8-bit integers with one scale for each output channel, so that Grouplet
fits the paper's 340 KB.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.errors import ReflestError
from reflest_core.models.card import WeightsCard
from reflest_core.whole_file import write_whole

FORMAT = "reflest-weights-1"
SCALE_SUFFIX = ".scale"
LARGEST_FILE_MB = 512
STORED_TYPES = ("F32", "I8")
"""Of tensors, as safetensors names them."""

Tensors = dict[str, NDArray[Any]]
"""A network's weights by name, shaped as PyTorch stores them."""


class WeightsError(ReflestError):
    """A weight file is missing, damaged or made for something else."""


def save_weights(
    path: Path, tensors: Mapping[str, Any], card: WeightsCard, eight_bit: bool
) -> None:
    """Write a weight file, whole or not at all.

    Args:
        path: Of the file.
        tensors: Arrays or PyTorch tensors by name.
        card: What the file says of its network.
        eight_bit: Store matrices as by :func:`quantise`.
    """
    stored = {name: _as_array(tensor) for name, tensor in tensors.items()}
    if eight_bit:
        stored = quantise(stored)
    described = card.to_json()
    metadata = {"format": FORMAT, "card": described, "sha256": content_hash(stored, described)}
    write_whole(path, save(stored, metadata))


def load_weights(path: Path) -> tuple[Tensors, WeightsCard, str]:
    """Read a weight file.

    Args:
        path: Of the file.

    Returns:
        The tensors in float32, the card, and the checked hash (hex).

    Raises:
        WeightsError: There is no such file, it is damaged, or of another format.
    """
    if not os.path.isfile(path):
        raise WeightsError(f"there is no weight file {path}; correct estimation.weights")
    stored, metadata = _stored(path)
    if metadata.get("format") != FORMAT:
        raise WeightsError(
            f"{path} has format {metadata.get('format')!r:.40}, not {FORMAT!r}; "
            "use weights written by this version of reflest"
        )
    described = metadata.get("card", "")
    digest = content_hash(stored, described)
    if digest != metadata.get("sha256"):
        raise WeightsError(f"{path} does not match its own hash: it is damaged; install it again")
    try:
        card, tensors = WeightsCard.from_json(described), dequantise(stored)
    except ValueError as error:
        raise WeightsError(
            f"{path} describes no network that can be used ({error!s:.200}); use weights written "
            "by this version of reflest"
        ) from error
    for name, tensor in tensors.items():
        if not np.isfinite(tensor).all():
            raise WeightsError(
                f"{path}: {name} holds numbers that are not finite; train the network again, or "
                "use other weights"
            )
    return tensors, card, digest


def _stored(path: Path) -> tuple[Tensors, dict[str, str]]:
    """The tensors and metadata as the file holds them; sizes and types are checked first."""
    size_mb = path.stat().st_size / 1e6
    if size_mb > LARGEST_FILE_MB:
        raise WeightsError(
            f"{path} has {size_mb:.0f} MB, more than the {LARGEST_FILE_MB} MB of any network; "
            "correct estimation.weights"
        )
    try:
        with safe_open(path, framework="np") as file:
            names = list(file.keys())
            for name in names:
                kind = file.get_slice(name).get_dtype()
                if kind not in STORED_TYPES:
                    raise WeightsError(
                        f"{path}: {name:.80} is of type {kind}, not {' or '.join(STORED_TYPES)}; "
                        "use weights written by this version of reflest"
                    )
            return {name: file.get_tensor(name) for name in names}, file.metadata() or {}
    except (SafetensorError, OSError, ValueError) as error:
        raise WeightsError(f"{path} is not a readable safetensors file ({error!s:.200})") from error


def check_fits(tensors: Tensors, shapes: Mapping[str, tuple[int, ...]], path: Path) -> None:
    """Check that a file's tensors are those of its network.

    Args:
        tensors: By name.
        shapes: Shapes that the network's tensors have, by name.
        path: Of the file, for the sentence.

    Raises:
        WeightsError: A tensor is missing, unknown or of another shape.
    """
    for name in sorted(shapes.keys() | tensors.keys()):
        found = tensors[name].shape if name in tensors else None
        if found != shapes.get(name):
            raise WeightsError(
                f"{path} does not fit its network: {name} has shape {found}, not "
                f"{shapes.get(name)}; use weights written by this version of reflest"
            )


def quantise(tensors: Tensors) -> Tensors:
    """Store every matrix as int8 beside ``<name>.scale``; vectors (biases) stay float32.

    Args:
        tensors: By name.
    """
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
    """Undo :func:`quantise` in float32; tensors that are not int8 pass unchanged.

    Args:
        stored: Tensors as the file holds them.

    Raises:
        ValueError: A tensor's scale is missing or of another length.
    """
    tensors: Tensors = {}
    for name, tensor in stored.items():
        if name.endswith(SCALE_SUFFIX):
            continue
        if tensor.dtype == np.int8:
            scale = stored.get(name + SCALE_SUFFIX)
            if scale is None or tensor.ndim < 2 or scale.shape != (len(tensor),):
                raise ValueError(f"{name} has no scale for each of its rows")
            tensor = tensor.astype(np.float32) * scale.reshape(-1, *[1] * (tensor.ndim - 1))
        tensors[name] = tensor
    return tensors


def content_hash(stored: Tensors, card: str) -> str:
    """SHA-256 (hex) over the card and every tensor's name, type, shape and bytes, by name.

    Types are spelt as PyTorch does, which wrote the first files.

    Args:
        stored: Tensors as the file holds them.
        card: The card's JSON.
    """
    digest = hashlib.sha256(card.encode())
    for name in sorted(stored):
        tensor = stored[name]
        digest.update(f"{name} torch.{tensor.dtype} {tensor.shape}".encode())
        digest.update(tensor.tobytes())
    return digest.hexdigest()


def _as_array(tensor: Any) -> NDArray[Any]:
    if hasattr(tensor, "detach"):
        tensor = tensor.detach().cpu()
    return np.ascontiguousarray(tensor)
