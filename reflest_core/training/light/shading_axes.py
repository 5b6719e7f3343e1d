# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The arrays of a :class:`Shading`, by their axes: how they are padded, thinned and varied."""

from __future__ import annotations

AXES = {
    "is_seen": "VO",
    "apparent": "VOC",
    "clipped": "VOC",
    "cosine": "VO",
    "lobe": "VOKC",
    "lobe_seen": "VOK",
    "lobe_clipped": "VOK",
    "normals": "VD",
    "diffuse_light": "VC",
    "diffuse_seen": "V",
    "diffuse_clipped": "V",
    "voxel_fit": "VCKF",
    "scene_fit": "CKF",
    "zones": "ZR",
    "channel_statistics": "CF",
    "statistics": "F",
    "found_albedo": "CF",
    "found_gloss": "F",
}
"""V voxels, O observations of one voxel, C colour channels, K roughnesses, D a direction in the
world, F what a fit says, Z rings of elevation, R three colour channels and then shares."""
