# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The networks in PyTorch, each with the features that it eats, for training and for CUDA."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.inference.material import Explanation
from reflest_core.models.grouplet.grouplets import NODES_PER_VOXEL, draw_grouplets
from reflest_core.models.grouplet.live import SEED
from reflest_core.models.grouplet.network import Grouplet
from reflest_core.models.hemicnn.hemisphere_images import hemisphere_images
from reflest_core.models.hemicnn.network import HemiCNN
from reflest_core.models.lightnet.network import LightNet
from reflest_core.models.lightnet.surface_shading import surface_shading
from reflest_core.surface.observed_surface import ObservedSurface

Inputs = tuple[torch.Tensor, ...]


@dataclass(frozen=True)
class FeatureDraw:
    """How features are drawn: the grouplets' ``seed`` and number, and a turn of all azimuths."""

    seed: int
    azimuth: float = 0.0
    nodes_per_voxel: int = NODES_PER_VOXEL


LIVE_DRAW = FeatureDraw(SEED)
"""How an estimate draws, always."""


class Features(Protocol):
    """Builds a network's inputs."""

    def __call__(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        draw: FeatureDraw,
        found: Explanation | None = None,
    ) -> Inputs:
        """Build the inputs of a surface at chosen voxels, unbatched."""


@dataclass(frozen=True)
class NetworkKind:
    """``features`` of a surface at chosen voxels are the arguments of ``make()``, unbatched.

    ``make()`` gives z-scored parameters, or their means and log variances.
    """

    make: Callable[[], torch.nn.Module]
    features: Features


def hemicnn_features(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    draw: FeatureDraw,
    found: Explanation | None = None,
) -> Inputs:
    """Hemisphere images (N, 3, 10, 10)."""
    azimuths = np.full(len(voxels), draw.azimuth)
    return (torch.from_numpy(hemisphere_images(surface, voxels, azimuths)),)


def grouplet_features(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    draw: FeatureDraw,
    found: Explanation | None = None,
) -> Inputs:
    """Branches (N nodes, 5, 12) and normals (N nodes, 3), 10 nodes a voxel unless drawn fewer."""
    drawn = draw_grouplets(surface, voxels, draw.seed, draw.nodes_per_voxel)
    return torch.from_numpy(drawn.branches), torch.from_numpy(drawn.normals)


def lightnet_features(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    draw: FeatureDraw,
    found: Explanation | None = None,
) -> Inputs:
    """The arrays of :class:`~reflest_core.models.lightnet.shading.Shading` that LightNet takes."""
    look = surface_shading(surface, voxels, found)
    names = list(inspect.signature(LightNet.forward).parameters)[1:]
    return tuple(torch.from_numpy(np.ascontiguousarray(getattr(look, name))) for name in names)


NETWORKS = {
    "hemicnn": NetworkKind(HemiCNN, hemicnn_features),
    "grouplet": NetworkKind(Grouplet, grouplet_features),
    "lightnet": NetworkKind(LightNet, lightnet_features),
}
