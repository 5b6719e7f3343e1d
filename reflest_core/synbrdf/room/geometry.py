# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a room consists of: painted panels, lamps, windows. Metres, z up."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ATLAS_TILES = 64
"""Most painted panels of a room."""
MOST_LAMPS, MOST_GLOBES, MOST_WINDOWS = 5, 2, 3
LIGHT_TEXELS = 24
"""Along each edge of a panel that shines."""


@dataclass(frozen=True)
class Panel:
    """A rectangle that is seen from the side that ``across x up`` points to.

    Attributes:
        corner: (3,) metres.
        across: (3,) edge from the corner, metres.
        up: (3,) the other edge, at right angles.
    """

    corner: FloatArray
    across: FloatArray
    up: FloatArray

    @property
    def area(self) -> float:
        """Square metres."""
        return float(np.linalg.norm(np.cross(self.across, self.up)))

    @property
    def normal(self) -> FloatArray:
        """(3,), unit length."""
        return np.asarray(np.cross(self.across, self.up) / self.area)

    @property
    def middle(self) -> FloatArray:
        """(3,)."""
        return np.asarray(self.corner + 0.5 * (self.across + self.up))

    def grid(self, rows: int, columns: int) -> FloatArray:
        """Centres (rows, columns, 3) of its texels; row 0 lies along ``across``.

        Args:
            rows: of the picture or grid.
            columns: of the picture or grid.
        """
        u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
        return np.asarray(self.corner + u[..., None] * self.across + v[..., None] * self.up)

    def turned(self, rotation: FloatArray) -> Panel:
        """Rotated (3, 3) about the origin.

        Args:
            rotation: (3, 3).
        """
        return Panel(rotation @ self.corner, rotation @ self.across, rotation @ self.up)


@dataclass(frozen=True)
class Surface:
    """A matte panel.

    Attributes:
        panel: Its rectangle.
        albedo: (T, T, 3) float32, row 0 along ``across``.
        texel: Metres, how finely the light on it is computed.
    """

    panel: Panel
    albedo: NDArray[np.float32]
    texel: float


@dataclass(frozen=True)
class PanelLight:
    """A panel that shines, each point of it alike to all sides of its front.

    Attributes:
        panel: Its rectangle.
        radiance: (LIGHT_TEXELS, LIGHT_TEXELS, 3) float32, row 0 along ``across``.
    """

    panel: Panel
    radiance: NDArray[np.float32]


@dataclass(frozen=True)
class Globe:
    """A ball that shines.

    Attributes:
        centre: (3,) metres.
        radius: Metres.
        radiance: (3,) linear sRGB.
    """

    centre: FloatArray
    radius: float
    radiance: FloatArray


@dataclass(frozen=True)
class Room:
    """Everything about the object, which stands at the origin.

    ``windows`` show what is outside; depth cameras measure nothing there, nor beyond
    ``depth_reach`` metres along the optical axis.
    """

    surfaces: list[Surface]
    lamps: list[PanelLight]
    globes: list[Globe]
    windows: list[PanelLight]
    depth_reach: float


def even(radiance: FloatArray) -> NDArray[np.float32]:
    """The same radiance (3,) on all of a panel.

    Args:
        radiance: (3,) linear.
    """
    return np.tile(radiance.astype(np.float32), (LIGHT_TEXELS, LIGHT_TEXELS, 1))


@dataclass(frozen=True)
class Box:
    """A box along the axes of the room.

    Attributes:
        low: (3,) metres.
        high: (3,) metres.
    """

    low: FloatArray
    high: FloatArray

    @property
    def outside(self) -> list[Panel]:
        """Its six faces, seen from without: -x, +x, -y, +y, below, above."""
        x, y, z = np.diag(self.high - self.low)
        low, high = self.low, self.high
        return [
            Panel(low + y, -y, z),
            Panel(low + x, y, z),
            Panel(low, x, z),
            Panel(low + x + y, -x, z),
            Panel(low + y, x, -y),
            Panel(high - x - y, x, y),
        ]

    @property
    def inside(self) -> list[Panel]:
        """The same faces seen from within."""
        return [
            dataclasses.replace(face, corner=face.corner + face.across, across=-face.across)
            for face in self.outside
        ]

    def holds(self, points: FloatArray, margin: float) -> bool:
        """Whether any point lies in the box or near it.

        Args:
            points: (P, 3) metres.
            margin: metres around the box that count as within.
        """
        above, below = points > self.low - margin, points < self.high + margin
        return bool((above & below).all(axis=1).any())
