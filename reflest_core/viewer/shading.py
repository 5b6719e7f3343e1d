# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Vertices with their materials in a light: the model that the estimates were made with.

The radiance towards the camera is ``rho_d E / pi + rho_s S``. The irradiance ``E`` and the Ward
lobe ``S`` are integrated as the estimator does it, with what the scan hides from itself
(:mod:`.surface_irradiance`, :mod:`.voxel_albedo`). In the estimated light this reproduces what was
observed, up to the estimate's photometric error.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.estimation.material_map import MaterialEstimate
from reflest_core.inference.transport.patch_grid import patches_of_texels
from reflest_core.inference.transport.scene_occluders import SceneOccluders, cell_groups
from reflest_core.inference.transport.surface_irradiance import (
    NORMALS,
    SurfaceSight,
    surface_irradiance,
)
from reflest_core.inference.transport.visibility import Sight
from reflest_core.inference.transport.ward_lobe import half_vectors
from reflest_core.inference.voxel_albedo import RINGS, SECTORS, lobe_level, mirrored_radiance
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.completion import LightPyramid, levels_below
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.octahedral import octahedral_directions, octahedral_texels
from reflest_core.rendering.voxel_colours import UNKNOWN
from reflest_core.surface.diffuse_colours import diffuse_colours
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.lights import Light, invented_light, octahedral_light, turned_pyramid
from reflest_core.viewer.shown_scan import ShownScan

USUAL_IRRADIANCE = 0.5
"""``E / pi`` in the mean of lights to show a scan in whose own light is not known."""
GROUPS_AT_ONCE = 4096
"""Cells whose sight is computed together."""
MEASURED = 2000
"""Vertices whose irradiance is averaged."""


