# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The published estimate; its fields are those of ``reflest_ros/msg/BrdfEstimate``."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, fields
from typing import Any

from reflest_core.brdf.parameters import WardParameters, WardVariant

SCHEMA_VERSION = 3
"""Since 2 the status covers light and gloss, and ``status_text`` lists every warning. Since 3 the
status OK is 8 and 0 is UNKNOWN, so that a message that nobody filled in is not mistaken for OK."""
READABLE_VERSIONS = (1, 2, 3)
"""Versions that :func:`status_from_number` and :mod:`reflest_core.export.estimate_file` read."""
OLD_OK = 0
"""The number of OK before version 3."""
Rgb = tuple[float, float, float]
UNKNOWN_RGB: Rgb = (math.nan, math.nan, math.nan)


class EstimateStatus(enum.IntEnum):
    """How far an estimate can be trusted; the message's ``STATUS_*`` constants.

    Compare with the names: OK is not 0. Printed and formatted it is its name; ``int()`` gives the
    number.
    """

    UNKNOWN = 0
    LOW_COVERAGE = 1
    FEW_VOXELS = 2
    LOW_LIGHT = 3
    CLIPPED_LIGHT = 4
    UNCERTAIN_GLOSS = 5
    INCONSISTENT_POSES = 6
    MIXED_MATERIALS = 7
    OK = 8

    def __str__(self) -> str:
        """Return the name."""
        return self.name

    def __format__(self, format_spec: str) -> str:
        """Return the name.

        Args:
            format_spec: as of a string.
        """
        return format(self.name, format_spec)


def status_from_number(number: int, schema_version: int) -> EstimateStatus:
    """Return the status that a number meant in a version of the schema.

    Args:
        number: As stored in a message or a file.
        schema_version: One of :data:`READABLE_VERSIONS`.

    Returns:
        The status.

    Raises:
        ValueError: The version has no such status.
    """
    if 0 < schema_version < 3 and number == OLD_OK:
        return EstimateStatus.OK
    return EstimateStatus(number)


@dataclass(frozen=True)
class BrdfEstimate:
    """One estimate of the scanned surface's BRDF. NaN means unknown throughout.

    Attributes:
        stamp_ns: Stamp of the keyframe's image, nanoseconds.
        frame_id: Frame of the colour camera.
        schema_version: :data:`SCHEMA_VERSION` of the code that made the estimate.
        model_id: Network and first digits of the weights' hash.
        ward_variant: A :class:`.WardVariant` by its value.
        rho_d: Diffuse albedo in [0, 1], linear sRGB (Rec. 709 primaries, D65).
        rho_s: Specular albedo, at least 0.
        alpha: Roughness, above 0.
        lab: CIE L*, a*, b* of ``rho_d``, D65, 2 degree observer.
        c: Contrast of the gloss (Eq. 2 of Kim et al. 2017).
        d: Distinctness of the gloss, 1 - alpha (Eq. 2).
        voxel_count: Surface voxels with observations.
        observation_count: Observations of these voxels.
        view_count: Views that hold these observations.
        coverage: Mean share of each used voxel's hemisphere of view directions that was seen.
        status: The most severe warning, or OK.
        status_text: One sentence for each warning, joined by "; ".
        rho_d_stddev: Standard deviation of ``rho_d``.
        rho_s_stddev: Standard deviation of ``rho_s``.
        alpha_stddev: Standard deviation of ``alpha``.
        lab_stddev: Standard deviation of ``lab``.
        c_stddev: Standard deviation of ``c``.
        d_stddev: Standard deviation of ``d``.
        depth_agreement: Share of a keyframe's depth that meets the next one's under the given
            poses; median over the latest keyframes.
        latency: Seconds from the arrival of the keyframe's image to publication; NaN offline.
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
    depth_agreement: float = math.nan
    latency: float = math.nan

    @property
    def ward(self) -> WardParameters:
        """The Ward values.

        Raises:
            ValueError: This version does not know the variant.
        """
        return WardParameters(self.rho_d, self.rho_s, self.alpha, WardVariant(self.ward_variant))

    def to_json(self) -> dict[str, Any]:
        """Return message field names with JSON values; NaN becomes null, the header an object.

        ``status_name`` stands beside the number of ``status``.
        """
        record: dict[str, Any] = {
            "header": {"stamp_ns": self.stamp_ns, "frame_id": self.frame_id},
        }
        for field in fields(self):
            if field.name in ("stamp_ns", "frame_id"):
                continue
            record[field.name] = _json_value(getattr(self, field.name))
            if field.name == "status":
                record["status_name"] = self.status.name
        return record


def _json_value(value: Any) -> Any:
    if isinstance(value, enum.IntEnum):
        return int(value)
    if isinstance(value, tuple):
        return [_json_value(item) for item in value]
    if isinstance(value, float) and math.isnan(value):
        return None
    return value
