# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Definition of HemiCNN for the registry, with its recipes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.definition import SHIPPED, Features, Model, NetworkDefinition
from reflest_core.models.recipe import Recipe

if TYPE_CHECKING:
    import torch

    from reflest_core.inference.material import Explanation
    from reflest_core.models.hemicnn.live import LiveHemiCNN
    from reflest_core.models.minibatch import DrawnScenes, PackedScenes
    from reflest_core.models.weights import Tensors
    from reflest_core.surface.observed_surface import ObservedSurface

VOXELS = 25


class HemiCNNDefinition(NetworkDefinition):
    """The paper's siamese CNN over hemisphere images (section 3.3.1)."""

    name = "hemicnn"
    models = (Model("hemicnn", VOXELS, SHIPPED / "hemicnn-rmse1.safetensors"),)
    recipes: ClassVar[Mapping[str, Recipe]] = {
        "paper": Recipe(
            network="hemicnn",
            loss="rmse1",
            optimiser="rmsprop",
            learning_rate=1e-4,
            momentum=0.0,
            minibatches=100_000,
            batch_size=32,
            voxels=VOXELS,
            validation_voxels=VOXELS,
        ),
        "ours": Recipe(
            network="hemicnn",
            loss="rmse1",
            optimiser="adam",
            learning_rate=5e-3,
            momentum=0.0,
            minibatches=60_000,
            batch_size=32,
            voxels=VOXELS,
            validation_voxels=VOXELS,
            warm_up=500,
            hold=0.0,
            average=0.999,
        ),
    }

    def module(self) -> torch.nn.Module:
        """Make the untrained module; it takes images (B, N, 3, 10, 10)."""
        from reflest_core.models.hemicnn.network import HemiCNN

        return HemiCNN()

    def features(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        found: Explanation | None = None,
    ) -> Features:
        """Compute the hemisphere images (N, 3, 10, 10).

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            voxels: (N,) indices of voxels, all observed.
            found: The material in the light of its scene; not used, for the network sees no light.
        """
        from reflest_core.models.hemicnn.hemisphere_images import hemisphere_images

        return (hemisphere_images(surface, voxels),)

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shape of every tensor by name, without PyTorch."""
        from reflest_core.models.hemicnn.live import SHAPES

        return SHAPES

    def live(self, tensors: Tensors, threads: int) -> LiveHemiCNN:
        """Make the NumPy form, which runs on one thread.

        Args:
            tensors: The trained weights by name.
            threads: CPU threads that it may use.
        """
        from reflest_core.models.hemicnn.live import LiveHemiCNN

        return LiveHemiCNN(tensors)

    def batched_features(
        self,
        packed: PackedScenes,
        drawn: DrawnScenes,
        recipe: Recipe,
        generator: torch.Generator,
    ) -> tuple[torch.Tensor, ...]:
        """Compute images (B, N, 3, 10, 10), each scene's turned by a random azimuth.

        Args:
            packed: All training scenes.
            drawn: The scenes of the minibatch.
            recipe: The training's.
            generator: Of random numbers, on the scenes' device.
        """
        import torch

        from reflest_core.models.hemicnn.batched_hemispheres import batched_hemispheres

        scenes, device = len(drawn.voxels), packed.ward.device
        turn = recipe.augmentation.azimuth
        azimuths = turn * (2 * torch.rand(scenes, generator=generator, device=device) - 1)
        return (batched_hemispheres(packed, drawn, azimuths),)
