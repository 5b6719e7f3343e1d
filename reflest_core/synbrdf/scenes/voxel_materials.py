# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Truth of an observation scene of several materials: one id for each voxel."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters, WardVariant


@dataclass(frozen=True)
class MaterialTruth:
    """A material and where it comes from.

    Attributes:
        ward: Ward parameters; ``rho_d`` is that of most of the surface.
        source: ``opensurfaces`` or ``measured``.
        name: Family or fit.
        part: What it covers, such as ``table``.
        texture: Kind of the pattern in ``rho_d``; ``plain`` without one.
    """

    ward: WardParameters
    source: str
    name: str
    part: str
    texture: str

    def card(self) -> dict[str, Any]:
        """For a file's header."""
        return {**dataclasses.asdict(self), "ward": ward_card(self.ward)}

    @classmethod
    def from_card(cls, card: dict[str, Any]) -> MaterialTruth:
        """Read what :meth:`card` returned.

        Args:
            card: From a file's header.
        """
        return cls(**{**card, "ward": ward_from_card(card["ward"])})


@dataclass(frozen=True)
class VoxelMaterials:
    """Materials of a scene and of each of its V voxels.

    Attributes:
        materials: By id.
        ids: (V,) uint16.
        rho_d: (V, 3) float32, diffuse albedo of each voxel, linear sRGB: texture shows here.
    """

    materials: tuple[MaterialTruth, ...]
    ids: NDArray[np.uint16]
    rho_d: NDArray[np.float32]

    def most_voxels(self) -> int:
        """Id of the material of most voxels."""
        return int(np.bincount(self.ids, minlength=len(self.materials)).argmax())


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
