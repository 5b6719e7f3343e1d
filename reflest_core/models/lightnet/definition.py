# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Definition of lightnet for the registry, with its recipes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.definition import (
    LIGHT_TRAINING,
    SHIPPED,
    Features,
    Model,
    NetworkDefinition,
)
from reflest_core.models.lightnet import VOXELS
from reflest_core.models.recipe import Recipe

if TYPE_CHECKING:
    import torch

    from reflest_core.inference.material import Explanation
    from reflest_core.models.lightnet.live import LiveLightNet
    from reflest_core.models.weights import Tensors
    from reflest_core.surface.observed_surface import ObservedSurface


class LightNetDefinition(NetworkDefinition):
    """The network that uses the light seen behind the object, and states its deviations."""

    name = "lightnet"
    models = (
        Model(
            "lightnet",
            VOXELS,
            SHIPPED / "lightnet.safetensors",
            SHIPPED / "lightnet-scenes.safetensors",
        ),
    )
    sees_light = True
    training = LIGHT_TRAINING
    recipes: ClassVar[Mapping[str, Recipe]] = {
        "ours": Recipe(
            network="lightnet",
            loss="likelihood",
            optimiser="adamw",
            learning_rate=2e-3,
            momentum=0.0,
            minibatches=6000,
            batch_size=48,
            voxels=24,
            validation_voxels=VOXELS,
            warm_up=500,
            hold=0.0,
            average=0.998,
            observations=6,
            largest_gradient=1.0,
        ),
        "scenes": Recipe(
            network="lightnet",
            loss="likelihood",
            optimiser="adamw",
            learning_rate=1e-3,
            momentum=0.0,
            minibatches=600,
            batch_size=48,
            voxels=32,
            validation_voxels=VOXELS,
            warm_up=50,
            hold=0.0,
            average=0.99,
            observations=8,
            largest_gradient=1.0,
        ),
    }

    def module(self) -> torch.nn.Module:
        """Make the untrained module; it takes the arrays of ``LightFeatures`` in their order."""
        from reflest_core.models.lightnet.network import LightNet

        return LightNet()

    def features(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        found: Explanation | None = None,
    ) -> Features:
        """Compute the arrays of ``LightFeatures``, under the light that the surface was seen in.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            voxels: (N,) indices of voxels, all observed.
            found: The material in the light of its scene; None takes the surface for a scene of
                one material.
        """
        from reflest_core.models.lightnet.features import light_features

        made = light_features(surface, voxels, found)
        return tuple(
            np.ascontiguousarray(getattr(made, field.name)) for field in dataclasses.fields(made)
        )

    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shape of every tensor by name, without PyTorch."""
        from reflest_core.models.lightnet.shapes import SHAPES

        return SHAPES

    def completed(self, tensors: Tensors) -> Tensors:
        """Return the weights with an update that changes nothing, where the file has none.

        Args:
            tensors: The file's tensors by name.
        """
        from reflest_core.models.lightnet.shapes import ADDED, SHAPES

        if any(name.startswith(ADDED) for name in tensors):
            return tensors
        added = {name: shape for name, shape in SHAPES.items() if name.startswith(ADDED)}
        return tensors | {name: np.zeros(shape, np.float32) for name, shape in added.items()}

    def live(self, tensors: Tensors, threads: int) -> LiveLightNet:
        """Make the NumPy form, which runs on one thread.

        Args:
            tensors: The trained weights by name.
            threads: CPU threads that it may use.
        """
        from reflest_core.models.lightnet.live import LiveLightNet

        return LiveLightNet(tensors)
