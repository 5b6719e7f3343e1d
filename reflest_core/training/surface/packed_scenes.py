# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""All scenes of a split as a few flat tensors, so that minibatches are drawn on the device."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import torch

from reflest_core.training.data.sample import Sample

Tensor = torch.Tensor


@dataclass(frozen=True)
class PackedScenes:
    """S scenes end to end: V voxels, O observations and W views in all.

    ``first_voxel``, ``first_view``: (S + 1,) int64, where each scene's begin. ``offsets``:
    (V + 1,) int64 into the observations. ``positions``, ``normals``: (V, 3) float32.
    ``colours``: (O, 3) uint8 sRGB. ``view_of``: (O,) int16, of the scene's own views.
    ``view_centres``: (W, 3) float32. ``foreground``, ``background``: (W, 3) float32 in [0, 255],
    NaN where unknown. ``ward``: (S, 5) float32, the truth.
    """

    first_voxel: Tensor
    first_view: Tensor
    offsets: Tensor
    positions: Tensor
    normals: Tensor
    colours: Tensor
    view_of: Tensor
    view_centres: Tensor
    foreground: Tensor
    background: Tensor
    ward: Tensor

    @staticmethod
    def of(samples: list[Sample]) -> PackedScenes:
        """Pack ``samples`` in order."""
        surfaces = [sample.surface for sample in samples]
        counts = np.concatenate([surface.observation_counts for surface in surfaces])

        def joined(name: str) -> Tensor:
            return torch.from_numpy(np.concatenate([getattr(s, name) for s in surfaces]))

        return PackedScenes(
            first_voxel=_starts([surface.voxel_count for surface in surfaces]),
            first_view=_starts([len(surface.view_centres) for surface in surfaces]),
            offsets=_starts(counts),
            positions=joined("positions"),
            normals=joined("normals"),
            colours=joined("colours"),
            view_of=joined("view_indices").to(torch.int16),
            view_centres=joined("view_centres"),
            foreground=joined("view_foreground"),
            background=joined("view_background"),
            ward=torch.from_numpy(np.stack([sample.ward for sample in samples])).float(),
        )

    def to(self, device: torch.device) -> PackedScenes:
        """The same scenes on ``device``."""
        return PackedScenes(**{f.name: getattr(self, f.name).to(device) for f in fields(self)})

    @property
    def count(self) -> int:
        """S."""
        return len(self.ward)

    @property
    def most_voxels(self) -> int:
        """Of any one scene."""
        return int(torch.diff(self.first_voxel).max())

    @property
    def most_views(self) -> int:
        """Of any one scene."""
        return int(torch.diff(self.first_view).max())

    @property
    def most_observations(self) -> int:
        """Of any one voxel."""
        return int(torch.diff(self.offsets).max())


def _starts(counts: object) -> Tensor:
    return torch.from_numpy(np.concatenate([[0], np.cumsum(np.asarray(counts, np.int64))]))
