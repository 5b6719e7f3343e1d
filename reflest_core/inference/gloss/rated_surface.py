# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The observations that hold most information about roughness.

Highlights are rare: voxels spread evenly over a surface miss them. What an observation will say is
known before it is looked at, from the light in its mirrored direction and from the quality of its
normal. So the choice takes dark observations beside an expected highlight like the highlight
itself, and it does not depend on the colours that are then explained.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.colour_noise import HIGHLIGHT_ERROR, colour_variances
from reflest_core.inference.gloss.mirrored_rays import (
    START,
    STEP,
    OccupiedCells,
    leaves_object,
)
from reflest_core.inference.gloss.normal_quality import normal_deviations
from reflest_core.jit import compiled, kernel_array, vectorised
from reflest_core.light.completion import RADIANCE, LightPyramid, doubled, halved
from reflest_core.surface.observed_surface import ObservedSurface

STEEPEST = 0.3
"""Cosine between normal and view, below which an observation is not used."""
FEWEST_OBSERVATIONS, MOST_OBSERVATIONS = 4, 16
"""Of a voxel that is chosen; more are thinned evenly over the order in which they were made."""
GOOD_NORMAL = math.radians(3.0)
"""Standard deviation of a normal, up to which a voxel is chosen."""
FEWEST_GOOD, FAIR_NORMAL = 200, math.radians(6.0)
"""With fewer voxels of good normals, so many of fair normals are taken."""
CHOSEN = 200
"""Voxels whose observations are explained."""
USUAL_GLOSS = 0.05
"""``rho_s`` for which information is predicted."""
BANDS = 3
"""Between levels of the pyramid: roughnesses of about .02, .05 and .1 with texels of 2 degrees."""
USUAL_EXCESS = 4.0
"""Radiance of a lamp above white, in units of white, where the camera clipped it."""
TRUST = 3.0
"""Power of the share of a lobe's light that was seen, by which its observation counts."""


@dataclass(frozen=True)
class RatedSurface:
    """What every voxel may say about roughness, before its colours are explained.

    Attributes:
        deviations: (V,) of normals about each tangent axis, radians.
        is_usable: (O,) rated observations from above whose mirrored ray leaves the object.
        counts: (V,) usable observations.
        information: (V,) predicted Fisher information about ``ln alpha`` at a usual ``rho_s``.
    """

    deviations: NDArray[np.float32]
    is_usable: NDArray[np.bool_]
    counts: NDArray[np.int64]
    information: NDArray[np.float64]

    @staticmethod
    def of(surface: ObservedSurface, light: LightPyramid) -> RatedSurface:
        """Rate all voxels of a surface.

        Args:
            surface: V voxels.
            light: the completed light.
        """
        deviations = normal_deviations(surface.positions, surface.normals, surface.neighbour_radius)
        occupied = OccupiedCells.of(surface.positions)
        is_usable, counts, information = _rate(
            kernel_array(surface.positions, np.float32),
            kernel_array(surface.normals, np.float32),
            surface.offsets,
            surface.view_indices,
            surface.view_centres,
            surface.colours,
            colour_variances(),
            deviations <= _normal_limit(deviations),
            occupied.cells,
            occupied.origin,
            occupied.size,
            light_bands(light).astype(np.float64),  # which the kernel computes in
            len(light.levels[0]),
        )
        return RatedSurface(deviations, is_usable, counts, information)

    def choose(self, voxels: NDArray[np.int64], most: int = CHOSEN) -> NDArray[np.int64]:
        """Choose voxels by their predicted information, independently of their order.

        Args:
            voxels: (N,) candidates, indices into the surface.
            most: voxels to choose.

        Returns:
            At most ``most`` of the candidates, rising.
        """
        candidates = np.sort(voxels)
        candidates = candidates[self.counts[candidates] >= FEWEST_OBSERVATIONS]
        candidates = candidates[self.information[candidates] > 0.0]
        order = np.argsort(-self.information[candidates], kind="stable")
        return np.sort(candidates[order[:most]])


def light_bands(light: LightPyramid) -> NDArray[np.float32]:
    """Return what each direction of the light says about roughness: differences of its blurs.

    A highlight of roughness ``alpha`` is the light blurred by the lobe. Its derivative by ``ln
    alpha`` is the difference of two blurs, a band-pass of the light. One look-up of each band in
    the mirrored direction predicts how much an observation says about roughness.

    Args:
        light: The completed light; its finest level has edge N.

    Returns:
        (N * N, 3 * BANDS + 1): derivatives of the reflected radiance at ``rho_s = 1`` by
        ``ln alpha``, three channels for each band, then how far the light there is to be trusted,
        in [0, 1].
    """
    levels = light.levels[: BANDS + 1]
    size = len(levels[0])
    excess = light.excess
    blurred = []
    for level in levels:
        bright = level[..., RADIANCE] + np.float32(USUAL_EXCESS) * excess
        blurred.append(_at_size(np.concatenate([bright, level[..., 3:4]], axis=-1), size))
        excess = halved(excess)
    bands = [
        (fine[..., RADIANCE] - coarse[..., RADIANCE]) / np.float32(math.log(2.0))
        for fine, coarse in pairwise(blurred)
    ]
    trust = np.clip(blurred[-2][..., 3:], 0.0, 1.0) ** np.float32(TRUST)
    return np.concatenate([*bands, trust], axis=-1).reshape(size * size, -1).astype(np.float32)


