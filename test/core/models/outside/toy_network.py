# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A network from outside the package: mean colours of the voxels, through one layer."""

from typing import ClassVar

import numpy as np

from reflest_core.models.definition import Model, NetworkDefinition
from reflest_core.models.recipe import Augmentation, Recipe


class ToyDefinition(NetworkDefinition):
    name = "toy"
    models = (Model("toy", voxels=12),)
    recipes: ClassVar = {
        "ours": Recipe(
            network="toy",
            loss="rmse1",
            optimiser="adam",
            learning_rate=1e-2,
            momentum=0.0,
            minibatches=30,
            batch_size=4,
            voxels=8,
            validation_voxels=12,
            augmentation=Augmentation(views=(5, 30), candidates=30),
        )
    }

    def module(self):
        from toy_module import Toy

        return Toy()

    def features(self, surface, voxels, found=None):
        colours = np.zeros((len(voxels), 3), np.float32)
        for row, voxel in enumerate(voxels):
            seen = surface.colours[surface.offsets[voxel] : surface.offsets[voxel + 1]]
            if len(seen):
                colours[row] = seen.mean(axis=0) / 255.0
        return (colours,)
