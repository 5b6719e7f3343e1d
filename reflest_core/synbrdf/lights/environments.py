# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Environment maps: distant light from every direction, as lat-long images.

Convention: z up; row 0 is the zenith. A direction of azimuth ``phi = atan2(y, x)`` lies at the
column ``u = 0.5 - phi / (2 pi)`` (a fraction of the width), so the image shows what a viewer at its
centre sees, unmirrored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.array_file import array_names, read_member
from reflest_core.errors import ReflestError
from reflest_core.light.environment_reader import LARGEST_RADIANCE, read_radiance
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.synbrdf.lights.cubemap import look_up, read_cubemap
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky

CUBEMAP_HEIGHT = 512
"""Rows at which a cube map is looked up before its areas are averaged."""
SKY_PREFIX = "sky-"
"""Procedural skies are named by their seed, ``sky-0`` and so on."""


class EnvironmentUnreadable(ReflestError):
    """An environment file cannot be used."""


@dataclass(frozen=True)
class EnvironmentSource:
    """One environment that :func:`load_environment` can read.

    Attributes:
        name: Of the environment.
        path: Its file; None for a procedural sky.
        member: Its name inside a collection.
    """

    name: str
    path: Path | None = None
    member: str | None = None


def procedural_skies(count: int) -> list[EnvironmentSource]:
    """List the skies that need no file.

    Args:
        count: skies.
    """
    return [EnvironmentSource(f"{SKY_PREFIX}{seed}") for seed in range(count)]


def find_environments(path: Path) -> list[EnvironmentSource]:
    """List the environments in a file or folder, sorted by name.

    Reads .hdr and .exr files, .ktx cube maps (``NAME_skybox.ktx`` of Open3D, say), and .npz
    collections of ``NAME`` (H, W, 3) in linear Rec. 709.

    Args:
        path: a file, or a folder of them.
    """
    if not path.exists():
        raise EnvironmentUnreadable(f"there is no environment file or folder at {path}")
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    sources: list[EnvironmentSource] = []
    for file in files:
        if file.suffix.lower() in (".hdr", ".exr", ".ktx"):
            sources.append(EnvironmentSource(file.stem, file))
        elif file.suffix.lower() == ".npz":
            sources += [EnvironmentSource(name, file, name) for name in _collection_names(file)]
    if not sources:
        raise EnvironmentUnreadable(
            f"{path} holds no environment: it needs .hdr, .exr, .ktx or .npz files"
        )
    return sorted(sources, key=lambda source: source.name)


@lru_cache(maxsize=256)
def load_environment(source: EnvironmentSource, height: int = 128) -> NDArray[np.float32]:
    """Return radiance (height, 2 * height, 3), linear Rec. 709, no texel negative.

    Areas are averaged where the file is larger, so that small lamps keep their power.

    Args:
        source: the file or procedural kind.
        height: rows of the equirectangular map.
    """
    if source.path is None:
        seed = int(source.name.removeprefix(SKY_PREFIX))
        return procedural_sky(seed, height)
    try:
        image = _read(source)
    except (OSError, ValueError, KeyError) as error:
        raise EnvironmentUnreadable(
            f"environment {source.name} in {source.path} is unreadable: {error}"
        ) from error
    if image.ndim != 3 or image.shape[2] < 3 or min(image.shape[:2]) < 2:
        raise EnvironmentUnreadable(
            f"environment {source.name} has shape {image.shape}, but must be (H, W, 3)"
        )
    radiance = np.asarray(image[..., :3], dtype=np.float32)
    if not (np.abs(radiance) < LARGEST_RADIANCE).all():
        raise EnvironmentUnreadable(
            f"environment {source.name} holds radiance that is not below {LARGEST_RADIANCE:g}"
        )
    radiance = np.maximum(radiance, 0.0)
    if not radiance.any():
        raise EnvironmentUnreadable(f"environment {source.name} is black")
    return resample(radiance, height)


def load_environments(sources: Sequence[EnvironmentSource]) -> dict[str, NDArray[np.float32]]:
    """Each by its name, as :func:`load_environment` returns it.

    Args:
        sources: files or procedural skies.
    """
    return {source.name: load_environment(source) for source in sources}


def resample(radiance: NDArray[np.float32], height: int) -> NDArray[np.float32]:
    """Resize (H, W, 3) to (height, 2 * height, 3) by area where it shrinks.

    Args:
        radiance: linear radiance.
        height: rows of the equirectangular map.
    """
    import cv2

    width = 2 * height
    if radiance.shape[:2] == (height, width):
        return radiance
    shrinks = radiance.shape[0] > height
    method = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(radiance, (width, height), interpolation=method), np.float32)


def rotated(radiance: NDArray[np.float32], angle: float) -> NDArray[np.float32]:
    """Turn an environment anticlockwise about the world's z axis.

    Args:
        radiance: (H, 2 H, 3) linear radiance, equirectangular.
        angle: radians.
    """
    width = radiance.shape[1]
    columns = (np.arange(width) + angle / (2.0 * np.pi) * width) % width
    left = np.floor(columns).astype(np.int64)
    share = (columns - left).astype(np.float32)[None, :, None]
    turned = radiance[:, left % width] * (1 - share) + radiance[:, (left + 1) % width] * share
    return np.asarray(turned, np.float32)


def _collection_names(path: Path) -> list[str]:
    try:
        return array_names(path)
    except (OSError, ValueError) as error:
        raise EnvironmentUnreadable(f"{path} is not a readable .npz file: {error}") from error


def _read(source: EnvironmentSource) -> NDArray[np.float32]:
    assert source.path is not None
    if source.member is not None:
        return np.asarray(read_member(source.path, source.member), np.float32)
    if source.path.suffix.lower() == ".ktx":
        return look_up(read_cubemap(source.path), equirectangular_directions(CUBEMAP_HEIGHT))
    return read_radiance(source.path).radiance
