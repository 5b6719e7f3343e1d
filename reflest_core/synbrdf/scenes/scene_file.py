# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""SynBRDF scenes on disk: shards of scenes in one safetensors file each, and a manifest."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.errors import ReflestError
from reflest_core.surface.observed_surface import SURFACE_ARRAYS, ObservedSurface
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails
from reflest_core.whole_file import write_whole

FORMAT = "synbrdf-sparse-2"
NEAR_FORMAT = "synbrdf-sparse-3"
"""The same, and the depth of every thumbnail: of scenes in rooms."""
MANIFEST = "manifest.json"


class SceneFileError(ReflestError):
    """A shard or manifest is missing, damaged or of another format."""


@dataclass(frozen=True)
class SynbrdfScene:
    """What was seen of one scene, the truth, and how the scene came about.

    ``exposure``: factor from ``radiance`` to the sensor's [0, 1]. ``radiance``: (O, 3) float16,
    linear sRGB of every observation. ``environment_rotation``: radians about the vertical.
    """

    surface: ObservedSurface
    truth: WardParameters
    split: str
    index: int
    environment: str
    environment_rotation: float
    shape: str
    view_pattern: str
    exposure: float
    radiance: NDArray[np.float16]
    thumbnails: Thumbnails


def save_shard(path: Path, scenes: list[SynbrdfScene]) -> None:
    """Write atomically; equal scenes give equal bytes.

    Args:
        path: the file.
        scenes: of the data set.
    """
    write_whole(path, shard_bytes(scenes))


def shard_bytes(scenes: list[SynbrdfScene]) -> bytes:
    """A shard's file; equal scenes give equal bytes.

    Args:
        scenes: of the data set.
    """
    arrays: dict[str, NDArray[Any]] = {}
    cards = []
    for number, scene in enumerate(scenes):
        for name in SURFACE_ARRAYS:
            arrays[f"{number:03d}/{name}"] = getattr(scene.surface, name)
        thumbnails = scene.thumbnails
        arrays[f"{number:03d}/radiance"] = scene.radiance
        arrays[f"{number:03d}/rgbe"] = thumbnails.rgbe
        arrays[f"{number:03d}/is_object"] = np.packbits(thumbnails.is_object, axis=-1)
        arrays[f"{number:03d}/T_world_camera"] = thumbnails.T_world_camera
        if thumbnails.depth is not None:
            arrays[f"{number:03d}/depth"] = thumbnails.depth
        cards.append(_card(scene))
    is_near = any(scene.thumbnails.depth is not None for scene in scenes)
    metadata = {
        "format": NEAR_FORMAT if is_near else FORMAT,
        "scenes": json.dumps(cards, sort_keys=True),
    }
    return _with_sorted_header(save(arrays, metadata))


def _with_sorted_header(data: bytes) -> bytes:
    """Order the header's keys: safetensors leaves its metadata in an order of chance."""
    end = 8 + int.from_bytes(data[:8], "little")
    header = json.dumps(json.loads(data[8:end]), sort_keys=True, separators=(",", ":")).encode()
    header += b" " * (-len(header) % 8)
    return len(header).to_bytes(8, "little") + header + data[end:]


def load_shard(path: Path) -> list[SynbrdfScene]:
    """All scenes of one shard; :class:`SceneFileError` names a file that cannot be used.

    Args:
        path: a shard.
    """
    try:
        with safe_open(path, framework="numpy") as file:
            metadata = file.metadata() or {}
            if metadata.get("format") not in (FORMAT, NEAR_FORMAT):
                raise SceneFileError(
                    f"{path} is not a {FORMAT} or {NEAR_FORMAT} shard; generate the data again"
                )
            cards = json.loads(metadata["scenes"])
            return [_scene(file, number, card) for number, card in enumerate(cards)]
    except (SafetensorError, OSError) as error:
        raise SceneFileError(
            f"{path} is damaged ({error}); delete it and generate again"
        ) from error


def load_scenes(folder: Path, split: str) -> Iterator[SynbrdfScene]:
    """Scenes of one split, in order, from every shard that is there.

    Args:
        folder: of the data set, or to write into.
        split: train, validation or unseen.
    """
    if not (folder / MANIFEST).is_file():
        raise SceneFileError(f"{folder} has no {MANIFEST}; make it with 'reflest synbrdf generate'")
    for path in sorted(folder.glob(f"{split}-*.safetensors")):
        yield from load_shard(path)


def sha256(path: Path) -> str:
    """Hash (hex) of a file's bytes.

    Args:
        path: the file.
    """
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _card(scene: SynbrdfScene) -> dict[str, Any]:
    truth = scene.truth
    card = {
        field.name: getattr(scene, field.name)
        for field in fields(scene)
        if field.name not in ("surface", "truth", "radiance", "thumbnails")
    }
    ward = {"rho_d": truth.rho_d, "rho_s": truth.rho_s, "alpha": truth.alpha}
    return {**card, "truth": {**ward, "variant": truth.variant.value}}


def _scene(file: Any, number: int, card: dict[str, Any]) -> SynbrdfScene:
    arrays = {name: file.get_tensor(f"{number:03d}/{name}") for name in SURFACE_ARRAYS}
    truth = card.pop("truth")
    red, green, blue = truth["rho_d"]
    ward = WardParameters(
        (red, green, blue), truth["rho_s"], truth["alpha"], WardVariant(truth["variant"])
    )
    images, object_bits, poses, radiance = (
        file.get_tensor(f"{number:03d}/{name}")
        for name in ("rgbe", "is_object", "T_world_camera", "radiance")
    )
    depth_name = f"{number:03d}/depth"
    depth = file.get_tensor(depth_name) if depth_name in file.keys() else None  # noqa: SIM118
    is_object = np.unpackbits(object_bits, axis=-1, count=images.shape[2]).astype(np.bool_)
    return SynbrdfScene(
        surface=ObservedSurface(**arrays),
        truth=ward,
        radiance=radiance,
        thumbnails=Thumbnails(images, is_object, poses, depth),
        **card,
    )