def _at_size(image: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    while len(image) < size:
        image = doubled(image)
    return image


def _normal_limit(deviations: NDArray[np.float32]) -> float:
    """The largest deviation of a normal with which a voxel is chosen."""
    fewest = min(FEWEST_GOOD, len(deviations)) - 1
    if fewest < 0:
        return GOOD_NORMAL
    return max(GOOD_NORMAL, min(float(np.partition(deviations, fewest)[fewest]), FAIR_NORMAL))


@compiled
def _rate(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    colours: NDArray[np.uint8],
    variances: NDArray[np.float64],
    is_candidate: NDArray[np.bool_],
    cells: NDArray[np.uint8],
    origin: NDArray[np.float64],
    cell_size: float,
    bands: NDArray[np.float64],
    edge: int,
) -> tuple[NDArray[np.bool_], NDArray[np.int64], NDArray[np.float64]]:
    """``is_usable`` (O,), ``counts`` (V,) and ``information`` (V,) of :class:`RatedSurface`."""
    voxels, channels = len(positions), 3 * BANDS
    is_usable = np.zeros(len(view_indices), np.bool_)
    counts, information = np.zeros(voxels, np.int64), np.zeros(voxels)
    mass, first, second = np.zeros(channels), np.zeros(channels), np.zeros(channels)
    centres, mirrored = (
        np.ones((3, MOST_OBSERVATIONS), np.float32),
        np.zeros((4, MOST_OBSERVATIONS)),
    )
    texels = np.zeros(MOST_OBSERVATIONS, np.int64)
    for voxel in range(voxels):
        if not is_candidate[voxel]:
            continue
        mass[:], first[:], second[:] = 0.0, 0.0, 0.0
        nx, ny, nz = normals[voxel, 0], normals[voxel, 1], normals[voxel, 2]
        px, py, pz = positions[voxel, 0], positions[voxel, 1], positions[voxel, 2]
        start_x = (px - origin[0]) / cell_size + START * nx
        start_y = (py - origin[1]) / cell_size + START * ny
        start_z = (pz - origin[2]) / cell_size + START * nz
        first_row, made = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        taken = min(made, MOST_OBSERVATIONS)
        for slot in range(taken):
            view = view_indices[first_row + slot * made // taken]
            for axis in range(3):
                centres[axis, slot] = view_centres[view, axis]
        _mirror(positions[voxel], normals[voxel], centres, edge, mirrored, texels)
        for slot in range(taken):
            mx, my, mz, cosine = mirrored[:, slot]
            if not cosine > STEEPEST:
                continue
            if not leaves_object(cells, start_x, start_y, start_z, STEP * mx, STEP * my, STEP * mz):
                continue
            o, texel = first_row + slot * made // taken, texels[slot]
            is_usable[o] = True
            counts[voxel] += 1
            trust = bands[texel, channels]
            for channel in range(3):
                colour = colours[o, channel]
                if colour == 255:  # a bound alone
                    continue
                variance = variances[colour]
                for i in range(channel, channels, 3):
                    slope = USUAL_GLOSS * bands[texel, i]
                    spread = HIGHLIGHT_ERROR * slope
                    weight = trust / (variance + spread * spread)
                    mass[i] += weight
                    first[i] += weight * slope
                    second[i] += weight * slope * slope
        if counts[voxel] >= FEWEST_OBSERVATIONS:
            for i in range(channels):
                if mass[i] > 0.0:
                    information[voxel] += second[i] - first[i] * first[i] / mass[i]
    return is_usable, counts, information


@vectorised
def _mirror(
    position: NDArray[np.float32],
    normal: NDArray[np.float32],
    centres: NDArray[np.float32],
    edge: int,
    mirrored: NDArray[np.float64],
    texels: NDArray[np.int64],
) -> None:
    """Mirror a voxel's directions to cameras, all at once.

    Args:
        position: (3,) of the voxel.
        normal: (3,) unit.
        centres: (3, MOST_OBSERVATIONS) of the cameras; those beyond the voxel's count for nothing.
        edge: of the light's map.
        mirrored: (4, MOST_OBSERVATIONS) takes the mirrored directions, and the cosine between
            normal and view; -1 for a camera on the voxel.
        texels: (MOST_OBSERVATIONS,) takes :func:`.octahedral_texel` of the mirrored directions.
    """
    px, py, pz = position[0], position[1], position[2]
    nx, ny, nz = normal[0], normal[1], normal[2]
    for n in range(MOST_OBSERVATIONS):
        dx, dy, dz = centres[0, n] - px, centres[1, n] - py, centres[2, n] - pz
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        cosine = (dx * nx + dy * ny + dz * nz) / length
        mx = 2.0 * cosine * nx - dx / length
        my = 2.0 * cosine * ny - dy / length
        mz = 2.0 * cosine * nz - dz / length
        mirrored[0, n], mirrored[1, n], mirrored[2, n] = mx, my, mz
        mirrored[3, n] = cosine if length > 0.0 else -1.0
        norm = abs(mx) + abs(my) + abs(mz)
        u, v = mx / norm, my / norm
        folded_u = (1.0 - abs(v)) * (1.0 if u >= 0.0 else -1.0)
        folded_v = (1.0 - abs(u)) * (1.0 if v >= 0.0 else -1.0)
        u, v = (folded_u if mz < 0.0 else u), (folded_v if mz < 0.0 else v)
        column = min(max(int((u + 1.0) * 0.5 * edge), 0), edge - 1)
        row = min(max(int((v + 1.0) * 0.5 * edge), 0), edge - 1)
        texels[n] = row * edge + column
