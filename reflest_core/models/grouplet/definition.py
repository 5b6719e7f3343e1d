# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Definition of Grouplet for the registry, with its recipes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.definition import SHIPPED, Features, Model, NetworkDefinition
from reflest_core.models.recipe import Augmentation, Recipe

if TYPE_CHECKING:
    import torch

    from reflest_core.inference.material import Explanation
    from reflest_core.models.grouplet.live import LiveGrouplet
    from reflest_core.models.minibatch import DrawnScenes, PackedScenes
    from reflest_core.models.weights import Tensors
    from reflest_core.surface.observed_surface import ObservedSurface

WEIGHTS = SHIPPED / "grouplet-rmse1.safetensors"
FAST_VOXELS, SLOW_VOXELS = 20, 354
"""The paper's numbers of voxels (section 3.3.2)."""


class GroupletDefinition(NetworkDefinition):
    """The paper's weak regressors on random observations (section 3.3.2).

    It meets the paper's size of 340 KB only in 8 bits.
    """

    name = "grouplet"
    models = (
        Model("grouplet-fast", FAST_VOXELS, WEIGHTS),
        Model("grouplet-slow", SLOW_VOXELS, WEIGHTS),
    )
    eight_bit = True
    recipes: ClassVar[Mapping[str, Recipe]] = {
        "paper": Recipe(
            network="grouplet",
            loss="rmse1",
            optimiser="sgd",
            learning_rate=0.01,
            momentum=0.9,
            minibatches=13_000,
            batch_size=24,
            voxels=FAST_VOXELS,
            validation_voxels=SLOW_VOXELS,
        ),
        "ours": Recipe(
            network="grouplet",
            loss="rmse1",
            optimiser="adam",
            learning_rate=1e-3,
            momentum=0.0,
            minibatches=30_000,
            batch_size=24,
            voxels=64,
            validation_voxels=SLOW_VOXELS,
            warm_up=500,
            hold=0.0,
            average=0.999,
            precision="bfloat16",
            augmentation=Augmentation(spread=False),
        ),
    }

    def module(self) -> torch.nn.Module:
        """Make the untrained module; it takes branches (B, G, 5, 12) and normals (B, G, 3)."""
        from reflest_core.models.grouplet.network import Grouplet

        return Grouplet()

    def features(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        found: Explanation | None = None,
    ) -> Features:
        """Draw branches (N nodes, 5, 12) and normals (N nodes, 3), 10 nodes a voxel.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            voxels: (N,) indices of voxels, all observed.
            found: The material in the light of its scene; not used, for the network sees no light.
        """
        from reflest_core.models.grouplet.grouplets import SEED, draw_grouplets

        drawn = draw_grouplets(surface, voxels, SEED)
        return drawn.branches, drawn.normals

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shape of every tensor by name, without PyTorch."""
        from reflest_core.models.grouplet.live import SHAPES

        return SHAPES

    def live(self, tensors: Tensors, threads: int) -> LiveGrouplet:
        """Make the NumPy form; any number of threads gives the same bits.

        Args:
            tensors: The trained weights by name.
            threads: CPU threads that it may use.
        """
        from reflest_core.models.grouplet.live import LiveGrouplet

        return LiveGrouplet(tensors, threads)

    def batched_features(
        self,
        packed: PackedScenes,
        drawn: DrawnScenes,
        recipe: Recipe,
        generator: torch.Generator,
    ) -> tuple[torch.Tensor, ...]:
        """Draw branches (B, N K, 5, 12) and normals (B, N K, 3) of the recipe's K nodes a voxel.

        Args:
            packed: All training scenes.
            drawn: The scenes of the minibatch.
            recipe: The training's.
            generator: Of random numbers, on the scenes' device.
        """
        import torch

        from reflest_core.models.grouplet.batched_grouplets import batched_grouplets
        from reflest_core.models.grouplet.grouplets import BRANCHES

        shape = (*drawn.voxels.shape, recipe.nodes_per_voxel, BRANCHES)
        uniform = torch.rand(shape, generator=generator, device=packed.ward.device)
        return batched_grouplets(packed, drawn, uniform)
