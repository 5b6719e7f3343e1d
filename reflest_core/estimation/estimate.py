# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The published estimate; its fields are those of ``reflest_ros/msg/BrdfEstimate``."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, fields
from typing import Any

from reflest_core.brdf.parameters import WardParameters, WardVariant

SCHEMA_VERSION = 2
"""Since 2 the status speaks of light and gloss too, and ``status_text`` of every doubt."""
READABLE_VERSIONS = (1, 2)
"""What was written of old can still be read: no other field has changed its meaning."""
Rgb = tuple[float, float, float]
UNKNOWN_RGB: Rgb = (math.nan, math.nan, math.nan)


class EstimateStatus(enum.IntEnum):
    """How far an estimate may be trusted; the message's ``STATUS_*`` constants."""

    OK = 0
    LOW_COVERAGE = 1
    FEW_VOXELS = 2
    LOW_LIGHT = 3
    CLIPPED_LIGHT = 4
    UNCERTAIN_GLOSS = 5


@dataclass(frozen=True)
class BrdfEstimate:
    """One estimate of the scanned surface's BRDF. NaN means unknown throughout.

    ``stamp_ns``: stamp of the keyframe's image. ``rho_d``: linear sRGB (Rec. 709, D65) in [0, 1].
    ``rho_s`` >= 0, ``alpha`` > 0. ``lab``: CIE L*a*b*, D65/2 degrees. ``c``, ``d``: Eq. 2.
    ``*_stddev``: one standard deviation. ``status``: the gravest doubt of ``estimation.doubts``;
    ``status_text``: the sentences of all, joined by "; ". ``coverage``: mean share of each used
    voxel's hemisphere of view directions that was seen, in [0, 1]. ``latency``: seconds from the
    arrival of the keyframe's image to publication, NaN offline.
    """

    stamp_ns: int
    frame_id: str
    schema_version: int
    model_id: str
    ward_variant: str
    rho_d: Rgb
    rho_s: float
    alpha: float
    lab: Rgb
    c: float
    d: float
    voxel_count: int
    observation_count: int
    view_count: int
    coverage: float
    status: EstimateStatus
    status_text: str
    rho_d_stddev: Rgb = UNKNOWN_RGB
    rho_s_stddev: float = math.nan
    alpha_stddev: float = math.nan
    lab_stddev: Rgb = UNKNOWN_RGB
    c_stddev: float = math.nan
    d_stddev: float = math.nan
    latency: float = math.nan

    @property
    def ward(self) -> WardParameters:
        """The Ward values; ValueError for a variant that this version does not know."""
        return WardParameters(self.rho_d, self.rho_s, self.alpha, WardVariant(self.ward_variant))

    def to_json(self) -> dict[str, Any]:
        """Message field names to JSON values; NaN becomes null, the header is one object."""
        record: dict[str, Any] = {
            "header": {"stamp_ns": self.stamp_ns, "frame_id": self.frame_id},
        }
        for field in fields(self):
            if field.name in ("stamp_ns", "frame_id"):
                continue
            record[field.name] = _json_value(getattr(self, field.name))
        return record


def _json_value(value: Any) -> Any:
    if isinstance(value, enum.IntEnum):
        return int(value)
    if isinstance(value, tuple):
        return [_json_value(item) for item in value]
    if isinstance(value, float) and math.isnan(value):
        return None
    return value
