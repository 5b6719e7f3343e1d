# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sizes of ``lightnet``'s layers, which its two forms and its weight files share."""

from __future__ import annotations

from reflest_core.features.light.light_zones import ZONES
from reflest_core.features.light.ward_lobe import ROUGHNESSES

ROUGHNESS_COUNT = len(ROUGHNESSES)
OBSERVATION_INPUTS = 3 + 3 * ROUGHNESS_COUNT
FIT_INPUTS = 3 * ROUGHNESS_COUNT
VOXEL_INPUTS = 7 + FIT_INPUTS
ZONE_INPUTS = ZONES * (1 + 1 + 2)
OBSERVATION, VOXEL, SCENE, HEADS = 48, 64, 96, 8
"""Widths of the stages, and the number of ways in which voxels are weighed against each other."""

TWO_LAYERS = {
    "observation": (OBSERVATION_INPUTS, OBSERVATION),
    "voxel": (3 * OBSERVATION + VOXEL_INPUTS, VOXEL),
    "channel": (2 * VOXEL + FIT_INPUTS + ZONE_INPUTS, SCENE),
    "gloss": (2 * SCENE, SCENE),
}
"""Inputs and width of each stage of two layers."""
ONE_LAYER = {"attention": (VOXEL, HEADS), "diffuse_head": (2 * SCENE, 2), "gloss_head": (SCENE, 4)}
"""Inputs and outputs of the others."""


def _shapes() -> dict[str, tuple[int, ...]]:
    layers = dict(ONE_LAYER)
    for name, (inputs, width) in TWO_LAYERS.items():
        layers |= {f"{name}.0": (inputs, width), f"{name}.2": (width, width)}
    shapes: dict[str, tuple[int, ...]] = {}
    for name, (inputs, outputs) in layers.items():
        shapes |= {f"{name}.weight": (outputs, inputs), f"{name}.bias": (outputs,)}
    return shapes


SHAPES = _shapes()
"""Of every tensor, by its name in the PyTorch module."""
