# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where a scene's materials come from; every scene names its source."""

from __future__ import annotations

import enum
import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.brdf.parameters import WardParameters
from reflest_core.errors import ReflestError
from reflest_core.synbrdf.scenes.materials import draw_material
from reflest_core.synbrdf.scenes.measured_materials import draw_measured, fits_bytes, read_fits


class MaterialSource(enum.Enum):
    """A distribution of materials."""

    OPENSURFACES = "opensurfaces"
    """The paper's: :func:`.materials.draw_material`."""
    MEASURED = "measured"
    """That of measured materials: :mod:`.measured_materials`."""
    GIVEN = "given"
    """None: the user chose the material."""


class MaterialsRefused(ReflestError):
    """Materials were asked for that do not exist."""


@dataclass(frozen=True)
class NamedMaterial:
    """A material and where it comes from.

    Attributes:
        ward: Ward parameters, linear sRGB.
        source: The distribution.
        name: ``opensurfaces``, a family of measured materials, or the name of a fit.
    """

    ward: WardParameters
    source: MaterialSource
    name: str

    @classmethod
    def given(cls, ward: WardParameters) -> NamedMaterial:
        """A material that the user chose.

        Args:
            ward: Ward parameters, linear sRGB.
        """
        return cls(ward, MaterialSource.GIVEN, MaterialSource.GIVEN.value)


@dataclass(frozen=True)
class Materials:
    """What to draw materials from.

    Attributes:
        source: The distribution.
        fits: A table of Ward fits to draw from instead of the families; ``measured`` only.
        measured_share: Of the materials that come from ``measured``; the rest are OpenSurfaces'.
    """

    source: MaterialSource = MaterialSource.OPENSURFACES
    fits: Path | None = None
    measured_share: float = 1.0

    def __post_init__(self) -> None:
        if self.fits is not None and self.source is not MaterialSource.MEASURED:
            raise MaterialsRefused("--material-fits needs --materials measured")
        if self.source is MaterialSource.GIVEN:
            raise MaterialsRefused("materials are drawn from opensurfaces or measured")
        if not 0.0 <= self.measured_share <= 1.0:
            raise MaterialsRefused(f"--measured-share is {self.measured_share}, but must be 0 to 1")

    def card(self) -> dict[str, Any]:
        """Describe the materials for a manifest; the table of fits by its hash.

        Raises:
            MaterialFitsUnreadable: If ``fits`` cannot be read.
        """
        fits = None
        if self.fits is not None:
            fits = hashlib.sha256(fits_bytes(self.fits)).hexdigest()
        return {"source": self.source.value, "measured_share": self.measured_share, "fits": fits}

    def draw(self, rng: np.random.Generator) -> NamedMaterial:
        """Draw a material; equal generator states give equal ones.

        Args:
            rng: random numbers; the same state draws the same.

        Raises:
            MaterialFitsUnreadable: If ``fits`` cannot be read.
        """
        is_measured = self.source is MaterialSource.MEASURED and (
            self.measured_share == 1.0 or rng.uniform() < self.measured_share
        )
        if not is_measured:
            source = MaterialSource.OPENSURFACES
            return NamedMaterial(draw_material(rng), source, source.value)
        if self.fits is None:
            ward, name = draw_measured(rng)
        else:
            fits = _fits(self.fits)
            name = list(fits)[int(rng.integers(len(fits)))]
            ward = fits[name]
        return NamedMaterial(ward, self.source, name)


OPENSURFACES = Materials()
"""The paper's materials."""


@lru_cache(maxsize=8)
def _fits(path: Path) -> dict[str, WardParameters]:
    return read_fits(path)
