# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What ``reflest replay`` prints, and its JSON document."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from reflest_core.brdf.srgb import encode
from reflest_core.capture.capture import Capture
from reflest_core.capture.frame import Frame
from reflest_core.estimation.estimate import SCHEMA_VERSION, BrdfEstimate
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.reliability import ALPHA_UNKNOWN
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.poses.check import PoseCheck, PoseReport

MOST_ROWS = 24
"""Materials that the table on the terminal shows."""
MOST_IDS = 6
"""Ids that a warning names."""
MOST_DIGITS = 4
"""After the point, of a number in the table: a ten-thousandth is less than any deviation."""
PRIOR_MARK = "*"
"""After an ``alpha`` that the observations do not determine."""


@dataclass
class ReplayResult:
    """What came out: an estimate for each keyframe, and one from the whole scan or why not.

    Attributes:
        fused_count: Frames that were used.
        redundant_count: Those among them that showed nothing new.
        light_count: Those that looked away from the object.
        last_fused: The last frame that was used.
        estimates: Of the keyframes.
        final: Of the whole scan.
        no_final: Why there is none.
        materials: Of the whole scan.
        thinned_to: Voxels that ``final`` was estimated from, where they are not all of the scan.
        middle_id: Which of them ``final`` is, the one in the middle of the last view; None where a
            region or a mask says what is looked at.
        poses: How well the depth maps met.
    """

    fused_count: int = 0
    redundant_count: int = 0
    light_count: int = 0
    last_fused: Frame | None = None
    estimates: list[BrdfEstimate] = field(default_factory=list)
    final: BrdfEstimate | None = None
    no_final: str | None = None
    materials: MaterialMap | None = None
    thinned_to: int | None = None
    middle_id: int | None = None
    poses: PoseReport = field(default_factory=lambda: PoseCheck().report)


def estimate_line(estimate: BrdfEstimate) -> str:
    """Return stamp, Ward values and what they rest on, in one line.

    Args:
        estimate: of a keyframe, or of the whole scan.
    """
    red, green, blue = estimate.rho_d
    return (
        f"{estimate.stamp_ns / 1e9:.3f} s  rho_d {red:.3f} {green:.3f} {blue:.3f}  "
        f"rho_s {estimate.rho_s:.3f}  alpha {estimate.alpha:.3f}  "
        f"[{estimate.voxel_count} voxels, {estimate.view_count} views, "
        f"coverage {estimate.coverage:.0%}, {estimate.status.name}]"
    )


def final_lines(
    estimate: BrdfEstimate, middle_id: int | None = None, thinned_to: int | None = None
) -> list[str]:
    """Return the final estimate in full, with deviations, units and colour spaces.

    Args:
        estimate: of a keyframe, or of the whole scan.
        middle_id: its material, the one in the middle of the last view; None where it is not one
            of several.
        thinned_to: voxels that it was estimated from, where they are not all of the scan.
    """
    notes = []
    if middle_id is not None:
        notes.append(
            "  of     the material in the middle of the last view, from the voxels around it; "
            f"id {middle_id} below is from all voxels"
        )
    elif thinned_to is not None:
        notes.append(
            f"  of     {thinned_to:,} voxels alone, as at keyframes; the table below is from all "
            "voxels"
        )
    gloss, gloss_stddev = (estimate.c, estimate.d), (estimate.c_stddev, estimate.d_stddev)
    return [
        f"final   {estimate_line(estimate)}",
        *notes,
        f"  rho_d  {_with_deviation(estimate.rho_d, estimate.rho_d_stddev, 4)}"
        "  (diffuse albedo, linear sRGB)",
        f"  rho_s  {_with_deviation((estimate.rho_s,), (estimate.rho_s_stddev,), 4)}"
        "  (specular albedo)",
        f"  alpha  {_with_deviation((estimate.alpha,), (estimate.alpha_stddev,), 4)}  (roughness)",
        f"  Lab    {_with_deviation(estimate.lab, estimate.lab_stddev, 2)}  (D65, 2 degrees)",
        f"  c, d   {_with_deviation(gloss, gloss_stddev, 4)}  (contrast and distinctness of gloss)",
        f"  model  {estimate.model_id}, Ward variant {estimate.ward_variant}",
        f"  from   {estimate.observation_count} observations",
        *(f"  {estimate.status.name}: {one}" for one in sentences_of(estimate)),
    ]


def sentences_of(estimate: BrdfEstimate) -> list[str]:
    """Return the warnings of an estimate.

    Args:
        estimate: of a keyframe, or of the whole scan.
    """
    return [sentence for sentence in estimate.status_text.split("; ") if sentence]


