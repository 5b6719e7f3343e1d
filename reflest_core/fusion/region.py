"""The region of interest: a box or a sphere in the world frame that holds the scanned object."""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.settings import RegionSettings
from reflest_core.jit import compiled, kernel_array


class RegionShape(enum.IntEnum):
    """What bounds the scanned object."""

    NONE = 0
    BOX = 1
    SPHERE = 2


@dataclass(frozen=True)
class Region:
    """``centre``, ``half_size``: (3,) float64 metres, world axes; a sphere's radius is first."""

    shape: RegionShape
    centre: NDArray[np.float64]
    half_size: NDArray[np.float64]

    @classmethod
    def from_settings(cls, settings: RegionSettings) -> Region:
        """The region that the user described."""
        return cls(
            RegionShape[settings.shape.upper()],
            np.array(settings.centre, np.float64),
            np.array(settings.size, np.float64) / 2.0,
        )

    def contains(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """(N,) bool for (N, 3) points in the world frame; the boundary counts as inside."""
        flat = kernel_array(points, np.float64)
        return _inside_all(int(self.shape), self.centre, self.half_size, flat)


@compiled
def inside_region(
    shape: int,
    centre: NDArray[np.float64],
    half_size: NDArray[np.float64],
    x: float,
    y: float,
    z: float,
) -> bool:
    """Whether the point lies in the region; everything does where there is none."""
    dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
    if shape == 1:
        return bool(abs(dx) <= half_size[0] and abs(dy) <= half_size[1] and abs(dz) <= half_size[2])
    if shape == 2:
        return bool(dx * dx + dy * dy + dz * dz <= half_size[0] * half_size[0])
    return True


@compiled
def _inside_all(
    shape: int,
    centre: NDArray[np.float64],
    half_size: NDArray[np.float64],
    points: NDArray[np.float64],
) -> NDArray[np.bool_]:
    inside = np.empty(len(points), np.bool_)
    for n in range(len(points)):
        inside[n] = inside_region(
            shape, centre, half_size, points[n, 0], points[n, 1], points[n, 2]
        )
    return inside
