# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Why a calibration cannot be that of a camera: its focal lengths, its centre, or their order."""

from __future__ import annotations

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics

STEEPEST = 10.0
"""Tangent of the largest angle between a pixel's ray and the optical axis: 84 degrees."""
LONGEST = 200.0
"""Largest focal length in edges of the image: a field of view of 0.3 degrees."""
NEAR_MIDDLE, SQUARE, NOT_SQUARE = 0.15, 0.1, 0.15
"""Most distance of a usual centre from the middle, in edges; most and least fx / fy - 1."""
SAME_SHARE = 0.1
"""By which the two coordinates of a larger image's middle may differ, in edges of this one."""
ORDERS = {"cx, cy, fx, fy": (2, 3, 0, 1), "fx, cx, fy, cy": (0, 2, 1, 3)}
"""Wrong orders that people use, and where fx, fy, cx and cy stand in them."""


def camera_problem(camera: CameraIntrinsics, is_crop: bool = False) -> str:
    """Explain why a calibration is impossible for images of its size.

    The centre of a cropped image may lie outside it, as far as the camera's field of view allows.
    In a corner of half the edges or less it lies where the centre of a larger image does, so a crop
    must be known to be one.

    Args:
        camera: The calibration.
        is_crop: Whether the calibration was made for, or cut down to, an image of this size.

    Returns:
        What is wrong and what to change, without the calibration's name; "" where it is possible.
    """
    given = camera.fx, camera.fy, camera.cx, camera.cy
    size = camera.width, camera.height
    shown = "fx = {:g}, fy = {:g}, cx = {:g}, cy = {:g}".format(*given)
    shown = f"{shown} for {size[0]} x {size[1]} pixels"
    if not np.isfinite(given).all() or not min(given[:2]) > 0.0:
        return f"{shown}: expected finite numbers and positive focal lengths in pixels"
    order = _likely_order(given, size)
    if order:
        return f"{shown}: the numbers look like {order}; the order is fx, fy, cx, cy"
    longest = LONGEST * max(size)
    for edge, focal, centre in zip(size, given[:2], given[2:], strict=True):
        furthest = max(abs(centre), abs(edge - 1 - centre))
        if focal > longest or furthest > STEEPEST * focal:
            return (
                f"{shown}: no camera has such a field of view; the order is fx, fy, cx, cy, all in "
                "pixels of images of this size"
            )
    across, down = (2.0 * centre / edge for centre, edge in zip(given[2:], size, strict=True))
    if not is_crop and min(across, down) >= 2.0 - SAME_SHARE and abs(across - down) <= SAME_SHARE:
        return (
            f"{shown}: the centre is that of an image {across:.2g} times as large; scale all four "
            "numbers to this size (for a crop of that image: give a region of interest in "
            "camera_info, or pass CameraIntrinsics to the Scanner)"
        )
    return ""


def _likely_order(given: tuple[float, float, float, float], size: tuple[int, int]) -> str:
    """Return the order in which unusual numbers are a usual camera's, "" where there is none."""
    fx, fy, cx, cy = given
    if abs(fx / fy - 1.0) <= NOT_SQUARE or _is_centred((cx, cy), size):
        return ""
    for name, places in ORDERS.items():
        *focal, right, down = (given[place] for place in places)
        is_square = min(focal) > 0.0 and abs(focal[0] / focal[1] - 1.0) <= SQUARE
        if is_square and _is_centred((right, down), size):
            return name
    return ""


def _is_centred(centre: tuple[float, float], size: tuple[int, int]) -> bool:
    shares = (abs(at / edge - 0.5) for at, edge in zip(centre, size, strict=True))
    return max(shares) <= NEAR_MIDDLE
