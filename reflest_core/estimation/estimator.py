# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Store in, estimate out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.deviations import labcd_stddev
from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.brdf.parameters import SMALLEST_ALPHA
from reflest_core.errors import ReflestError
from reflest_core.estimation.doubts import Evidence, doubts
from reflest_core.estimation.estimate import SCHEMA_VERSION, BrdfEstimate, EstimateStatus
from reflest_core.estimation.material_map import MOST_MATERIALS, MaterialEstimate, MaterialMap
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.gloss.network_update import with_posterior
from reflest_core.inference.gloss.posterior import GlossPosterior, gloss_posterior
from reflest_core.inference.gloss.rated_surface import RatedSurface
from reflest_core.inference.light import SceneLight, infer_light, seen_light
from reflest_core.inference.material import explain_material
from reflest_core.models.predictor import Prediction, Predictor
from reflest_core.surface.coverage import hemisphere_coverage
from reflest_core.surface.extent import voxel_extent
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import WHOLE, Partition
from reflest_core.surface.upright import upright


class NoEstimate(ReflestError):
    """The scan does not hold enough for an estimate; the sentence says what is missing."""


class Estimator:
    """Estimates the BRDF of observed surfaces; the same surface gives the same bits."""

    def __init__(self, settings: EstimationSettings) -> None:
        """Load the network; :class:`WeightsError`, :class:`DeviceError` where that cannot be."""
        self.settings = settings
        weights = Path(settings.weights) if settings.weights else None
        self.predictor = Predictor(settings.model, weights, settings.device, settings.threads)

    def estimate(
        self, surface: ObservedSurface, stamp_ns: int, frame_id: str, light_problem: str = ""
    ) -> BrdfEstimate:
        """Estimate the BRDF of a surface of one material.

        Args:
            surface: the scan, world frame.
            stamp_ns: stamp of the keyframe's image.
            frame_id: camera frame of that image.
            light_problem: a warning about the surface's light, or "".

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        self._check_voxels(surface)
        surface = upright(surface, self.settings.up)
        if not self.predictor.sees_light:
            prediction = self.predictor.predict(surface)
            return self._published(surface, prediction, None, stamp_ns, frame_id, light_problem)
        light = infer_light(surface, seen_light(surface))
        prediction = self.predictor.predict(surface, explain_material(light, WHOLE))
        gloss = self._gloss(surface, light, [np.arange(surface.voxel_count)])
        return self._published(surface, prediction, gloss, stamp_ns, frame_id, light_problem)

    def materials(
        self,
        surface: ObservedSurface,
        partition: Partition,
        stamp_ns: int,
        frame_id: str,
        light_problem: str = "",
    ) -> MaterialMap:
        """Estimate the BRDF of each material of a scan, all in one light.

        Args:
            surface: the scan, world frame.
            partition: its voxels to materials; materials of fewer than ``min_voxels`` observed
                voxels get no estimate.
            stamp_ns: stamp of the keyframe's image.
            frame_id: camera frame of that image.
            light_problem: a warning about the scene's light, or "".

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        self._check_voxels(surface)
        turned = upright(surface, self.settings.up)
        light, rated = None, None
        if self.predictor.sees_light:
            light = infer_light(turned, seen_light(turned), partition)
            rated = RatedSurface.of(turned, light.filled)
        ids = partition.ids_of(turned.voxel_keys)
        materials = []
        for material_id, part in partition.parts(turned):
            if int((part.observation_counts > 0).sum()) < self.settings.min_voxels:
                continue
            found, gloss = None, None
            if light is not None:
                found = explain_material(light, material_id)
                gloss = self._gloss(turned, light, [np.flatnonzero(ids == material_id)], rated)
            prediction = self.predictor.predict(part, found)
            estimate = self._published(part, prediction, gloss, stamp_ns, frame_id, light_problem)
            materials.append(self._material(material_id, surface, partition, estimate))
        materials.sort(key=lambda material: (-material.area, material.id))
        rho_d, stddev = _albedo_of_voxels(surface, partition, materials)
        return MaterialMap(
            stamp_ns,
            frame_id,
            surface,
            partition,
            tuple(materials[:MOST_MATERIALS]),
            rho_d,
            stddev,
            light,
        )

    def _gloss(
        self,
        surface: ObservedSurface,
        light: SceneLight,
        segments: list[NDArray[np.int64]],
        rated: RatedSurface | None = None,
    ) -> GlossPosterior:
        least_gain = self.settings.gloss_information
        return gloss_posterior(surface, light.filled, segments, rated, least_gain=least_gain)

    def _check_voxels(self, surface: ObservedSurface) -> None:
        observed = int((surface.observation_counts > 0).sum())
        if observed < self.settings.min_voxels:
            raise NoEstimate(
                f"{observed} voxels have been observed and estimation.min_voxels is "
                f"{self.settings.min_voxels}: scan more of the object, or check the region of "
                "interest and fusion.max_depth"
            )

    @staticmethod
    def _material(
        material_id: int, surface: ObservedSurface, partition: Partition, estimate: BrdfEstimate
    ) -> MaterialEstimate:
        is_part = partition.ids_of(surface.voxel_keys) == material_id
        extent = voxel_extent(surface.positions[is_part])
        return MaterialEstimate(
            material_id,
            estimate,
            extent.centroid,
            extent.size,
            extent.area,
            int(is_part.sum()),
        )

    def _published(
        self,
        surface: ObservedSurface,
        prediction: Prediction,
        gloss: GlossPosterior | None,
        stamp_ns: int,
        frame_id: str,
        light_problem: str,
    ) -> BrdfEstimate:
        ward, stddev = physical_ward(prediction.ward), prediction.stddev
        if gloss is not None and stddev is not None:
            ward, stddev = with_posterior(ward, stddev, gloss)
        red, green, blue, rho_s, alpha = ward.tolist()
        lightness, a, b, c, d = ward_to_labcd(ward).tolist()
        coverage = hemisphere_coverage(surface, prediction.voxels)
        evidence = Evidence(
            len(prediction.voxels),
            self.predictor.voxels,
            coverage,
            prediction.light,
            "" if gloss is None else gloss.reason,
            light_problem,
        )
        found = list(doubts(evidence, self.settings))
        return BrdfEstimate(
            stamp_ns=stamp_ns,
            frame_id=frame_id,
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
            status_text="; ".join(sentence for _, sentence in found),
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


def physical_ward(ward: NDArray[np.float64]) -> NDArray[np.float64]:
    """The nearest physical values of (5,) ``rho_d``, ``rho_s``, ``alpha`` that a network gave.

    Each value is clipped to its range; both albedos are divided by ``max(rho_d) + rho_s`` where
    that passes 1.
    """
    rho_d = np.clip(ward[:3], 0.0, 1.0)
    rho_s = max(float(ward[3]), 0.0)
    alpha = max(float(ward[4]), SMALLEST_ALPHA)
    energy = max(float(rho_d.max()) + rho_s, 1.0)
    return np.array([*(rho_d / energy), rho_s / energy, alpha])


def _albedo_of_voxels(
    surface: ObservedSurface, partition: Partition, materials: list[MaterialEstimate]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(V, 3) ``rho_d`` and its deviation: each voxel has its material's."""
    ids = partition.ids_of(surface.voxel_keys)
    rho_d = np.full((surface.voxel_count, 3), np.nan, np.float32)
    stddev = rho_d.copy()
    for material in materials:
        rho_d[ids == material.id] = material.estimate.rho_d
        stddev[ids == material.id] = material.estimate.rho_d_stddev
    return rho_d, stddev
