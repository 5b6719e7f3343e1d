# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of the arrays that a user of the Python API hands over."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.camera_problem import camera_problem
from reflest_core.capture.frame import Frame
from reflest_core.capture.pose import FURTHEST, quaternion_of, rigid_matrix
from reflest_core.errors import ReflestError
from reflest_core.fusion.settings import RegionSettings

MOST_PIXELS = 1 << 26
"""Pixels of an image at most."""
LIKELY_MILLIMETRES = 50.0
"""A median depth beyond it, in metres, is more likely in another unit."""
LAST_SECOND = 2**63 / 1e9
"""A stamp's nanoseconds are 64-bit integers."""
LAST_STAMP_NS = 2**63 - 10**9
"""So that the next frame's stamp is one too."""


class ArgumentRefused(ReflestError):
    """An argument of the Python API cannot be used; the sentence says why and what to pass."""


def checked_number(name: str, value: Any) -> float:
    """Check a number.

    Args:
        name: What sentences call it.
        value: as it was given.

    Raises:
        ArgumentRefused: It is no number.
    """
    try:
        if not isinstance(value, (str, bytes)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise ArgumentRefused(f"{name} is {_shown(value)}: expected a number")


def checked_vector(name: str, value: Any) -> tuple[float, float, float]:
    """Check three numbers.

    Args:
        name: What sentences call them.
        value: as it was given.

    Raises:
        ArgumentRefused: They are not three numbers.
    """
    try:
        x, y, z = (checked_number(name, number) for number in value)
    except (TypeError, ValueError, ArgumentRefused):
        raise ArgumentRefused(f"{name} is {_shown(value)}: expected three numbers") from None
    return x, y, z


def checked_stamp(stamp: Any) -> int:
    """Check a stamp.

    Args:
        stamp: seconds.

    Returns:
        Nanoseconds.

    Raises:
        ArgumentRefused: It is no time that a stamp can hold.
    """
    seconds = checked_number("stamp", stamp)
    if not abs(seconds) < LAST_SECOND:
        raise ArgumentRefused(f"stamp is {stamp}: expected seconds")
    return checked_stamp_ns(round(seconds * 1e9))


def checked_stamp_ns(stamp_ns: Any) -> int:
    """Check a stamp that leaves room for a next one.

    Args:
        stamp_ns: nanoseconds.

    Raises:
        ArgumentRefused: It is no time that a stamp can hold.
    """
    try:
        checked = operator.index(stamp_ns)
    except TypeError:
        raise ArgumentRefused(f"stamp_ns is {_shown(stamp_ns)}: expected nanoseconds") from None
    if not abs(checked) <= LAST_STAMP_NS:
        raise ArgumentRefused(
            f"the stamp is {checked / 1e9:g} s: expected a time within 292 years of 0"
        )
    return checked


def checked_frame(frame: Any) -> Frame:
    """Check a frame that may not come from a capture.

    Args:
        frame: as it was given.

    Raises:
        ArgumentRefused: It is none, or its stamp or its calibration cannot be.
    """
    if not isinstance(frame, Frame):
        raise ArgumentRefused(
            f"frame is {_shown(frame)}: pass a frame of open_capture, or arrays to Scanner.add"
        )
    checked_stamp_ns(frame.stamp_ns)
    _possible(frame.intrinsics, is_crop=True)
    return frame


def checked_region(region: Any) -> RegionSettings:
    """Check a region of interest.

    Args:
        region: as it was given.

    Raises:
        ArgumentRefused: It is none.
    """
    if not isinstance(region, RegionSettings):
        raise ArgumentRefused(
            f"region is {_shown(region)}: pass sphere(centre, radius) or box(centre, size)"
        )
    return region


def checked_colour(rgb: ArrayLike) -> NDArray[np.uint8]:
    """Check a colour image.

    Args:
        rgb: (H, W, 3) uint8, 8-bit sRGB, red first.

    Raises:
        ArgumentRefused: Another shape or type.
    """
    image = _array("rgb", rgb)
    if image.ndim != 3 or image.shape[2] != 3 or 0 in image.shape:
        raise ArgumentRefused(f"rgb has shape {image.shape}: expected (height, width, 3)")
    if image.dtype != np.uint8:
        hint = "multiply values in [0, 1] by 255 and round them" if image.dtype.kind == "f" else ""
        raise ArgumentRefused(
            f"rgb is {image.dtype}: expected uint8, 8-bit sRGB" + (f"; {hint}" if hint else "")
        )
    if image.shape[0] * image.shape[1] > MOST_PIXELS:
        raise ArgumentRefused(f"rgb has {image.shape[0]} x {image.shape[1]} pixels: too many")
    return image


def checked_depth(
    depth: ArrayLike, shape: tuple[int, int], scale: float | None
) -> NDArray[np.float32]:
    """Check a depth image and convert it to metres.

    Args:
        depth: (H, W) Z along the optical axis, float in metres or integer in units of ``scale``;
            0, NaN and infinity where unknown.
        shape: (H, W) of the colour image, to which it is registered.
        scale: metres in one unit of depth, None where the user gave none.

    Returns:
        (H, W) float32 metres, 0 where unknown.

    Raises:
        ArgumentRefused: Another shape, no number, an integer image without ``scale``, or values
            that cannot be metres.
    """
    image = _array("depth", depth)
    if image.shape != shape:
        swapped = " (width and height look swapped)" if image.shape == shape[::-1] else ""
        raise ArgumentRefused(
            f"depth has shape {image.shape} and rgb {shape}{swapped}: register depth to colour "
            "first; arrays are (height, width)"
        )
    if image.dtype.kind not in "uif":
        raise ArgumentRefused(f"depth is {image.dtype}: expected floats in metres or integers")
    if image.dtype.kind in "ui" and scale is None:
        raise ArgumentRefused(
            f"depth is {image.dtype}: pass metres as floats, or give Scanner depth_scale "
            "(0.001 for millimetres)"
        )
    with np.errstate(over="ignore"):  # beyond float32 it is infinite, which is unknown
        metres = image.astype(np.float32)
        if scale is not None:
            metres *= np.float32(scale)
    known = np.isfinite(metres) & (metres > 0.0)
    metres = np.where(known, metres, np.float32(0.0))
    if known.any() and float(np.median(metres[known])) > LIKELY_MILLIMETRES:
        likely = 0.001 * (1.0 if scale is None else scale)
        raise ArgumentRefused(
            f"depth's median is {float(np.median(metres[known])):.4g} m: it looks like "
            f"millimetres; pass metres, or give Scanner depth_scale={likely:g}"
        )
    return metres


def checked_intrinsics(
    matrix: ArrayLike | CameraIntrinsics, shape: tuple[int, int]
) -> CameraIntrinsics:
    """Check a pinhole calibration.

    Args:
        matrix: (3, 3) K, or (4,) fx, fy, cx, cy; pixels, centres at integer coordinates; or a
            frame's intrinsics, which state the size that they belong to and may be of a crop.
        shape: (H, W) of the images that it belongs to.

    Raises:
        ArgumentRefused: It is no such matrix, or no camera of such images has it.
    """
    if isinstance(matrix, CameraIntrinsics):
        if (matrix.height, matrix.width) != shape:
            raise ArgumentRefused(
                f"K belongs to images of {matrix.width} x {matrix.height} pixels, and rgb has "
                f"{shape[1]} x {shape[0]}"
            )
        return _possible(matrix, is_crop=True)
    values = _array("K", matrix, np.float64)
    if values.shape == (4,):
        fx, fy, cx, cy = values.tolist()
    elif values.shape == (3, 3):
        if abs(values[0, 1]) > 1e-6 or not np.allclose(values[2], (0.0, 0.0, 1.0)):
            raise ArgumentRefused(
                "K is not [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]: rectify the images, and pass K as "
                "rows"
            )
        fx, fy, cx, cy = (float(values[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
    else:
        raise ArgumentRefused(f"K has shape {values.shape}: expected (3, 3), or fx, fy, cx, cy")
    return _possible(CameraIntrinsics(shape[1], shape[0], fx, fy, cx, cy))


def _possible(camera: CameraIntrinsics, is_crop: bool = False) -> CameraIntrinsics:
    if problem := camera_problem(camera, is_crop):
        raise ArgumentRefused(f"K has {problem}")
    return camera


def checked_pose(matrix: ArrayLike) -> NDArray[np.float64]:
    """Check a pose and make its rotation exact, as a recorded capture's is.

    Args:
        matrix: (4, 4) ``T_world_camera`` of the camera's optical frame (z forward, x right,
            y down), metres.

    Raises:
        ArgumentRefused: It is no rigid motion.
    """
    pose = _array("T_world_camera", matrix, np.float64)
    if pose.shape != (4, 4):
        raise ArgumentRefused(f"T_world_camera has shape {pose.shape}: expected (4, 4)")
    if not np.isfinite(pose).all():
        raise ArgumentRefused("T_world_camera holds NaN or infinity: skip frames without a pose")
    if not np.allclose(pose[3], (0.0, 0.0, 0.0, 1.0)):
        raise ArgumentRefused(
            f"T_world_camera's last row is {pose[3].tolist()}: expected 0, 0, 0, 1 (is it "
            "transposed?)"
        )
    if np.abs(pose[:3, 3]).max() >= FURTHEST:
        raise ArgumentRefused("T_world_camera lies 10,000 km or more from the origin: pass metres")
    quaternion = np.array(quaternion_of(pose[:3, :3]))
    if not np.isfinite(quaternion).all():
        mirrored = np.linalg.det(pose[:3, :3]) < 0.0
        why = "mirrors" if mirrored else "is not orthonormal to 0.01"
        raise ArgumentRefused(
            f"T_world_camera's rotation {why}: expected the camera's optical frame, z forward, "
            "x right, y down"
        )
    return rigid_matrix(pose[:3, 3], quaternion)


def _array(name: str, value: Any, dtype: DTypeLike | None = None) -> NDArray[Any]:
    try:
        return np.asarray(value, dtype)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentRefused(f"{name} is {_shown(value)}: expected an array of numbers") from None


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."
