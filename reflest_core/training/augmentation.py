"""Changes to a scene that keep its physics true: fewer views and voxels, turns, swaps."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.training.sample import Sample


def keep_voxels(surface: ObservedSurface, voxels: NDArray[np.int64]) -> ObservedSurface:
    """The surface with only the voxels (N,) of the given indices."""
    counts = surface.observation_counts[voxels]
    offsets = np.concatenate([[0], np.cumsum(counts)])
    rows = np.repeat(surface.offsets[voxels] - offsets[:-1], counts) + np.arange(offsets[-1])
    return dataclasses.replace(
        surface,
        positions=surface.positions[voxels],
        normals=surface.normals[voxels],
        offsets=offsets,
        colours=surface.colours[rows],
        view_indices=surface.view_indices[rows],
    )


def keep_views(surface: ObservedSurface, views: NDArray[np.int64]) -> ObservedSurface:
    """The surface as it was seen from only the views of the given indices."""
    kept = np.zeros(len(surface.view_centres), np.bool_)
    kept[views] = True
    seen = kept[surface.view_indices]
    running = np.concatenate([[0], np.cumsum(seen)])
    return dataclasses.replace(
        surface,
        offsets=running[surface.offsets],
        colours=surface.colours[seen],
        view_indices=surface.view_indices[seen],
    )


def turn_world(surface: ObservedSurface, angle: float) -> ObservedSurface:
    """The surface and its cameras turned about the vertical by ``angle`` radians."""
    cosine, sine = math.cos(angle), math.sin(angle)
    rotation = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], np.float32)
    return dataclasses.replace(
        surface,
        positions=surface.positions @ rotation.T,
        normals=surface.normals @ rotation.T,
        view_centres=surface.view_centres @ rotation.T,
    )


def swap_channels(sample: Sample, order: NDArray[np.int64]) -> Sample:
    """The scene as it would be with the light's and the material's colour channels permuted."""
    surface = dataclasses.replace(
        sample.surface,
        colours=sample.surface.colours[:, order],
        view_foreground=sample.surface.view_foreground[:, order],
        view_background=sample.surface.view_background[:, order],
    )
    return Sample(surface, np.concatenate([sample.ward[:3][order], sample.ward[3:]]))


@dataclasses.dataclass(frozen=True)
class Augmentation:
    """How far training scenes are varied.

    ``views``: least and most views kept. ``voxels``: candidates that voxel choice sees.
    ``azimuth``: hemisphere images turn by up to this many radians either way.
    """

    views: tuple[int, int] = (20, 100)
    voxels: int = 120
    azimuth: float = math.pi / 6
    channel_swap: bool = True

    def apply(self, sample: Sample, rng: np.random.Generator) -> Sample:
        """A varied copy of ``sample``."""
        surface = sample.surface
        voxels = rng.permutation(surface.voxel_count)[: self.voxels]
        surface = keep_voxels(surface, voxels)
        views = len(surface.view_centres)
        kept = int(rng.integers(min(self.views[0], views), min(self.views[1], views) + 1))
        surface = keep_views(surface, rng.permutation(views)[:kept])
        surface = turn_world(surface, rng.uniform(0, 2 * math.pi))
        varied = Sample(surface, sample.ward)
        return swap_channels(varied, rng.permutation(3)) if self.channel_swap else varied
