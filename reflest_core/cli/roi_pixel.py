# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``--roi-pixel``: the sphere around what a pixel of a capture shows."""

from __future__ import annotations

import argparse
import math

import numpy as np

from reflest_core.capture.capture import Capture
from reflest_core.capture.frame import Frame
from reflest_core.capture.settings import CaptureSettings
from reflest_core.cli.source import open_source
from reflest_core.fusion.settings import RegionSettings
from reflest_core.parameter import ParameterError


def sphere_at_pixel(options: argparse.Namespace, settings: CaptureSettings) -> RegionSettings:
    """Read a capture up to a frame, and place the region on the surface under a pixel.

    Args:
        options: All options of the command. ``roi_pixel`` holds the number of the frame, from 0
            among those with depth and pose, then column, row and radius in metres.
        settings: How the capture is read.

    Raises:
        ParameterError: The frame or the pixel does not exist, has no depth, or the radius is not
            above 0; the sentence says which.
        CaptureError: The capture cannot be read.
    """
    number, column, row, radius = options.roi_pixel
    if not number.is_integer() or number < 0:
        raise ParameterError(f"--roi-pixel: frame {number:g} is no whole number from 0")
    if not (math.isfinite(column) and math.isfinite(row)):
        raise ParameterError(f"--roi-pixel: pixel {column:g} {row:g} is not finite")
    if not 0.0 < radius < math.inf:
        raise ParameterError(f"--roi-pixel: the radius is {radius:g} m: it must be above 0")
    frame = _frame(open_source(options, settings), int(number))
    camera = frame.intrinsics
    u, v = round(column), round(row)
    if not (0 <= u < camera.width and 0 <= v < camera.height):
        raise ParameterError(
            f"--roi-pixel: pixel {column:g} {row:g} is not in the image of {camera.width} x "
            f"{camera.height} pixels"
        )
    depth = float(frame.depth[v, u])
    if not depth > 0.0:
        raise ParameterError(
            f"--roi-pixel: frame {number:g} has no depth at pixel {column:g} {row:g}: choose "
            "another pixel or frame"
        )
    ray = np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0, 1.0 / depth])
    x, y, z = (frame.T_world_camera @ (depth * ray))[:3].tolist()
    return RegionSettings.sphere((x, y, z), radius)


def _frame(capture: Capture, number: int) -> Frame:
    count = 0
    for count, frame in enumerate(capture, 1):
        if count > number:
            return frame
    raise ParameterError(
        f"--roi-pixel: there is no frame {number} in {capture.name}: it has {count} with depth and "
        "pose, counted from 0"
    )