def material_lines(materials: MaterialMap, is_terminal: bool = False) -> list[str]:
    """Tabulate all materials, the largest first.

    Args:
        materials: of the whole scan.
        is_terminal: draw a patch of each colour by a terminal's escape codes.

    Returns:
        A line of titles, then one for each of the largest :data:`MOST_ROWS` materials: id, area,
        Ward values with one standard deviation, error of the rendered colours, status; then what
        they leave out, and each kind of warning once.
    """
    titles = ("  id", f"{'cm2':>8}", f"{'rho_d, linear sRGB':43}", f"{'rho_s':15}", f"{'alpha':16}")
    lines = ["  ".join((*titles, "error", "status"))]
    for material in materials.materials[:MOST_ROWS]:
        found = material.estimate
        mark = PRIOR_MARK if ALPHA_UNKNOWN in found.status_text else ""
        columns = [
            f"{material.id:4d}",
            f"{1e4 * material.area:8.1f}",
            f"{_with_deviation(found.rho_d, found.rho_d_stddev, None):43s}",
            f"{_with_deviation((found.rho_s,), (found.rho_s_stddev,), None):15s}",
            f"{_with_deviation((found.alpha,), (found.alpha_stddev,), None) + mark:16s}",
            f"{error:5.0%}" if math.isfinite(error := material.photometric_error) else "    -",
            found.status.name,
        ]
        patch = _colour_patch(found.rho_d) if is_terminal else ""
        lines.append("  ".join(columns) + patch)
    smaller = materials.materials[MOST_ROWS:]
    if smaller:
        share = sum(one.area for one in smaller) / sum(one.area for one in materials.materials)
        lines.append(
            f"  and {len(smaller)} smaller ones, {share:.0%} of the area: "
            "--json and --materials hold all"
        )
    if any(ALPHA_UNKNOWN in one.estimate.status_text for one in materials.materials[:MOST_ROWS]):
        lines.append(
            f"  {PRIOR_MARK} alpha and its deviation are mostly the prior's: the observations "
            "hardly determine it"
        )
    for sentence, ids in materials.warnings().items():
        lines.append(f"  id {_listed(ids)}: {sentence}")
    return lines


def _listed(ids: Sequence[int]) -> str:
    """The first ids, and how many more."""
    named = ", ".join(map(str, ids[:MOST_IDS]))
    return named if len(ids) <= MOST_IDS else f"{named} and {len(ids) - MOST_IDS} more"


def _colour_patch(rho_d: Sequence[float]) -> str:
    """Two spaces on a background of the albedo's sRGB colour, for terminals of 24-bit colour."""
    red, green, blue = (255.0 * encode(np.array(rho_d))).round().astype(int).tolist()
    return f"  \x1b[48;2;{red};{green};{blue}m  \x1b[0m"


def _with_deviation(values: Sequence[float], stddev: Sequence[float], digits: int | None) -> str:
    """Values with one standard deviation each, where they are known.

    ``digits`` follow the point; None shows two significant ones.
    """

    def listed(numbers: Sequence[float]) -> str:
        return " ".join(
            f"{one:.{_two_significant(one) if digits is None else digits}f}" for one in numbers
        )

    if any(map(math.isnan, stddev)):
        return listed(values)
    return f"{listed(values)} ± {listed(stddev)}"


def _two_significant(value: float) -> int:
    """Digits after the point that show two significant ones, from 2 to :data:`MOST_DIGITS`."""
    if not 0.0 < abs(value) < math.inf:
        return 2
    return min(max(1 - math.floor(math.log10(abs(value))), 2), MOST_DIGITS)


def refusals_line(capture: Capture) -> str | None:
    """Return how many frames and messages were refused and why, or None.

    Args:
        capture: read to its end.
    """
    counts = {cause.value: count for cause, count in capture.refusals.counts.items()}
    if not counts:
        return None
    listed = ", ".join(f"{count} {cause}" for cause, count in sorted(counts.items()))
    return f"refused: {listed}"


def replay_record(
    capture: Capture,
    settings: ReflestSettings,
    result: ReplayResult,
) -> dict[str, Any]:
    """Return the JSON document; the same capture and settings give the same bytes.

    Args:
        capture: read to its end.
        settings: as they were used.
        result: what came out.
    """
    first_message = capture.refusals.first_message
    return {
        "schema_version": SCHEMA_VERSION,
        "capture": capture.name,
        "model": settings.estimation.model,
        "settings": dataclasses.asdict(settings),
        "frames": {
            "seen": capture.frames_seen,
            "fused": result.fused_count,
            "redundant": result.redundant_count,
            "light_alone": result.light_count,
        },
        "poses": result.poses.to_json(),
        "estimates": [estimate.to_json() for estimate in result.estimates],
        "final": None if result.final is None else result.final.to_json(),
        "final_material_id": result.middle_id,
        "materials": [material.to_json() for material in result.materials.materials]
        if result.materials
        else [],
        "no_estimate": result.no_final,
        "refusals": {
            cause.value: {"count": count, "first": first_message[cause]}
            for cause, count in sorted(
                capture.refusals.counts.items(), key=lambda item: item[0].value
            )
        },
        "damage": capture.damage,
    }
