# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The side file of a sequence: the truth, in the estimate's own field names."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

from reflest_core.brdf.gloss import to_labcd
from reflest_core.synbrdf.sequences.sequence_scene import SequenceRequest, SequenceScene

TRUTH = "truth.json"


def write_truth(
    folder: Path, request: SequenceRequest, scene: SequenceScene, exposure: float, command: str
) -> None:
    """Write ``truth.json``. The estimator never opens it.

    Args:
        folder: of the data set, or to write into.
        request: the sequence that was asked for.
        scene: the scene.
        exposure: factor from radiance to the sensor's white.
        command: that reproduces the sequence.
    """
    material, labcd = scene.material, to_labcd(scene.material)
    truth: dict[str, Any] = {
        "ward_variant": material.variant.value,
        "rho_d": material.rho_d,
        "rho_s": material.rho_s,
        "alpha": material.alpha,
        "lab": labcd.lab,
        "c": labcd.c,
        "d": labcd.d,
        "material_source": scene.material_source,
        "material_name": scene.material_name,
        "shape": scene.shape,
        "diameter": scene.mesh.diameter,
        "environment": scene.light.name,
        "environment_rotation": scene.light.rotation,
        "exposure": exposure,
        "seed": request.seed,
        "frames": request.frames,
        "command": command,
    }
    if request.realism is not None:
        truth["realism"] = dataclasses.asdict(request.realism)
    (folder / TRUTH).write_text(json.dumps(truth, indent=1) + "\n")
