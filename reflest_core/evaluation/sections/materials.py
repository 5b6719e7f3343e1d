# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Section: the materials of whole scenes."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, percent, table
from reflest_core.evaluation.studies.scene_variants import TITLES
from reflest_core.models.card import WARD_NAMES

COLUMNS = {
    "z": "z",
    "log_rho_d": "median abs log rho_d",
    "ari": "ARI",
    "balanced_ari": "balanced ARI",
    "purity": "purity",
    "completeness": "completeness",
}
PICTURE = "../images/scene-materials.jpg"
"""Drawn by ``docs/figures/scene_materials.py``, seen from the page."""
HEADINGS = {"unseen": "Lights of no training", "training": "Lights of the network's training"}


def materials(record: Record) -> Lines:
    """Section: errors of materials and segments, for each scene and in the mean.

    Args:
        record: Result of :func:`.measure_materials`.
    """
    rows = [
        [
            row["name"],
            row["environment"],
            row["setting"],
            row["voxels"],
            row["materials"]["materials"],
            row["materials"]["found"],
            *(float(row["materials"][column]) for column in COLUMNS),
            row["whole"]["z"],
            f"{row['cpu_seconds']:.1f}",
        ]
        for row in record["rows"]
    ]
    header = ["scene", "light", "setting", "voxels", "true materials", "found", *COLUMNS.values()]
    lines = [
        "## Materials of whole scenes",
        "",
        "Tabletops and corners of rooms with 2 to 6 objects of measured materials, scanned without",
        "a region. `z` is the error over [.25 .25 .25 .20 .06] (`rho_d`, `rho_s`, `alpha`), RMS",
        "over parameters, mean over a material's points, then over materials. ARI is the adjusted",
        "Rand index; balanced ARI, purity and completeness weight true materials alike. No network",
        "was trained on any of these scenes.",
        "",
        "The shipped table and three of them: photograph, rendered estimate, materials, albedo and",
        "roughness beside the truth ([comment](../explanation/materials.md#how-good-it-is)).",
        "",
        f"![Photograph, estimate, materials, albedo and roughness of four scenes]({PICTURE})",
        "",
    ]
    for name, split in record["splits"].items():
        lines += _split(name, split)
    return [
        *lines,
        "### Scene by scene",
        "",
        *table([*header, "z, one material", "CPU s"], rows),
        "",
    ]


def _split(name: str, split: Record) -> Lines:
    """Means over the scenes of one split."""
    means = [
        [title, *(float(split["means"][variant][column]) for column in COLUMNS)]
        for variant, title in TITLES.items()
        if variant in split["means"]
    ]
    inside = [percent(share) for share in split["inside"]]
    return [
        f"### {HEADINGS[name]}: {split['scenes']} scenes under {split['lights']} lights",
        "",
        *table(["", *COLUMNS.values()], means),
        "",
        "Truths in the voxels' 90 % intervals, materials weighted alike:",
        "",
        *table(list(WARD_NAMES), [inside]),
        "",
        f"From keyframe to keyframe in the second half of a scan, {percent(split['kept'])} of the",
        f"voxels keep their material's id, and {percent(split['small_steps'])} of the materials",
        "change by less than a stated deviation.",
        "",
        *_light(split),
    ]


def _light(split: Record) -> Lines:
    if split["irradiance"] is None:
        return []
    return [
        "Irradiance of the inferred light on surfaces that face up, RMS of the log of its ratio to",
        f"the truth, mean over the scenes under a distant light: {split['irradiance']:.2f}.",
        "",
    ]
