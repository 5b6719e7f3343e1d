# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The part of an image that can show the scanned object: all else costs nothing."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.region import Region, RegionShape

MARGIN = 40
"""Pixels around it that are read too: more than any pixel's neighbourhood that counts."""

NEAREST = 0.05
"""Metres: where a corner of the region is closer to the camera's plane, the whole image counts."""


@dataclass(frozen=True)
class Window:
    """A rectangle of pixels, the ends not included.

    Attributes:
        top: First row.
        bottom: Row after the last.
        left: First column.
        right: Column after the last.
    """

    top: int
    bottom: int
    left: int
    right: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """What selects the window from an (H, W) array."""
        return slice(self.top, self.bottom), slice(self.left, self.right)


def object_window(frame: Frame, region: Region) -> Window:
    """Return the window around the mask, or around the region's projection.

    Args:
        frame: The frame.
        region: The region of interest or the work sphere.

    Returns:
        The window; the whole image where there is neither.
    """
    whole = Window(0, frame.intrinsics.height, 0, frame.intrinsics.width)
    if frame.mask is not None:
        rows = np.flatnonzero(frame.mask.any(axis=1))
        columns = np.flatnonzero(frame.mask.any(axis=0))
        if len(rows) == 0:
            return whole
        return _around(rows[0], rows[-1], columns[0], columns[-1], whole)
    if region.shape is RegionShape.NONE:
        return whole
    corners = _corners(region) - frame.camera_centre
    x, y, z = frame.T_world_camera[:3, :3].T @ corners.T
    if z.min() < NEAREST:
        return whole
    u = frame.intrinsics.fx * x / z + frame.intrinsics.cx
    v = frame.intrinsics.fy * y / z + frame.intrinsics.cy
    return _around(v.min(), v.max(), u.min(), u.max(), whole)


def cropped(frame: Frame, window: Window) -> Frame:
    """Cut a frame to a window, as a camera with the window for its sensor would have taken it.

    Args:
        frame: The frame.
        window: The window.

    Returns:
        The cut frame.
    """
    camera = frame.intrinsics
    if (window.bottom - window.top, window.right - window.left) == (camera.height, camera.width):
        return frame
    return dataclasses.replace(
        frame,
        rgb=frame.rgb[window.slices],
        depth=frame.depth[window.slices],
        mask=None if frame.mask is None else frame.mask[window.slices],
        intrinsics=dataclasses.replace(
            camera,
            width=window.right - window.left,
            height=window.bottom - window.top,
            cx=camera.cx - window.left,
            cy=camera.cy - window.top,
        ),
    )


def _corners(region: Region) -> NDArray[np.float64]:
    """(8, 3) corners of the box around the region, world frame."""
    half = region.half_size
    if region.shape is RegionShape.SPHERE:
        half = np.full(3, half[0])
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    return np.asarray(region.centre + signs * half, np.float64)


def _around(top: float, bottom: float, left: float, right: float, whole: Window) -> Window:
    """The window with its margin, cut off at the image; the whole image if nothing is left."""
    window = Window(
        max(int(np.floor(max(top, -1e9))) - MARGIN, 0),
        min(int(np.ceil(min(bottom, 1e9))) + MARGIN + 1, whole.bottom),
        max(int(np.floor(max(left, -1e9))) - MARGIN, 0),
        min(int(np.ceil(min(right, 1e9))) + MARGIN + 1, whole.right),
    )
    if window.top >= window.bottom or window.left >= window.right:
        return whole
    return window
