# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The published form of an estimate: every field, with its status and the sentence for it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.deviations import labcd_stddev
from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.estimation.estimate import SCHEMA_VERSION, BrdfEstimate, EstimateStatus
from reflest_core.estimation.physical_ward import physical_ward
from reflest_core.estimation.reliability import Evidence, warnings_of
from reflest_core.estimation.scene_estimates import SceneEstimate
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.gloss.network_update import roughness_problem, with_posterior
from reflest_core.inference.gloss.posterior import GlossPosterior
from reflest_core.models.predictor import Prediction, Predictor
from reflest_core.surface.colour_problems import colour_problems
from reflest_core.surface.coverage import hemisphere_coverage
from reflest_core.surface.observed_surface import ObservedSurface


@dataclass(frozen=True)
class Header:
    """The keyframe that an estimate belongs to.

    Attributes:
        stamp_ns: stamp of the keyframe's image.
        frame_id: camera frame of that image.
        light_problem: a warning about the surface's light, or "".
        budget: what was left out to save time, as a sentence, or "".
    """

    stamp_ns: int
    frame_id: str
    light_problem: str
    budget: str = ""


@dataclass(frozen=True)
class Publisher:
    """Turns a network's answers into estimates.

    Attributes:
        predictor: the network, with its model card.
        settings: thresholds of the warnings.
    """

    predictor: Predictor
    settings: EstimationSettings

    def estimate(
        self,
        surface: ObservedSurface,
        prediction: Prediction,
        gloss: GlossPosterior | SceneEstimate | None,
        header: Header,
        mixture: str = "",
    ) -> BrdfEstimate:
        """Publish what is known of one material.

        Args:
            surface: the material's voxels.
            prediction: the network's answer.
            gloss: what the observations say about roughness, or the estimate that takes the whole
                scene into account; None for a network that sees no light.
            header: of the keyframe.
            mixture: why the surface is no single material, as a clause, or "".
        """
        ward, stddev = physical_ward(prediction.ward), prediction.stddev
        error = math.nan
        if isinstance(gloss, SceneEstimate):
            error = gloss.photometric_error
            ward, stddev, gloss = gloss.ward, gloss.stddev, gloss.gloss
        elif gloss is not None and stddev is not None and not prediction.has_posterior:
            ward, stddev = with_posterior(ward, stddev, gloss)
        colours = colour_problems(surface)
        if colours and stddev is not None:  # they show no material
            stddev = np.maximum(stddev, self.predictor.card.statistics["ward"].stddev)
        red, green, blue, rho_s, alpha = ward.tolist()
        lightness, a, b, c, d = ward_to_labcd(ward).tolist()
        coverage = hemisphere_coverage(surface, prediction.voxels)
        evidence = Evidence(
            len(prediction.voxels),
            self.predictor.voxels,
            coverage,
            prediction.light,
            colours,
            "" if gloss is None else roughness_problem(ward, stddev, gloss),
            header.light_problem,
            mixture,
            error,
        )
        found = list(warnings_of(evidence, self.settings))
        return BrdfEstimate(
            stamp_ns=header.stamp_ns,
            frame_id=header.frame_id,
            schema_version=SCHEMA_VERSION,
            model_id=self.predictor.model_id,
            ward_variant=self.predictor.card.variant.value,
            rho_d=(red, green, blue),
            rho_s=rho_s,
            alpha=alpha,
            lab=(lightness, a, b),
            c=c,
            d=d,
            voxel_count=surface.voxel_count,
            observation_count=len(surface.colours),
            view_count=surface.observing_views,
            coverage=coverage,
            status=found[0][0] if found else EstimateStatus.OK,
            status_text="; ".join(filter(None, [*(text for _, text in found), header.budget])),
            **self._deviations(ward, stddev),
        )

    def _deviations(
        self, ward: NDArray[np.float64], stddev: NDArray[np.float64] | None
    ) -> dict[str, Any]:
        """The estimate's fields of standard deviations; none where the network knows none."""
        if stddev is None:
            return {}
        red, green, blue, rho_s, alpha = stddev.tolist()
        correlation = self.predictor.card.calibration.correlation
        lightness, a, b, c, d = labcd_stddev(ward, stddev, correlation).tolist()
        return {
            "rho_d_stddev": (red, green, blue),
            "rho_s_stddev": rho_s,
            "alpha_stddev": alpha,
            "lab_stddev": (lightness, a, b),
            "c_stddev": c,
            "d_stddev": d,
        }
