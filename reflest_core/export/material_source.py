# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate as a source of a material: what every exporter is given."""

from __future__ import annotations

import math
from dataclasses import dataclass

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.export.errors import ExportError


@dataclass(frozen=True)
class MaterialSource:
    """``ward``: the material. ``provenance``: names to plain values, which travel in the file.

    ``light``: the environment's file, as a path from the folder of the material's; may be empty.
    """

    ward: WardParameters
    provenance: dict[str, str | float | list[float]]
    light: str = ""

    @staticmethod
    def from_estimate(estimate: BrdfEstimate, light: str = "") -> MaterialSource:
        """Check the values; :class:`ExportError` names the one that is not physical."""
        ward = _ward(estimate)
        _check("rho_d", min(ward.rho_d) >= 0 and max(ward.rho_d) <= 1, "in [0, 1]", ward.rho_d)
        _check("rho_s", 0 <= ward.rho_s <= 1, "in [0, 1]", ward.rho_s)
        _check("alpha", 0 < ward.alpha < math.inf, "above 0", ward.alpha)
        provenance: dict[str, str | float | list[float]] = {
            "rho_d": list(ward.rho_d),
            "rho_s": ward.rho_s,
            "alpha": ward.alpha,
            "ward_variant": ward.variant.value,
            "model_id": estimate.model_id,
            # A string: 64 bits do not fit into the numbers of JSON.
            "stamp_ns": str(estimate.stamp_ns),
        }
        return MaterialSource(ward, provenance, light)


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
