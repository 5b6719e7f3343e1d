# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What every file format is written from: a mesh with materials, textures and light."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.environment.environment_map import EnvironmentMap
from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_core.export.errors import ExportError

Facts = dict[str, str | int | float | list[float]]
RINGS, SEGMENTS = 32, 64
RADIUS = 0.05
"""Of a swatch, metres."""


@dataclass(frozen=True)
class AssetMesh:
    """A triangle mesh in metres, z up.

    Attributes:
        vertices: (N, 3) float32.
        normals: (N, 3) float32, unit, outward.
        faces: (F, 3) int32, counter-clockwise from outside; a vertex belongs to faces of one
            material only.
        face_materials: (F,) int32, indices into the asset's materials.
        uv: (N, 2) float32 texture coordinates in [0, 1], v upward; None without a texture.
        attributes: Further values of each vertex by name, (N,) or (N, 3) float32.
    """

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.int32]
    face_materials: NDArray[np.int32]
    uv: NDArray[np.float32] | None = None
    attributes: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)

    def part(self, material: int) -> AssetMesh:
        """The faces of one material, with their vertices alone.

        Args:
            material: Index of the material.
        """
        faces = self.faces[self.face_materials == material]
        used, flat = np.unique(faces, return_inverse=True)
        return AssetMesh(
            self.vertices[used],
            self.normals[used],
            flat.reshape(-1, 3).astype(np.int32),
            np.zeros(len(faces), np.int32),
            None if self.uv is None else self.uv[used],
            {name: values[used] for name, values in self.attributes.items()},
        )


@dataclass(frozen=True)
class AssetMaterial:
    """One material.

    Attributes:
        name: Unique in the asset: a letter, then letters, digits and underscores.
        ward: The estimate.
        facts: The estimate's origin, values and deviations, which travel in the file.
        status: Name of the estimate's status.
    """

    name: str
    ward: WardParameters
    facts: Facts
    status: str = EstimateStatus.OK.name

    @staticmethod
    def of(estimate: BrdfEstimate, name: str, material_id: int | None = None) -> AssetMaterial:
        """Check an estimate and take it for a material.

        Args:
            estimate: The estimate.
            name: The material's name.
            material_id: Its id in the material map, if it has one.

        Raises:
            ExportError: A value is not physical; it is named.
        """
        ward = _ward(estimate)
        _check("rho_d", min(ward.rho_d) >= 0 and max(ward.rho_d) <= 1, "in [0, 1]", ward.rho_d)
        _check("rho_s", 0 <= ward.rho_s <= 1, "in [0, 1]", ward.rho_s)
        _check("alpha", 0 < ward.alpha < math.inf, "above 0", ward.alpha)
        facts: Facts = {
            "rho_d": list(ward.rho_d),
            "rho_s": ward.rho_s,
            "alpha": ward.alpha,
            "ward_variant": ward.variant.value,
            "model_id": estimate.model_id,
            # A string: 64 bits do not fit into the numbers of JSON.
            "stamp_ns": str(estimate.stamp_ns),
            "status": estimate.status.name,
            "status_text": estimate.status_text,
        }
        if material_id is not None:
            facts["material_id"] = material_id
        deviations: dict[str, float | list[float]] = {
            "rho_d_stddev": list(estimate.rho_d_stddev),
            "rho_s_stddev": estimate.rho_s_stddev,
            "alpha_stddev": estimate.alpha_stddev,
        }
        facts |= {key: value for key, value in deviations.items() if np.isfinite(value).all()}
        return AssetMaterial(name, ward, facts, estimate.status.name)


