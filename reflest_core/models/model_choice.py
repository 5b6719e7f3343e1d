# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The ways to estimate that a user can choose from."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ModelChoice:
    """One way to estimate: which network, how many voxels N, which shipped weights.

    ``sees_light``: it needs the light around the surface and says how sure it is.
    """

    network: str
    voxels: int
    file: str
    sees_light: bool = False


MODELS = {
    "lightnet": ModelChoice("lightnet", 48, "lightnet.safetensors", sees_light=True),
    "hemicnn": ModelChoice("hemicnn", 25, "hemicnn-rmse1.safetensors"),
    "grouplet-fast": ModelChoice("grouplet", 20, "grouplet-rmse1.safetensors"),
    "grouplet-slow": ModelChoice("grouplet", 354, "grouplet-rmse1.safetensors"),
}

DEVICES = ("cpu", "cuda")
