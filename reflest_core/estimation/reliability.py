# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reasons not to trust an estimate, the most severe first."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.light.light_knowledge import LightKnowledge
from reflest_core.surface.colour_problems import NO_PROBLEMS, ColourProblems

EstimateWarning = tuple[EstimateStatus, str]
"""A status and its sentence."""
_NUMBER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)")
MOST_DIGITS = 3
"""After the point, of a share in a sentence."""
ALPHA_UNKNOWN = "alpha cannot be determined"
"""What the warning begins with where ``alpha`` is a prior's."""
MOST_ERROR = 0.75
"""Photometric error that no estimate may have without a warning."""


@dataclass(frozen=True)
class Evidence:
    """What an estimate rests on.

    Attributes:
        voxels: chosen for the network.
        wanted_voxels: how many the network expects.
        coverage: share of view directions seen, in [0, 1].
        light: how much was known of the light; None where the network does not use it.
        colours: what is wrong with the surface's colours.
        gloss_problem: why ``alpha`` cannot be identified, as a clause, or "".
        light_problem: why light known before was not used, or "".
        mixture: why the surface is no single material, as a clause, or "".
        photometric_error: of the estimate rendered in the published light, over the mean of what
            was observed; NaN where it was not rendered.
    """

    voxels: int
    wanted_voxels: int
    coverage: float
    light: LightKnowledge | None
    colours: ColourProblems = NO_PROBLEMS
    gloss_problem: str = ""
    light_problem: str = ""
    mixture: str = ""
    photometric_error: float = math.nan


def warnings_of(evidence: Evidence, settings: EstimationSettings) -> Iterator[EstimateWarning]:
    """List everything that makes an estimate doubtful, the most severe first.

    First what was not scanned, then what is not known of the light, then what this material hides.

    Args:
        evidence: what the estimate rests on.
        settings: thresholds.
    """
    if evidence.voxels < evidence.wanted_voxels:
        yield (
            EstimateStatus.FEW_VOXELS,
            f"{evidence.voxels} voxels where the network expects {evidence.wanted_voxels}: "
            "scan more of the object",
        )
    if evidence.mixture:
        yield (
            EstimateStatus.MIXED_MATERIALS,
            f"this is more than one material ({evidence.mixture}): use the estimates of each "
            "material, or narrow the region of interest",
        )
    if evidence.coverage < settings.low_coverage:
        yield (
            EstimateStatus.LOW_COVERAGE,
            f"{_beside(evidence.coverage, settings.low_coverage)} of view directions seen, below "
            f"{_percent(settings.low_coverage)}: move around the object",
        )
    for sentence in (evidence.colours.too_dark, evidence.colours.noise):
        if sentence:
            yield EstimateStatus.LOW_LIGHT, sentence
    if evidence.light_problem:
        yield EstimateStatus.LOW_LIGHT, evidence.light_problem
    if evidence.light is not None:
        yield from _of_light(evidence.light, settings)
    if evidence.colours.overexposed:
        yield EstimateStatus.CLIPPED_LIGHT, evidence.colours.overexposed
    if evidence.gloss_problem and not evidence.colours:
        yield (
            EstimateStatus.UNCERTAIN_GLOSS,
            f"{ALPHA_UNKNOWN}: {evidence.gloss_problem}",
        )
    if evidence.photometric_error > MOST_ERROR:
        # Every voxel's albedo is fitted to its colours: what is left changes with the view.
        yield (
            EstimateStatus.UNCERTAIN_GLOSS,
            f"rendered, it misses what was observed by {min(evidence.photometric_error, 99):.0%}: "
            "look round the room, and scan from more sides",
        )


def grouped_warnings(warnings: Iterable[tuple[int, str]]) -> dict[str, list[int]]:
    """Join the warnings of several materials that differ in their numbers alone.

    Args:
        warnings: a material's id and a sentence about it.

    Returns:
        The ids that each sentence is about, in the given order; where numbers differ, the sentence
        has the least and the greatest, as in "2 to 9% of view directions seen".
    """
    ids: dict[tuple[str, ...], list[int]] = {}
    numbers: dict[tuple[str, ...], list[list[str]]] = {}
    for material_id, sentence in warnings:
        parts = _NUMBER.split(sentence)
        words = tuple(parts[::2])
        ids.setdefault(words, []).append(material_id)
        numbers.setdefault(words, []).append(parts[1::2])
    joined = {}
    for words, found in ids.items():
        ranges = [_range(one) for one in zip(*numbers[words], strict=True)]
        between = zip(words, [*ranges, ""], strict=True)
        joined["".join(word + number for word, number in between)] = found
    return joined


def _range(numbers: tuple[str, ...]) -> str:
    least, greatest = min(numbers, key=float), max(numbers, key=float)
    return least if least == greatest else f"{least} to {greatest}"


def _of_light(light: LightKnowledge, settings: EstimationSettings) -> Iterator[EstimateWarning]:
    if light.seen == 0.0 or light.seen < settings.low_light:
        share = _beside(light.seen, settings.low_light) if light.seen > 0.0 else "none"
        yield (
            EstimateStatus.LOW_LIGHT,
            f"{share} of the surroundings that light the surface seen, below "
            f"{_percent(settings.low_light)}: look round the room once, up too",
        )
    if light.clipped > settings.clipped_light:
        yield (
            EstimateStatus.CLIPPED_LIGHT,
            f"{_beside(light.clipped, settings.clipped_light)} of the light is overexposed "
            f"background, above {_percent(settings.clipped_light)}: lower the exposure, or shade "
            "lamps and windows",
        )


def _percent(limit: float) -> str:
    return f"{100.0 * limit:.4g}%"


def _beside(share: float, limit: float) -> str:
    """A share in percent, with as many digits as it takes to differ from the limit it passed."""
    shown = float(_percent(limit)[:-1])
    texts = [f"{share:.{digits}%}" for digits in range(MOST_DIGITS + 1)]
    return next((one for one in texts if float(one[:-1]) != shown), texts[-1])
