# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Ward's material in the terms of glTF 2.0 and UsdPreviewSurface.

The mapping, with ``f = base (1 - F) / pi + F lobe``:

- ``F`` at normal incidence (F0) is ``rho_s``: a facet of Ward's lobe reflects that share.
- ``base = rho_d / (1 - rho_s)``, which gives back ``rho_d`` after the facets took their share.
  Energy conservation (``max(rho_d) + rho_s <= 1``) keeps it in [0, 1].
- ``roughness = sqrt(alpha_ggx)``, as both formats define it; ``alpha_ggx`` from
  :func:`reflest_core.brdf.ggx.ggx_alpha`.
- Nothing is metal: Ward's highlight has no colour.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from reflest_core.brdf.ggx import ggx_alpha
from reflest_core.brdf.parameters import WardParameters


@dataclass(frozen=True)
class MicrofacetMaterial:
    """``base_colour``: linear sRGB in [0, 1]. ``f0``: reflectance of a facet at normal incidence.

    ``roughness``: in (0, 1], the square root of the GGX width.
    """

    base_colour: tuple[float, float, float]
    f0: float
    roughness: float

    @staticmethod
    def from_ward(ward: WardParameters) -> MicrofacetMaterial:
        """The nearest such material."""
        f0 = min(ward.rho_s, 1.0)
        red, green, blue = (_base(channel, f0) for channel in ward.rho_d)
        return MicrofacetMaterial(
            (red, green, blue), f0, math.sqrt(ggx_alpha(ward.alpha, ward.variant))
        )


def _base(rho_d: float, f0: float) -> float:
    # A mirror (F0 = 1) leaves nothing to the base.
    return min(rho_d / (1 - f0), 1.0) if f0 < 1 else 0.0
