# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes of a training as flat tensors, and minibatches of them, for batched features."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.models.definition import NetworkDefinition
from reflest_core.surface.observed_surface import ObservedSurface

Tensor = torch.Tensor


@dataclass(frozen=True)
class PackedScenes:
    """S scenes end to end: V voxels, O observations and W views in all.

    Attributes:
        first_voxel: (S + 1,) int64, where each scene's voxels begin.
        first_view: (S + 1,) int64, where each scene's views begin.
        offsets: (V + 1,) int64, where each voxel's observations begin.
        positions: (V, 3) float32, metres.
        normals: (V, 3) float32, unit.
        colours: (O, 3) uint8 sRGB.
        view_of: (O,) int16, index among the scene's own views.
        view_centres: (W, 3) float32, metres.
        foreground: (W, 3) float32 in [0, 255], NaN where unknown.
        background: (W, 3) float32 in [0, 255], NaN where unknown.
        ward: (S, 5) float32, the truth.
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
    def of(surfaces: list[ObservedSurface], ward: NDArray[np.float64]) -> PackedScenes:
        """Pack surfaces, and their true parameters (S, 5), in order.

        Args:
            surfaces: The scenes' surfaces.
            ward: (S, 5), the true parameters.
        """
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
            ward=torch.from_numpy(ward).float(),
        )

    def to(self, device: torch.device) -> PackedScenes:
        """Copy the scenes to ``device``.

        Args:
            device: A PyTorch device.
        """
        return PackedScenes(**{f.name: getattr(self, f.name).to(device) for f in fields(self)})

    @property
    def count(self) -> int:
        """Number of scenes, S."""
        return len(self.ward)

    @property
    def most_voxels(self) -> int:
        """Most voxels of any one scene."""
        return int(torch.diff(self.first_voxel).max())

    @property
    def most_views(self) -> int:
        """Most views of any one scene."""
        return int(torch.diff(self.first_view).max())

    @property
    def most_observations(self) -> int:
        """Most observations of any one voxel."""
        return int(torch.diff(self.offsets).max())


@dataclass(frozen=True)
class DrawnScenes:
    """B scenes at N voxels, each with places for M observations.

    Attributes:
        scenes: (B,) indices of packed scenes.
        voxels: (B, N) indices of packed voxels; some stand twice where a scene has too few.
        rows: (B, N, M) indices of packed observations.
        views: (B, N, M) indices of packed views.
        seen: (B, N, M) bool, the places that hold an observation from a kept view.
        rotation: (B, 3, 3), a turn of the world about the vertical.
        channels: (B, 3), the order of the colour channels.
    """

    scenes: Tensor
    voxels: Tensor
    rows: Tensor
    views: Tensor
    seen: Tensor
    rotation: Tensor
    channels: Tensor

    def swap(self, colours: Tensor) -> Tensor:
        """Put the channels of ``colours`` (B, ..., 3) in each scene's drawn order.

        Args:
            colours: (B, ..., 3).
        """
        order = self.channels.view(len(self.channels), *[1] * (colours.ndim - 2), 3)
        return colours.gather(-1, order.expand(colours.shape))

    def turn(self, vectors: Tensor) -> Tensor:
        """Turn ``vectors`` (B, ..., 3) with each scene's world.

        Args:
            vectors: (B, ..., 3).
        """
        turned: Tensor = torch.einsum("bij,b...j->b...i", self.rotation, vectors)
        return turned

    def surface(self, packed: PackedScenes, number: int) -> ObservedSurface:
        """Make the surface of one scene, of its drawn voxels in their order, turned and swapped.

        Args:
            packed: The scenes that were drawn from.
            number: Index in the minibatch.
        """
        seen, voxels = self.seen[number], self.voxels[number]
        rotation, order = self.rotation[number].T, self.channels[number]
        views, view_of = torch.unique(self.views[number][seen], return_inverse=True)
        counts = seen.sum(dim=1)
        arrays = {
            "positions": packed.positions[voxels] @ rotation,
            "normals": packed.normals[voxels] @ rotation,
            "offsets": torch.cat([counts.new_zeros(1), counts.cumsum(0)]),
            "colours": packed.colours[self.rows[number][seen]][:, order],
            "view_indices": view_of,
            "view_centres": packed.view_centres[views] @ rotation,
            "view_foreground": packed.foreground[views][:, order],
            "view_background": packed.background[views][:, order],
        }
        made = {name: tensor.cpu().numpy() for name, tensor in arrays.items()}
        made["view_indices"] = made["view_indices"].astype(np.uint16)
        return ObservedSurface(**made)


def stacked_features(
    network: NetworkDefinition, packed: PackedScenes, drawn: DrawnScenes
) -> tuple[Tensor, ...]:
    """Compute a network's features of one drawn scene after another, and stack them.

    Args:
        network: Its :meth:`~reflest_core.models.definition.NetworkDefinition.features` are used.
        packed: All training scenes.
        drawn: Those of the minibatch.

    Returns:
        The features with a leading B, on the scenes' device.
    """
    voxels = np.arange(drawn.voxels.shape[1])
    columns = zip(
        *(
            network.features(drawn.surface(packed, number), voxels)
            for number in range(len(drawn.scenes))
        ),
        strict=True,
    )
    device = packed.ward.device
    return tuple(torch.from_numpy(np.stack(column)).to(device) for column in columns)


def _starts(counts: object) -> Tensor:
    return torch.from_numpy(np.concatenate([[0], np.cumsum(np.asarray(counts, np.int64))]))
