# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reads a point cloud as a viewer does: by the offsets and types that the message gives."""

from __future__ import annotations

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField


def column(message: PointCloud2, name: str) -> np.ndarray:
    """(N,) values of a field."""
    (field,) = (one for one in message.fields if one.name == name)
    assert field.datatype == PointField.FLOAT32
    rows = np.frombuffer(message.data, np.uint8).reshape(message.width, message.point_step)
    return np.ascontiguousarray(rows[:, field.offset : field.offset + 4]).view("<f4")[:, 0]


def colours(message: PointCloud2) -> np.ndarray:
    """(N, 3) red, green, blue."""
    bits = column(message, "rgb").view(np.uint32)
    return np.stack([bits >> 16 & 255, bits >> 8 & 255, bits & 255], axis=-1)
