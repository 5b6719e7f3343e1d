# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sizes of ``lightnet``'s layers, which its two forms and its weight files share."""

from __future__ import annotations

from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.models.lightnet.gloss_evidence import GLOSS_EVIDENCE
from reflest_core.models.lightnet.light_zones import ZONES
from reflest_core.models.lightnet.scene_statistics import CHANNEL_STATISTICS, STATISTICS

ROUGHNESS_COUNT = len(ROUGHNESSES)
OBSERVATION_INPUTS = 3 + 3 * ROUGHNESS_COUNT
FIT_INPUTS = 3 * ROUGHNESS_COUNT
VOXEL_INPUTS = 7 + FIT_INPUTS
CHANNEL_INPUTS = CHANNEL_STATISTICS + FIT_INPUTS + ZONES
SHARED_INPUTS = STATISTICS + 2 * ZONES
OBSERVATION, VOXEL, CHANNEL, SCENE, HEADS = 32, 48, 86, 72, 6
"""Widths of the stages, and the number of ways in which voxels are weighed against each other."""

UPDATE = 8
"""Width of the update; few numbers, for few scenes teach it."""

TWO_LAYERS = {
    "observation": (OBSERVATION_INPUTS, OBSERVATION, OBSERVATION),
    "voxel": (3 * OBSERVATION + VOXEL_INPUTS, VOXEL, VOXEL),
    "channel": (2 * VOXEL + 2 * CHANNEL_INPUTS + SHARED_INPUTS, CHANNEL, SCENE),
    "gloss": (2 * SCENE, SCENE, SCENE),
    "diffuse": (2 * SCENE, SCENE, SCENE),
}
"""Inputs of each stage of two layers, and the widths of the two."""
FOUND_ALBEDOS, FOUND_STRENGTHS, FOUND_ROUGHNESSES = 3, 1, 2
"""Answers of the physics to ``rho_d``, ``rho_s`` and ``alpha``."""
ONE_LAYER = {
    "attention": (VOXEL, HEADS),
    "diffuse_head": (SCENE, 3 + FOUND_ALBEDOS),
    "strength_head": (SCENE, 3 + FOUND_STRENGTHS),
    "roughness_head": (SCENE, 3 + FOUND_ROUGHNESSES),
    "update": (GLOSS_EVIDENCE + 4, UPDATE),
    "update_gloss": (UPDATE, 6),
    "update_albedo": (UPDATE + 2, 2),
}
"""Inputs and outputs of the others. Of a head: what the network adds, the log variance, and logits
of the weights of the physics' answers and of none of them. Of the update: weights of the
posterior's two answers, and what is added to means and log variances."""
UPDATE_HEADS = ("update_gloss", "update_albedo")
"""Where these are 0 the update changes nothing."""
ADDED = "update"
"""What the names of tensors begin with that earlier weight files lack."""
STANDARDS = {"of_channel": CHANNEL_INPUTS, "of_all": SHARED_INPUTS}
"""Inputs that are taken in standard units."""


def _shapes() -> dict[str, tuple[int, ...]]:
    layers = dict(ONE_LAYER)
    for name, (inputs, width, outputs) in TWO_LAYERS.items():
        layers |= {f"{name}.0": (inputs, width), f"{name}.2": (width, outputs)}
    shapes: dict[str, tuple[int, ...]] = {"found_scale": (3,)}
    for name, inputs in STANDARDS.items():
        shapes |= {f"{name}.mean": (inputs,), f"{name}.variance": (inputs,), f"{name}.seen": (1,)}
    for name, (inputs, outputs) in layers.items():
        shapes |= {f"{name}.weight": (outputs, inputs), f"{name}.bias": (outputs,)}
    return shapes


SHAPES = _shapes()
"""Of every tensor, by its name in the PyTorch module."""
