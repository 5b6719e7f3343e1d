# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Hemisphere images of a minibatch; ``models/hemicnn/hemisphere_images.py`` has those of one."""

from __future__ import annotations

import numpy as np
import torch

from reflest_core.models.hemicnn.hemisphere_images import SIZE, hemisphere_images
from reflest_core.models.minibatch import DrawnScenes, PackedScenes
from reflest_core.surface.observed_surface import ObservedSurface

Tensor = torch.Tensor


def batched_hemispheres(packed: PackedScenes, drawn: DrawnScenes, azimuths: Tensor) -> Tensor:
    """Make the images (B, N, 3, 10, 10) of a minibatch, colours in [0, 1].

    Args:
        packed: All training scenes.
        drawn: The scenes of the minibatch.
        azimuths: (B,) radians, each scene's turn about the normals.
    """
    images = _by_kernel if azimuths.device.type == "cpu" else _by_tensors
    return drawn.swap(images(packed, drawn, azimuths).movedim(2, -1)).movedim(-1, 2)


def _by_kernel(packed: PackedScenes, drawn: DrawnScenes, azimuths: Tensor) -> Tensor:
    """On a CPU the live path's own kernel is the fastest: one surface of all that is drawn."""
    scenes, voxels = drawn.voxels.shape
    seen = drawn.seen
    views, view_of = torch.unique(drawn.views[seen], return_inverse=True)
    counts = seen.sum(dim=2).flatten()
    nothing = np.empty((0, 3), np.float32)
    surface = ObservedSurface(
        positions=packed.positions[drawn.voxels].flatten(0, 1).numpy(),
        normals=packed.normals[drawn.voxels].flatten(0, 1).numpy(),
        offsets=np.concatenate([[0], counts.cumsum(0).numpy()]),
        colours=packed.colours[drawn.rows[seen]].numpy(),
        view_indices=view_of.numpy().astype(np.uint16),
        view_centres=packed.view_centres[views].numpy(),
        view_foreground=nothing,
        view_background=nothing,
    )
    turns = azimuths.double().repeat_interleave(voxels).numpy()
    images = hemisphere_images(surface, np.arange(scenes * voxels), turns)
    return torch.from_numpy(images).view(scenes, voxels, 3, SIZE, SIZE)


def _by_tensors(packed: PackedScenes, drawn: DrawnScenes, azimuths: Tensor) -> Tensor:
    normals = packed.normals[drawn.voxels]
    towards = packed.view_centres[drawn.views] - packed.positions[drawn.voxels][:, :, None]
    directions = torch.nn.functional.normalize(towards, dim=-1)
    tangents, bitangents = tangent_frames(normals)
    x = (directions * tangents[:, :, None]).sum(dim=-1)
    y = (directions * bitangents[:, :, None]).sum(dim=-1)
    cosine, sine = azimuths.cos()[:, None, None], azimuths.sin()[:, None, None]
    disc = torch.stack([cosine * x - sine * y, sine * x + cosine * y], dim=-1)
    usable = drawn.seen & ((directions * normals[:, :, None]).sum(dim=-1) > 0)
    nearest = _nearest(disc, usable)
    colours = packed.colours[drawn.rows.gather(2, nearest)].float() / 255
    colours = colours * usable.any(dim=2)[:, :, None, None]
    return colours.transpose(2, 3).reshape(*drawn.voxels.shape, 3, SIZE, SIZE)


def tangent_frames(normals: Tensor) -> tuple[Tensor, Tensor]:
    """Compute tangents and bitangents (..., 3) as ``surface/tangent_frame.py`` does.

    Args:
        normals: (..., 3), unit.
    """
    up = torch.zeros_like(normals)
    up[..., 2] = 1
    along_x = torch.zeros_like(normals)
    along_x[..., 0] = 1
    projected = up - normals[..., 2:] * normals
    nearly_vertical = (projected**2).sum(dim=-1, keepdim=True) < 1e-6
    instead = along_x - normals[..., :1] * normals
    tangent = torch.nn.functional.normalize(
        torch.where(nearly_vertical, instead, projected), dim=-1
    )
    return tangent, torch.linalg.cross(normals, tangent)


def _nearest(disc: Tensor, usable: Tensor) -> Tensor:
    """Place (B, N, 100) of the observation nearest to each pixel; ``disc`` (B, N, M, 2)."""
    centres = (torch.arange(SIZE, device=disc.device) + 0.5) * 2 / SIZE - 1
    row, column = torch.meshgrid(centres, centres, indexing="ij")
    pixels = torch.stack([column, row], dim=-1).view(-1, 2)
    # |q - p|^2 less |p|^2, which is the same for every observation.
    score = (disc**2).sum(dim=-1)[:, :, None] - 2 * pixels @ disc.transpose(2, 3)
    return score.masked_fill(~usable[:, :, None], torch.inf).argmin(dim=3)
