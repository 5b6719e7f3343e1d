# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""SynBRDF scenes on disk: shards of scenes in one safetensors file each, and a manifest."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.errors import ReflestError
from reflest_core.surface.observed_surface import SURFACE_ARRAYS, ObservedSurface
from reflest_core.synbrdf.scenes.material_sources import MaterialSource
from reflest_core.synbrdf.scenes.scene_materials import (
    SceneMaterial,
    VoxelMaterials,
    ward_card,
    ward_from_card,
)
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails

FORMAT = "synbrdf-sparse-2"
NEAR_FORMAT = "synbrdf-sparse-3"
"""The same, and the depth of every thumbnail: of scenes in rooms."""
SV_FORMAT = "synbrdf-sv-1"
"""Scenes of several materials: the same, and a material and an albedo for each voxel."""
MANIFEST = "manifest.json"


class SceneFileError(ReflestError):
    """A shard or manifest is missing, damaged or of another format."""


@dataclass(frozen=True)
class SynbrdfScene:
    """What was seen of one scene, the truth, and how the scene came about.

    Attributes:
        surface: Voxels and their observations.
        materials: The truth: materials of the scene, and of each voxel.
        split: Name of the split.
        index: Within the split.
        environment: Name of the light.
        environment_rotation: Radians about the vertical.
        shape: Name of the shape, or names joined by ``+``.
        view_pattern: How the views are spread.
        exposure: Factor from ``radiance`` to the sensor's [0, 1].
        radiance: (O, 3) float16, linear sRGB of every observation.
        thumbnails: A small image of every view.
    """

    surface: ObservedSurface
    materials: VoxelMaterials
    split: str
    index: int
    environment: str
    environment_rotation: float
    shape: str
    view_pattern: str
    exposure: float
    radiance: NDArray[np.float16]
    thumbnails: Thumbnails

    def parts(self) -> list[SynbrdfScene]:
        """A scene of each material that has voxels; a scene of one material itself."""
        if len(self.materials.materials) == 1:
            return [self]
        return [self.of_material(int(number)) for number in np.unique(self.materials.ids)]

    def of_material(self, number: int) -> SynbrdfScene:
        """The voxels of one material alone, as a scene of that material.

        Args:
            number: The material's id.

        Raises:
            SceneFileError: If the scene has no material of that id.
        """
        if not 0 <= number < len(self.materials.materials):
            raise SceneFileError(f"{self.split} scene {self.index} has no material {number}")
        surface = self.surface
        chosen = self.materials.ids == number
        counts = surface.observation_counts
        observed = np.repeat(chosen, counts)
        part = replace(
            surface,
            positions=surface.positions[chosen],
            normals=surface.normals[chosen],
            offsets=np.concatenate([[0], np.cumsum(counts[chosen])]),
            colours=surface.colours[observed],
            view_indices=surface.view_indices[observed],
        )
        return replace(
            self,
            surface=part,
            materials=VoxelMaterials.uniform(self.materials.materials[number], int(chosen.sum())),
            radiance=self.radiance[observed],
        )


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
        if _has_several(scene):
            arrays[f"{number:03d}/material_ids"] = scene.materials.ids
            arrays[f"{number:03d}/voxel_rho_d"] = scene.materials.rho_d
        cards.append(_card(scene))
    is_near = any(scene.thumbnails.depth is not None for scene in scenes)
    has_materials = any(map(_has_several, scenes))
    metadata = {
        "format": SV_FORMAT if has_materials else NEAR_FORMAT if is_near else FORMAT,
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
            if metadata.get("format") not in (FORMAT, NEAR_FORMAT, SV_FORMAT):
                raise SceneFileError(
                    f"{path} is not a {FORMAT}, {NEAR_FORMAT} or {SV_FORMAT} shard; generate the "
                    "data again"
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


def _has_several(scene: SynbrdfScene) -> bool:
    return len(scene.materials.materials) > 1


def _card(scene: SynbrdfScene) -> dict[str, Any]:
    card = {
        field.name: getattr(scene, field.name)
        for field in fields(scene)
        if field.name not in ("surface", "materials", "radiance", "thumbnails")
    }
    dominant = scene.materials.dominant
    # Files of the paper's materials and of one material stay as they have always been.
    if dominant.source != MaterialSource.OPENSURFACES.value:
        card |= {"material_source": dominant.source, "material_name": dominant.name}
    if _has_several(scene):
        card["materials"] = [material.card() for material in scene.materials.materials]
    return {**card, "truth": ward_card(dominant.ward)}


def _materials(file: Any, number: int, card: dict[str, Any], voxels: int) -> VoxelMaterials:
    """Take a scene's materials out of its card."""
    ward = ward_from_card(card.pop("truth"))
    source = card.pop("material_source", MaterialSource.OPENSURFACES.value)
    name = card.pop("material_name", MaterialSource.OPENSURFACES.value)
    if "materials" not in card:
        return VoxelMaterials.uniform(SceneMaterial(ward, source, name), voxels)
    materials = tuple(SceneMaterial.from_card(one) for one in card.pop("materials"))
    dominant = [(one.ward, one.source, one.name) for one in materials].index((ward, source, name))
    ids, rho_d = (file.get_tensor(f"{number:03d}/{key}") for key in ("material_ids", "voxel_rho_d"))
    return VoxelMaterials(materials, ids, rho_d, dominant)


def _scene(file: Any, number: int, card: dict[str, Any]) -> SynbrdfScene:
    arrays = {name: file.get_tensor(f"{number:03d}/{name}") for name in SURFACE_ARRAYS}
    surface = ObservedSurface(**arrays)
    materials = _materials(file, number, card, surface.voxel_count)
    images, object_bits, poses, radiance = (
        file.get_tensor(f"{number:03d}/{name}")
        for name in ("rgbe", "is_object", "T_world_camera", "radiance")
    )
    depth_name = f"{number:03d}/depth"
    depth = file.get_tensor(depth_name) if depth_name in file.keys() else None  # noqa: SIM118
    is_object = np.unpackbits(object_bits, axis=-1, count=images.shape[2]).astype(np.bool_)
    return SynbrdfScene(
        surface=surface,
        materials=materials,
        radiance=radiance,
        thumbnails=Thumbnails(images, is_object, poses, depth),
        **card,
    )
