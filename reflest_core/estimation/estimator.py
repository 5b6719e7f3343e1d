# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Store in, estimate out."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.evidence_budget import EvidenceBudget
from reflest_core.estimation.material_map import (
    MOST_MATERIALS,
    MaterialEstimate,
    MaterialMap,
    nearest_material,
)
from reflest_core.estimation.publisher import Header, Publisher
from reflest_core.estimation.scan_memory import GlossAnswer, ScanMemory
from reflest_core.estimation.scene_estimates import SceneEstimates
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.gloss.posterior import gloss_posterior
from reflest_core.inference.light import SceneLight, infer_light, seen_light
from reflest_core.inference.material import explain_material
from reflest_core.inference.mixed_materials import albedos_of_material
from reflest_core.inference.transport.surface_irradiance import SurfaceSight
from reflest_core.models.linear_algebra import one_blas_thread
from reflest_core.models.predictor import Predictor
from reflest_core.models.registry import network_of_model
from reflest_core.segmentation.segmenter import Segmenter, in_key_order
from reflest_core.surface.extent import voxel_extent
from reflest_core.surface.observed_surface import ObservedSurface, digest
from reflest_core.surface.partition import UNASSIGNED, WHOLE, Partition
from reflest_core.surface.upright import upright

FEWEST_GLOSS_VOXELS = 30
"""Whatever the budget: with fewer voxels alpha is hardly ever determined."""


class NoEstimate(ReflestError):
    """The scan does not hold enough for an estimate; the sentence says what is missing."""


