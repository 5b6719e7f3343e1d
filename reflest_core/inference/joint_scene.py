# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene of several segments in one light, by alternating estimates of gloss and light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.gloss_fit import GlossFit
from reflest_core.inference.joint_light import (
    TURNS_AGAIN,
    JointInference,
    JointLight,
)
from reflest_core.inference.light_from_shading import InferredLight
from reflest_core.inference.light_prior import DIM
from reflest_core.inference.transport.light_patches import patches_of
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.light.light_map import ObservedLight
from reflest_core.surface.diffuse_colours import diffuse_colours
from reflest_core.surface.observed_surface import ObservedSurface

DIM_TURNS = 2
"""Gauss-Newton steps from the solution under the usual prior to that under a dim one."""


@dataclass(frozen=True)
class JointScene:
    """Segments and their light.

    Attributes:
        labels: (V,) int64, the segment of each voxel, -1 for none.
        occluders: surfels of the whole scene.
        light: the light, with ``rho_d`` and ``rho_s`` of each segment.
        dim: the same if unseen light is dim; the difference shows how far it depends on the prior.
        gloss: of each segment, fitted under the light that the last round began with; None where
            there were too few observations.
    """

    labels: NDArray[np.int64]
    occluders: SceneOccluders
    light: JointLight
    dim: JointLight
    gloss: tuple[GlossFit | None, ...]

    def has_albedo(self, voxels: NDArray[np.int64]) -> bool:
        """Whether a segment of some voxels had enough observations for an albedo.

        Args:
            voxels: (N,) indices.
        """
        labels = self.labels[voxels]
        return bool(np.isfinite(self.light.rho_d[labels[labels >= 0], 0]).any())

    def of_voxels(self, voxels: NDArray[np.int64]) -> tuple[InferredLight, InferredLight]:
        """The light with the mean albedo of some voxels, under the usual prior and a dim one.

        Args:
            voxels: (N,) indices, of which at least one has a segment with an albedo.
        """
        shares = self._shares(voxels)
        return _of_segments(self.light, shares), _of_segments(self.dim, shares)

    def segments_of(self, voxels: NDArray[np.int64]) -> list[NDArray[np.int64]]:
        """Divide some voxels by segment.

        Args:
            voxels: (N,) indices.

        Returns:
            The indices in each segment that has some.
        """
        labels = self.labels[voxels]
        return [voxels[labels == segment] for segment in np.unique(labels) if segment >= 0]

    def gloss_of(self, voxels: NDArray[np.int64]) -> tuple[float, float]:
        """Mean ``rho_s`` of some voxels, and its standard deviation.

        Args:
            voxels: (N,) indices, of which at least one has a segment with an albedo.
        """
        shares = self._shares(voxels)
        deviation = np.nan_to_num(self.light.rho_s_deviation)
        return float(shares @ self.light.rho_s), float(shares @ deviation)

    def _shares(self, voxels: NDArray[np.int64]) -> NDArray[np.float64]:
        """(S,) share of each segment in those voxels that have one with observations."""
        labels = self.labels[voxels]
        counts = np.bincount(labels[labels >= 0], minlength=len(self.light.rho_s))
        counts = np.where(np.isnan(self.light.rho_d[:, 0]), 0, counts)
        return np.asarray(counts / counts.sum())


def infer_jointly(
    surface: ObservedSurface,
    observed: ObservedLight,
    labels: NDArray[np.int64],
    occluders: SceneOccluders | None = None,
    known: JointLight | None = None,
) -> JointScene:
    """Infer the light of a scene and the albedo of its segments.

    Args:
        surface: V voxels with their observations.
        observed: the light as it was seen.
        labels: (V,) segment 0, 1, ... of each voxel, -1 for none; one at least is observed.
        occluders: surfels of the scene; None computes them.
        known: the scene's light as it was inferred before, for any segments: gloss is fitted under
            it, and the new light begins from it; None begins from what was seen, and infers twice.
    """
    if occluders is None:
        colours = diffuse_colours(surface, np.arange(surface.voxel_count), 0.5)
        occluders = SceneOccluders.of(surface.positions, surface.normals, colours)
    inference = JointInference(surface, labels, observed, occluders)
    if known is None:
        _, gloss = inference.gloss()
        known = inference.infer(gloss)
    fits, gloss = inference.gloss(known.light)
    light = inference.infer(gloss, turns=TURNS_AGAIN, known=known)
    dim = inference.infer(gloss, light, DIM_TURNS, DIM)
    return JointScene(labels, occluders, light, dim, tuple(fits))


def _of_segments(light: JointLight, shares: NDArray[np.float64]) -> InferredLight:
    """The light with the mean albedo of segments of these shares (S,)."""
    return InferredLight(
        *patches_of(light.factors),
        (shares @ np.nan_to_num(light.rho_d)).astype(np.float32),
        (shares @ np.nan_to_num(light.rho_d_log_deviation)).astype(np.float32),
        light.misfit.astype(np.float32),
    )