@dataclass(frozen=True)
class Asset:
    """A surface with its materials and light.

    Attributes:
        name: As :attr:`AssetMaterial.name`; names of files and nodes are made from it.
        mesh: The surface.
        materials: The materials that the mesh's faces point to.
        base_colour: (S, S, 3) uint8 sRGB texture of the microfacet base colour
            (:mod:`.microfacet_material`), row 0 at v = 1; None where each material has one colour.
        light: The environment of the scan, z up; None for none.
        light_file: Path of an environment file to refer to in place of ``light``, relative to the
            asset's folder; "" for none.
        is_swatch: Whether the mesh is the sphere of :func:`swatch`, which shows a material.
        origin: Where the mesh's coordinates begin in the world, turned to z up, metres: not 0 for
            scans far from the world's origin, whose vertices float32 could not hold.
    """

    name: str
    mesh: AssetMesh
    materials: tuple[AssetMaterial, ...]
    base_colour: NDArray[np.uint8] | None = None
    light: EnvironmentMap | None = None
    light_file: str = ""
    is_swatch: bool = False
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def is_far(self) -> bool:
        """Whether the mesh has an origin of its own."""
        return any(self.origin)

    @property
    def warning(self) -> str:
        """One sentence that names the doubtful estimates, or ""."""
        doubtful = [one for one in self.materials if one.status != EstimateStatus.OK.name]
        if not doubtful:
            return ""
        names = ", ".join(f"{one.name} ({one.status})" for one in doubtful[:8])
        more = f" and {len(doubtful) - 8} more" if len(doubtful) > 8 else ""
        verb = "has" if len(doubtful) == 1 else "have"
        total = len(self.materials)
        subject = "the material" if total == 1 else f"{len(doubtful)} of {total} materials"
        return f"{subject} {verb} a doubtful estimate: {names}{more}"


def _ward(estimate: BrdfEstimate) -> WardParameters:
    try:
        return estimate.ward
    except ValueError:
        known = ", ".join(variant.value for variant in WardVariant)
        raise ExportError(
            f"the estimate's ward_variant is {estimate.ward_variant!r}; known ones are {known}"
        ) from None


def _check(name: str, is_physical: bool, wanted: str, value: object) -> None:
    # NaN compares false, so that an unknown value fails as well.
    if not is_physical:
        raise ExportError(f"the estimate's {name} is {value}, which is not {wanted}")


def sphere_mesh() -> AssetMesh:
    """A sphere of radius :data:`RADIUS` around the origin."""
    polar = np.linspace(0, math.pi, RINGS + 1)[:, None]
    azimuth = np.linspace(0, 2 * math.pi, SEGMENTS, endpoint=False)[None]
    x, z = np.sin(polar) * np.cos(azimuth), np.broadcast_to(np.cos(polar), (RINGS + 1, SEGMENTS))
    y = np.sin(polar) * np.sin(azimuth)
    normals = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)

    ring, segment = np.meshgrid(np.arange(RINGS), np.arange(SEGMENTS), indexing="ij")
    upper, upper_next = ring * SEGMENTS + segment, ring * SEGMENTS + (segment + 1) % SEGMENTS
    lower, lower_next = upper + SEGMENTS, upper_next + SEGMENTS
    # At a pole one triangle of each quadrilateral has no area.
    below_first = np.stack([upper, lower, upper_next], axis=-1)[1:].reshape(-1, 3)
    above_last = np.stack([upper_next, lower, lower_next], axis=-1)[:-1].reshape(-1, 3)
    faces = np.concatenate([below_first, above_last]).astype(np.int32)
    used, flat = np.unique(faces, return_inverse=True)
    return AssetMesh(
        normals[used] * np.float32(RADIUS),
        normals[used],
        flat.reshape(-1, 3).astype(np.int32),
        np.zeros(len(faces), np.int32),
    )


def swatch(estimate: BrdfEstimate, light_file: str = "") -> Asset:
    """The sphere with an estimate's material.

    Args:
        estimate: The material.
        light_file: Path of an environment file from the swatch's folder, or "".

    Raises:
        ExportError: A value of the estimate is not physical.
    """
    material = AssetMaterial.of(estimate, "reflest_material")
    return Asset("reflest", sphere_mesh(), (material,), light_file=light_file, is_swatch=True)
