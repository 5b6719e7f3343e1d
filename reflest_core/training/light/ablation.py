# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What ``lightnet`` can be trained and measured without, to see what each part contributes."""

from __future__ import annotations

import math

import torch

from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.light.completion import RADIANCE, SEEN
from reflest_core.models.lightnet.scene_statistics import CHANNEL_STATISTICS
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.scan_file import AXES

Features = dict[str, torch.Tensor]
"""The arguments of ``LightNet.forward``, batched."""

PARTS = {
    "light": "where light comes from: F, B and the observations alone are left",
    "fit": "fits of roughness and albedo to voxels and to the scene",
    "completion": "what the surface shows of light that was not seen, or seen clipped",
    "visibility": "what the object hides from itself, and sends there (needs scans of its own)",
    "shares": "how much of the light was seen, and how much of that was clipped",
    "uncertainty": "the likelihood: the loss is the plain squared error",
}
"""The names of the parts, and what each is."""

_K = len(ROUGHNESSES)
COMPLETED = {
    "channel_statistics": (slice(0, 12), slice(CHANNEL_STATISTICS - _K - 1, CHANNEL_STATISTICS)),
    "statistics": (slice(0, 2 * _K + 4),),
    "found_albedo": (slice(None),),
}
"""What comes with the completed light: results of the three fits of the light, and the material
fitted in it, among the scene's statistics and by itself. The rest needs scans of its own."""
SHARES = ("lobe_seen", "lobe_clipped", "diffuse_seen", "diffuse_clipped")


def check_parts(without: tuple[str, ...]) -> None:
    """Check names of parts.

    Args:
        without: Names of parts.

    Raises:
        TrainingError: There is no part of a name; the sentence lists those that there are.
    """
    for part in without:
        if part not in PARTS:
            raise TrainingError(
                f"lightnet has no part {part!r} to do without; choose of {', '.join(PARTS)}"
            )


def hide(features: Features, without: tuple[str, ...]) -> None:
    """Remove parts of the features, in place.

    Args:
        features: Batched.
        without: Names of :data:`PARTS`.
    """
    if "light" in without:
        _hide_directions(features)
    if "completion" in without:
        for name, columns in COMPLETED.items():
            features[name] = features[name].clone()
            for some in columns:
                features[name][..., some] = 0.0
    if "fit" in without or "light" in without:
        for name in (name for name, axes in AXES.items() if "F" in axes):
            features[name] = torch.zeros_like(features[name])
    if "shares" in without or "light" in without:
        for name in SHARES:
            features[name] = torch.zeros_like(features[name])
        features["zones"] = torch.cat(
            [features["zones"][..., RADIANCE], torch.zeros_like(features["zones"][..., SEEN:])],
            dim=-1,
        )


def _hide_directions(features: Features) -> None:
    """Colours beside the mean background, where they were beside each voxel's own light."""
    zones = features["zones"]
    polar = (torch.arange(zones.shape[1], device=zones.device) + 0.5) * math.pi / zones.shape[1]
    weight = zones[..., 3:4] * polar.sin()[:, None]
    seen = (zones[..., RADIANCE] * weight).sum(1) / weight.sum(1).clamp(min=1e-6)
    background = seen.clamp(min=1e-4)[:, None]  # (B, 1, 3)
    features["apparent"] = (
        features["apparent"] * (features["diffuse_light"] / background)[:, :, None]
    )
    features["diffuse_light"] = background.expand_as(features["diffuse_light"])
    features["lobe"] = torch.zeros_like(features["lobe"])
    features["zones"] = torch.cat(
        [background.expand_as(zones[..., RADIANCE]), zones[..., SEEN:]], dim=-1
    )