class Shading:
    """Renders the vertices of one scan."""

    def __init__(self, scan: ShownScan) -> None:
        """Compute what each vertex sees of the light.

        Args:
            scan: without a light of its own, the estimated one cannot be chosen.
        """
        self.scan = scan
        rotation = rotation_to_z(scan.up).astype(np.float32)
        self._rotation = rotation
        self._vertices = np.ascontiguousarray(scan.vertices @ rotation.T)
        self._normals = np.ascontiguousarray(scan.normals @ rotation.T)
        self._sight = self._sight_of_vertices()
        self._mean = USUAL_IRRADIANCE
        if self.scan.light is not None:
            self._mean = self._mean_irradiance(levels_below(self.scan.light))

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lights that can be chosen without a file."""
        invented = (Light.STUDIO, Light.LAMP, Light.OVERCAST)
        return invented if self.scan.light is None else (Light.ESTIMATED, *invented)

    def light(
        self, light: Light, degrees: float = 0.0, file: NDArray[np.float32] | None = None
    ) -> LightPyramid:
        """A light to render in; others than the estimated one are made as bright in the mean.

        Args:
            light: which.
            degrees: it is turned about the vertical.
            file: (H, 2 H, 3) equirectangular radiance of :attr:`.Light.FILE`.

        Returns:
            The light, +z up.
        """
        if light is Light.ESTIMATED and self.scan.light is not None:
            return turned_pyramid(self.scan.light, degrees)
        octahedral = octahedral_light(invented_light(light) if file is None else file)
        octahedral[..., :3] *= self._mean / self._mean_irradiance(levels_below(octahedral))
        return turned_pyramid(octahedral, degrees)

    def diffuse(self, light: LightPyramid) -> NDArray[np.float32]:
        """What the vertices reflect to all sides.

        Args:
            light: of :meth:`light`.

        Returns:
            (N, 3) linear radiance; NaN where there is no estimate.
        """
        return self.scan.rho_d * surface_irradiance(light, self._sight)[:, :3]

    def mirrored(self, light: LightPyramid, eye: NDArray[np.floating]) -> NDArray[np.float32]:
        """What the vertices reflect glossily towards a camera.

        Args:
            light: of :meth:`light`.
            eye: (3,) the camera's centre, world frame, metres.

        Returns:
            (N, 3) linear radiance; 0 where there is no estimate.
        """
        radiance = np.zeros((len(self.scan.vertices), 3), np.float32)
        for one in self.scan.found.materials:
            rows = np.flatnonzero(self.scan.material_ids == one.id)
            self._mirror(one, rows, light, np.asarray(eye), radiance)
        return radiance

    def towards(
        self, light: LightPyramid, vertex: int, eyes: NDArray[np.floating]
    ) -> NDArray[np.float32]:
        """What one vertex sends to several cameras.

        Args:
            light: of :meth:`light`.
            vertex: its index; it has a material.
            eyes: (K, 3) the cameras' centres, world frame, metres.

        Returns:
            (K, 3) linear radiance.
        """
        material = self.scan.material_at(vertex)
        radiance = np.zeros((len(self.scan.vertices), 3), np.float32)
        found = np.repeat(self.diffuse(light)[vertex][None], len(eyes), axis=0)
        for eye, sent in zip(eyes, found, strict=True):
            if material is not None:
                self._mirror(material, np.array([vertex]), light, eye, radiance)
                sent += radiance[vertex]
        return found

    def mirror_direction(self, light: LightPyramid, vertex: int) -> NDArray[np.float64]:
        """Where a vertex mirrors the brightest light that it sees.

        Args:
            light: of :meth:`light`.
            vertex: its index.

        Returns:
            (3,) unit, world frame.
        """
        level = light.levels[2]
        directions = octahedral_directions(len(level)).reshape(-1, 3)
        normal = self._normals[vertex]
        visible = self._sight.sight.visible[self._sight.group_of[vertex]]
        arriving = visible[patches_of_texels(len(level))] * np.clip(directions @ normal, 0.0, None)
        brightest = directions[(level.reshape(-1, 5)[:, :3].sum(axis=1) * arriving).argmax()]
        mirrored = 2.0 * (normal @ brightest) * normal - brightest
        return np.asarray(self._rotation.T @ mirrored, np.float64)

    def _mirror(
        self,
        material: MaterialEstimate,
        rows: NDArray[np.int64],
        light: LightPyramid,
        eye: NDArray[np.floating],
        radiance: NDArray[np.float32],
    ) -> None:
        rho_s, alpha = material.estimate.rho_s, material.estimate.alpha
        if not (rho_s > 0.0 and alpha > 0.0):
            return
        level = light.levels[lobe_level(light, alpha)]
        _mirror_light(
            self._vertices,
            self._normals,
            rows,
            kernel_array(self._rotation @ eye, np.float32),
            kernel_array(level.reshape(-1, 5), np.float32),
            patches_of_texels(len(level)),
            half_vectors((alpha,), RINGS, SECTORS)[0],
            self._sight.group_of,
            self._sight.sight.visible,
            self._sight.sight.own,
            rho_s,
            radiance,
        )

    def _sight_of_vertices(self) -> SurfaceSight:
        """As :meth:`.SurfaceSight.of`, in cells of a voxel: larger ones show in highlights."""
        vertices, normals = self._vertices, self._normals
        group, groups = cell_groups(vertices, normals, self.scan.voxel_size)
        first = np.zeros(groups, np.int64)
        first[group[::-1]] = np.arange(len(group))[::-1]
        occluders, parts = self._occluders(), []
        for start in range(0, groups, GROUPS_AT_ONCE):
            rows = first[start : start + GROUPS_AT_ONCE]
            weights = cosine_weights(normals[rows])
            parts.append(occluders.sight(vertices[rows], normals[rows], weights))
        sight = Sight(
            np.concatenate([part.visible for part in parts]),
            np.concatenate([part.own for part in parts]),
        )
        return SurfaceSight(octahedral_texels(normals, NORMALS), group, sight)

    def _occluders(self) -> SceneOccluders:
        scan = self.scan
        if scan.found.light is not None and isinstance(scan.found.light.occluders, SceneOccluders):
            return scan.found.light.occluders
        surface = scan.found.surface
        if scan.has_observations:
            colours = diffuse_colours(surface, np.arange(surface.voxel_count), 0.5)
        else:
            colours = USUAL_IRRADIANCE * np.nan_to_num(scan.found.rho_d)
        turn = self._rotation.T
        return SceneOccluders.of(surface.positions @ turn, surface.normals @ turn, colours)

    def _mean_irradiance(self, light: LightPyramid) -> float:
        every = max(len(self._vertices) // MEASURED, 1)
        return float(surface_irradiance(light, self._sight)[::every, :3].mean()) + 1e-9


def displayed(radiance: NDArray[np.float32], stops: float = 0.0) -> NDArray[np.uint8]:
    """Expose and encode.

    Args:
        radiance: (N, 3) linear, NaN where unknown.
        stops: exposure; each one doubles the light.

    Returns:
        (N, 3) sRGB, grey where unknown.
    """
    encoded = 255.0 * srgb.encode(np.nan_to_num(radiance) * 2.0**stops)
    return np.where(np.isfinite(radiance), np.rint(encoded), UNKNOWN).astype(np.uint8)


@compiled
def _mirror_light(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    rows: NDArray[np.int64],
    eye: NDArray[np.float32],
    light: NDArray[np.float32],
    patch_of: NDArray[np.int64],
    half: NDArray[np.float32],
    group_of: NDArray[np.int64],
    visible: NDArray[np.float32],
    own: NDArray[np.float32],
    rho_s: float,
    radiance: NDArray[np.float32],
) -> None:
    weights, texels = np.empty(half.shape[1], np.float64), np.empty(half.shape[1], np.int32)
    mirrored = np.zeros(3)
    for row in rows:
        group = group_of[row]
        towards = (eye - positions[row]) * normals[row]
        if towards[0] + towards[1] + towards[2] <= 0.0:
            radiance[row] = 0.0
            continue
        mirrored_radiance(
            positions[row],
            normals[row],
            eye,
            light,
            patch_of,
            half,
            visible[group],
            own[group],
            weights,
            texels,
            mirrored,
        )
        for channel in range(3):
            radiance[row, channel] = rho_s * mirrored[channel]
