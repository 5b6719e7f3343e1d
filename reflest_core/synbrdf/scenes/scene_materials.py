# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The true materials of a scene, one or many, and the material of each voxel."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.synbrdf.scenes.material_sources import MaterialSource, NamedMaterial

PLAIN = "plain"
"""Texture of a material without a pattern."""
OBJECT = "object"
"""Part of the only material of a scene; names of objects among others begin with it."""


@dataclass(frozen=True)
class SceneMaterial:
    """A material of a scene and where it comes from.

    Attributes:
        ward: Ward parameters; ``rho_d`` is that of most of the surface.
        source: ``opensurfaces`` or ``measured``.
        name: Family or fit.
        part: What it covers, such as ``table``.
        texture: Kind of the pattern in ``rho_d``; ``plain`` without one.
    """

    ward: WardParameters
    source: str = MaterialSource.OPENSURFACES.value
    name: str = MaterialSource.OPENSURFACES.value
    part: str = OBJECT
    texture: str = PLAIN

    @classmethod
    def of(cls, named: NamedMaterial, part: str = OBJECT, texture: str = PLAIN) -> SceneMaterial:
        """A drawn material as one of a scene's.

        Args:
            named: The material.
            part: What it covers.
            texture: Kind of the pattern in its albedo.
        """
        return cls(named.ward, named.source.value, named.name, part, texture)

    def card(self) -> dict[str, Any]:
        """For a file's header."""
        return {**dataclasses.asdict(self), "ward": ward_card(self.ward)}

    @classmethod
    def from_card(cls, card: dict[str, Any]) -> SceneMaterial:
        """Read what :meth:`card` returned.

        Args:
            card: From a file's header.
        """
        return cls(**{**card, "ward": ward_from_card(card["ward"])})


@dataclass(frozen=True)
class VoxelMaterials:
    """Materials of a scene, one or many, and of each of its V voxels.

    Attributes:
        materials: By id.
        ids: (V,) uint16.
        rho_d: (V, 3) float32, diffuse albedo of each voxel, linear sRGB: texture shows here.
        dominant_id: Id of the material of the largest area.
    """

    materials: tuple[SceneMaterial, ...]
    ids: NDArray[np.uint16]
    rho_d: NDArray[np.float32]
    dominant_id: int = 0

    @classmethod
    def uniform(cls, material: SceneMaterial, voxels: int) -> VoxelMaterials:
        """All voxels of one material.

        Args:
            material: The material.
            voxels: How many there are.
        """
        rho_d = np.tile(np.array(material.ward.rho_d, np.float32), (voxels, 1))
        return cls((material,), np.zeros(voxels, np.uint16), rho_d)

    @property
    def dominant(self) -> SceneMaterial:
        """The material of the largest area; the only one of a scene of one."""
        return self.materials[self.dominant_id]


def ward_card(ward: WardParameters) -> dict[str, Any]:
    """Ward parameters for a file's header.

    Args:
        ward: The parameters.
    """
    values = {"rho_d": ward.rho_d, "rho_s": ward.rho_s, "alpha": ward.alpha}
    return {**values, "variant": ward.variant.value}


def ward_from_card(card: dict[str, Any]) -> WardParameters:
    """Read what :func:`ward_card` returned.

    Args:
        card: From a file's header.
    """
    red, green, blue = card["rho_d"]
    variant = WardVariant(card["variant"])
    return WardParameters((red, green, blue), card["rho_s"], card["alpha"], variant)
