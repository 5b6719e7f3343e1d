# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is remembered of one scan from keyframe to keyframe: ids, light, and costly answers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.publisher import Header
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.gloss.posterior import GlossPosterior
from reflest_core.models.predictor import Prediction
from reflest_core.segmentation.segmenter import Segmenter

TOLERANCE = 0.1
"""Relative change of a material's voxels, observations or irradiance, up to which an answer about
its gloss is kept."""


GlossAnswer = tuple[Prediction, GlossPosterior]
"""What a network and the observations' likelihood say of a material."""
Basis = tuple[float, ...]
"""Numbers above 0 that an answer rests on: voxels, observations, irradiances."""


@dataclass
class ScanMemory:
    """The state of one scan; bounded by its last keyframe. Use it from one thread at a time.

    Attributes:
        segmenter: divides the scan into materials.
        answers: of the last keyframe's materials, by id, with what each one rests on.
        model_id: the network that gave them.
        last: the last map, and what it was made of.
    """

    segmenter: Segmenter = field(default_factory=Segmenter)
    answers: dict[int, tuple[Basis, GlossAnswer]] = field(default_factory=dict)
    model_id: str = ""
    last: tuple[tuple[str, EstimationSettings, Header, bytes], MaterialMap] | None = None

    def known(self, model_id: str, bases: dict[int, Basis]) -> dict[int, GlossAnswer]:
        """Select the answers that rest on nearly the same as then.

        Args:
            model_id: the network that would answer now.
            bases: by material id.
        """
        if model_id != self.model_id:
            return {}
        return {
            material_id: self.answers[material_id][1]
            for material_id, basis in bases.items()
            if material_id in self.answers and _is_near(basis, self.answers[material_id][0])
        }

    def remember(
        self, model_id: str, bases: dict[int, Basis], answers: dict[int, GlossAnswer]
    ) -> None:
        """Keep the answers to a keyframe's materials and forget all others.

        Args:
            model_id: the network that gave them.
            bases: by material id, of now; an answer that was known keeps its own.
            answers: by material id.
        """
        known = self.answers if model_id == self.model_id else {}
        self.answers = {
            material_id: known[material_id]
            if material_id in known and known[material_id][1] is answer
            else (bases[material_id], answer)
            for material_id, answer in answers.items()
        }
        self.model_id = model_id


def _is_near(basis: Basis, then: Basis) -> bool:
    ratio = np.array(basis) / np.maximum(then, 1e-9)
    return bool((np.abs(ratio - 1.0) <= TOLERANCE).all())
