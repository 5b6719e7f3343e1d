# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``CameraInfo`` to intrinsics: checked, with binning and ROI applied and distortion named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.camera_problem import camera_problem
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings

APPLIED_MODELS = ("plumb_bob", "rational_polynomial")
COEFFICIENT_COUNTS = (4, 5, 8, 12, 14)
# With these, coefficients of zero are still a fisheye; none at all are a pinhole.
FISHEYE_MODELS = ("equidistant", "fisheye", "kannala_brandt", "kannala_brandt4")
FISHEYE_COUNT = 4

LARGEST_COEFFICIENT = 1e6
"""Limit of a distortion coefficient; those of rational models reach thousands."""


@dataclass(frozen=True)
class CalibratedCamera:
    """Intrinsics of the published image, and the distortion still in it.

    Attributes:
        intrinsics: Pinhole camera, which stays as it is when distortion is taken out.
        distortion: Coefficients in OpenCV's order; empty where there is none.
        is_fisheye: The coefficients are k1 to k4 of the equidistant model (``cv2.fisheye``).
    """

    intrinsics: CameraIntrinsics
    distortion: tuple[float, ...] = ()
    is_fisheye: bool = False


def check_camera_info(
    info: CameraInfoMessage, topic: str, settings: CaptureSettings
) -> CalibratedCamera:
    """Return the camera that ``info`` describes.

    ROI, then binning are applied as image_geometry does: ``cx`` loses the offset and is divided
    by the binning.

    Args:
        info: as the driver published it.
        topic: how sentences name the stream.
        settings: parameters of the group ``capture``.

    Raises:
        FrameRefused: CAMERA_INFO_INVALID, naming the field.
    """
    left, top, roi_width, roi_height = info.roi
    bin_x, bin_y = max(info.binning[0], 1), max(info.binning[1], 1)
    width = (roi_width or info.width) // bin_x
    height = (roi_height or info.height) // bin_y
    if width < 1 or height < 1:
        raise _invalid(topic, f"describes an image of {width} x {height} pixels")
    matrix = _matrix(info, topic, settings.rectified)
    fx, skew, cx, fy, cy = matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[1, 1], matrix[1, 2]
    intrinsics = CameraIntrinsics(
        width=width,
        height=height,
        fx=float(fx) / bin_x,
        fy=float(fy) / bin_y,
        cx=(float(cx) - left) / bin_x,
        cy=(float(cy) - top) / bin_y,
    )
    name = "P" if settings.rectified else "K"
    if skew != 0.0:
        raise _invalid(topic, f"has {name} with skew = {skew:g}, which must be 0")
    is_crop = 0 < roi_width * roi_height < info.width * info.height
    if problem := camera_problem(intrinsics, is_crop):
        raise _invalid(topic, f"has {name} with {problem}", ask_to_calibrate=False)
    distortion = () if settings.rectified else _checked_distortion(info, topic)
    is_fisheye = bool(distortion) and info.distortion_model in FISHEYE_MODELS
    return CalibratedCamera(intrinsics, distortion, is_fisheye)


def _matrix(info: CameraInfoMessage, topic: str, rectified: bool) -> NDArray[np.float64]:
    values, count = (info.p, 12) if rectified else (info.k, 9)
    if len(values) != count:
        raise _invalid(topic, f"has {len(values)} values where {count} make a matrix")
    return np.array(values, dtype=np.float64).reshape(3, -1)


def _checked_distortion(info: CameraInfoMessage, topic: str) -> tuple[float, ...]:
    if not info.d:  # no distortion under any model, as image_geometry takes it
        return ()
    if info.distortion_model in FISHEYE_MODELS:
        if len(info.d) < FISHEYE_COUNT or any(info.d[FISHEYE_COUNT:]):
            raise _not_applied(info, topic)
        _check_coefficients(info, topic)
        return tuple(info.d[:FISHEYE_COUNT])
    if not any(info.d):  # NaN counts as present and is refused below
        return ()
    if info.distortion_model not in APPLIED_MODELS or len(info.d) not in COEFFICIENT_COUNTS:
        raise _not_applied(info, topic)
    _check_coefficients(info, topic)
    return tuple(info.d)


def _check_coefficients(info: CameraInfoMessage, topic: str) -> None:
    if not np.isfinite(info.d).all():
        raise _invalid(topic, "has distortion coefficients that are NaN or infinite")
    if np.abs(info.d).max() > LARGEST_COEFFICIENT:
        raise _invalid(topic, f"has distortion coefficients beyond {LARGEST_COEFFICIENT:g}")


def _not_applied(info: CameraInfoMessage, topic: str) -> FrameRefused:
    return _invalid(
        topic,
        f"has distortion model {info.distortion_model!r} with {len(info.d)} coefficients; read are "
        f"{' and '.join(APPLIED_MODELS)} with 4, 5, 8, 12 or 14 and equidistant with 4: publish "
        "rectified images and set capture.rectified",
        ask_to_calibrate=False,
    )


def _invalid(topic: str, what: str, ask_to_calibrate: bool = True) -> FrameRefused:
    advice = ": calibrate the camera or choose another topic" if ask_to_calibrate else ""
    return FrameRefused(RefusalCause.CAMERA_INFO_INVALID, f"{topic} {what}{advice}")