class Estimator:
    """Estimates the BRDF of observed surfaces.

    The same surface gives the same bits, unless ``estimation.budget`` limits the time.

    Attributes:
        settings: the parameters.
        predictor: the network for a scan of one material.
        scene_predictor: the network for materials among others; the same one where the model or
            the user has one weight file for both.
    """

    def __init__(self, settings: EstimationSettings) -> None:
        """Load the network; :class:`WeightsError`, :class:`DeviceError` where that cannot be.

        Args:
            settings: the parameters.
        """
        self.settings = settings
        weights = Path(settings.weights) if settings.weights else None
        options = settings.device, settings.threads
        self.predictor = Predictor(settings.model, weights, *options)
        self.scene_predictor = self.predictor
        of_scenes = network_of_model(settings.model).model_named(settings.model).scene_weights
        if weights is None and of_scenes is not None:
            self.scene_predictor = Predictor(settings.model, of_scenes, *options)
        self._publisher = Publisher(self.predictor, settings)
        self._scene_publisher = Publisher(self.scene_predictor, settings)
        self._budget = EvidenceBudget(settings.budget)

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
            header = Header(stamp_ns, frame_id, light_problem)
            return self._publisher.estimate(surface, self.predictor.predict(surface), None, header)
        header = Header(stamp_ns, frame_id, light_problem, self._budget.note)
        with self._budget.spending(), one_blas_thread():
            return self._lit_estimate(surface, header)

    def _lit_estimate(self, surface: ObservedSurface, header: Header) -> BrdfEstimate:
        """Estimate a surface of one material in its light, by the budget's share of evidence."""
        share = self._budget.share
        light = infer_light(surface, seen_light(surface), evidence_share=share)
        found = explain_material(light, WHOLE)
        gloss = gloss_posterior(
            surface,
            light.filled,
            [np.arange(surface.voxel_count)],
            most=max(round(share * self.settings.gloss_voxels), FEWEST_GLOSS_VOXELS),
            least_gain=self.settings.gloss_information,
        )
        found = replace(found, posterior=gloss)
        prediction = self.predictor.predict(surface, found)
        return self._publisher.estimate(surface, prediction, gloss, header, _mixture(light, WHOLE))

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
        header = Header(stamp_ns, frame_id, light_problem)
        with one_blas_thread():
            light = None
            if self.predictor.sees_light:
                light = infer_light(turned, seen_light(turned), partition)
            return self._map((surface, turned), partition, light, header)

    def segmented_materials(
        self,
        surface: ObservedSurface,
        memory: ScanMemory,
        stamp_ns: int,
        frame_id: str,
        light_problem: str = "",
    ) -> MaterialMap:
        """Divide a scan into materials and estimate the BRDF of each, all in one light.

        Args:
            surface: the scan, world frame.
            memory: of this scan; it keeps ids and light from keyframe to keyframe, and the answers
                about materials that changed little.
            stamp_ns: stamp of the keyframe's image.
            frame_id: camera frame of that image.
            light_problem: a warning about the scene's light, or "".

        Returns:
            The map; the same one again where nothing was scanned since. Its surface has the
            observed voxels by rising key, or the given ones where they are of one material.

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        self._check_voxels(surface)
        header = Header(stamp_ns, frame_id, light_problem)
        scanned = self.predictor.model_id, self.settings, header, digest(surface)
        if memory.last is not None and memory.last[0] == scanned:
            return memory.last[1]
        found = self._segmented_materials(surface, memory, header)
        memory.last = scanned, found
        return found

    def _segmented_materials(
        self, given: ObservedSurface, memory: ScanMemory, header: Header
    ) -> MaterialMap:
        surface = in_key_order(given)
        turned = upright(surface, self.settings.up)
        observed = seen_light(turned)
        clock = [time.perf_counter()]
        with one_blas_thread():
            scene = memory.segmenter.segment(turned, observed)
            partition, light = scene.partition, None
            clock.append(time.perf_counter())
            large = self._large_materials(partition, turned)
            if len(large) == 1 and self.predictor.sees_light:
                # One material says little of the light: the network's albedo is the better one.
                turned = upright(given, self.settings.up)
                ids = partition.ids_of(turned.voxel_keys)
                only = Partition.of(turned, np.where(ids == large[0], ids, UNASSIGNED))
                light = infer_light(turned, seen_light(turned), only)
                clock.append(time.perf_counter())
                return _timed(self._map((given, turned), partition, light, header), clock)
            bases = scene.bases()
            answers = memory.known(self.predictor.model_id, bases)
            if self.predictor.sees_light:
                unknown = bases.keys() - answers.keys()
                light = infer_light(
                    turned, observed, partition, joint=scene.joint, evidence_of=unknown
                )
            clock.append(time.perf_counter())
            found = self._map((surface, turned), partition, light, header, scene.sight, answers)
        memory.remember(self.predictor.model_id, bases, answers)
        return _timed(found, clock)

    def material_at(
        self,
        surface: ObservedSurface,
        point: NDArray[np.float64],
        stamp_ns: int,
        frame_id: str,
        light_problem: str = "",
    ) -> BrdfEstimate | None:
        """Divide a scan into materials and estimate the BRDF of the one at a point.

        Nothing is remembered from one call to the next: the same scan gives the same bits.

        Args:
            surface: the scan, world frame.
            point: (3,) on the surface or near it, world frame, metres.
            stamp_ns: stamp of the keyframe's image.
            frame_id: camera frame of that image.
            light_problem: a warning about the scene's light, or "".

        Returns:
            The estimate; None where the scan is of one material, which :meth:`estimate` is for.

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        self._check_voxels(surface)
        surface = in_key_order(surface)
        turned = upright(surface, self.settings.up)
        observed = seen_light(turned)
        header = Header(stamp_ns, frame_id, light_problem)
        with one_blas_thread():
            scene = Segmenter().segment(turned, observed)
            ids = scene.partition.ids_of(turned.voxel_keys)
            large = self._large_materials(scene.partition, turned)
            if len(large) < 2:
                return None
            found = nearest_material(
                surface.positions,
                np.where(np.isin(ids, large), ids, UNASSIGNED),
                point - surface.origin,
            )
            light = None
            if self.predictor.sees_light:
                light = infer_light(
                    turned, observed, scene.partition, joint=scene.joint, evidence_of=(found,)
                )
            alone = Partition.of(turned, np.where(ids == found, ids, UNASSIGNED))
            mapped = self._map((surface, turned), alone, light, header, scene.sight)
        if not mapped.materials:
            raise NoEstimate(
                f"material {found}, in the middle of the view, was observed too seldom to find its "
                "albedo: look at it from more sides"
            )
        return mapped.materials[0].estimate

    def _map(
        self,
        surfaces: tuple[ObservedSurface, ObservedSurface],
        partition: Partition,
        light: SceneLight | None,
        header: Header,
        sight: SurfaceSight | None = None,
        answers: dict[int, GlossAnswer] | None = None,
    ) -> MaterialMap:
        """Estimate all materials of a surface, given as scanned and turned upright.

        ``answers`` that are known already are used; those to other materials are added.
        """
        answers = {} if answers is None else answers
        surface, turned = surfaces
        ids = partition.ids_of(turned.voxel_keys)
        rho_d = np.full((surface.voxel_count, 3), np.nan, np.float32)
        stddev = rho_d.copy()
        scene, publisher = None, self._publisher
        if light is not None and light.joint is not None:
            publisher = self._scene_publisher
        predictor = publisher.predictor
        if light is not None:
            options = self.settings.gloss_voxels, self.settings.gloss_information
            scene = SceneEstimates(turned, light, *options, sight)
        materials = []
        for material_id, part in partition.parts(turned):
            if int((part.observation_counts > 0).sum()) < self.settings.min_voxels:
                continue
            if light is not None and material_id not in light.inferred:
                continue
            voxels, error = np.flatnonzero(ids == material_id), math.nan
            if light is None or scene is None:
                prediction = predictor.predict(part)
                estimate = publisher.estimate(part, prediction, None, header)
                rho_d[voxels], stddev[voxels] = estimate.rho_d, estimate.rho_d_stddev
            else:
                if material_id in answers:
                    prediction, gloss = answers[material_id]
                    chosen = predictor.chosen(part)
                    prediction = replace(prediction, voxels=chosen)
                else:
                    gloss = scene.posterior(voxels)
                    explained = explain_material(light, material_id)
                    explained = replace(explained, posterior=gloss)
                    prediction = predictor.predict(part, explained)
                    answers[material_id] = prediction, gloss
                found = scene.of_material(material_id, voxels, prediction, gloss)
                mixture = _mixture(light, material_id) if light.joint is None else ""
                estimate = publisher.estimate(part, prediction, found, header, mixture)
                rho_d[voxels], stddev[voxels] = found.rho_d, found.rho_d_stddev
                error = found.photometric_error
            place = surface.positions[voxels], surface.origin
            materials.append(_material(material_id, *place, estimate, error))
        materials.sort(key=lambda material: (-material.area, material.id))
        return MaterialMap(
            header.stamp_ns,
            header.frame_id,
            surface,
            partition,
            tuple(materials[:MOST_MATERIALS]),
            rho_d,
            stddev,
            light,
        )

    def _large_materials(self, partition: Partition, surface: ObservedSurface) -> NDArray[np.int64]:
        """Ids of the materials with enough observed voxels for an estimate, rising."""
        counts = np.bincount(partition.ids_of(surface.voxel_keys))
        large = np.flatnonzero(counts >= self.settings.min_voxels)
        return np.asarray(large[large != UNASSIGNED])

    def _check_voxels(self, surface: ObservedSurface) -> None:
        observed = int((surface.observation_counts > 0).sum())
        if observed < self.settings.min_voxels:
            raise NoEstimate(
                f"{observed} voxels have been observed and estimation.min_voxels is "
                f"{self.settings.min_voxels}: scan more of the object, or check the region of "
                "interest, fusion.max_depth, fusion.voxel_size and the camera's intrinsics"
            )


def _timed(found: MaterialMap, clock: list[float]) -> MaterialMap:
    """Add how long the stages took that began at the times of ``clock``; the last ends now."""
    ends = [*clock[1:], time.perf_counter()]
    lasted = (end - start for start, end in zip(clock, ends, strict=True))
    stages = ("segmentation", "light", "materials")
    return replace(found, seconds=dict(zip(stages, lasted, strict=True)))


def _material(
    material_id: int,
    positions: NDArray[np.float32],
    origin: NDArray[np.float64],
    estimate: BrdfEstimate,
    error: float,
) -> MaterialEstimate:
    extent = voxel_extent(positions)
    x, y, z = (np.array(extent.centroid) + origin).tolist()
    return MaterialEstimate(
        material_id,
        estimate,
        (x, y, z),
        extent.size,
        extent.area,
        len(positions),
        error,
    )


def _mixture(light: SceneLight, material_id: int) -> str:
    """Why the only material of a scene is more than one, as a clause, or ""."""
    found = albedos_of_material(light, material_id)
    if found is None or not found.is_mixed:
        return ""
    return f"{found.share:.0%} of the surface is of another colour"
