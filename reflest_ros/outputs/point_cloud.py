# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Point clouds of records: the fields and the message of ``sensor_msgs/PointCloud2``."""

from __future__ import annotations

import array
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField

from reflest_ros.inputs.core_messages import ns_to_stamp

COLOUR = "rgb"
"""A ``uint32`` field of this name is 0x00RRGGBB in the bits of a FLOAT32, as displays read it."""


def point_cloud(
    points: NDArray[np.void], frame_id: str, stamp_ns: int, is_dense: bool = True
) -> PointCloud2:
    """Make a message of N records.

    Args:
        points: (N,) records whose fields are ``float32``, ``float64`` or ``uint32``.
        frame_id: Of the header.
        stamp_ns: Of the header, nanoseconds.
        is_dense: Whether all values are finite.

    Returns:
        The message; its fields are those of the records.
    """
    message = PointCloud2(
        height=1,
        width=len(points),
        fields=_fields(points.dtype),
        is_bigendian=sys.byteorder == "big",
        point_step=points.dtype.itemsize,
        row_step=points.dtype.itemsize * len(points),
        is_dense=is_dense,
    )
    message.header.stamp = ns_to_stamp(stamp_ns)
    message.header.frame_id = frame_id
    message.data = array.array("B", points.tobytes())
    return message


def _fields(record: np.dtype[np.void]) -> list[PointField]:
    return [
        PointField(name=name, offset=offset, datatype=_datatype(name, kind), count=1)
        for name, (kind, offset, *_) in (record.fields or {}).items()
    ]


def _datatype(name: str, kind: np.dtype[Any]) -> int:
    if kind == np.float64:
        return int(PointField.FLOAT64)
    is_whole_number = kind == np.uint32 and name != COLOUR
    return int(PointField.UINT32 if is_whole_number else PointField.FLOAT32)


def far_points(record: np.dtype[np.void]) -> np.dtype[np.void]:
    """Return a type of records whose ``x``, ``y`` and ``z`` are ``float64``.

    For scans that lie far from the world's origin, where ``float32`` would lose millimetres.

    Args:
        record: a type of records with these fields.
    """
    names = record.names or ()
    return np.dtype([(name, np.float64 if name in "xyz" else record[name]) for name in names])


def packed_colours(colours: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """Pack colours for the field :data:`COLOUR`.

    Args:
        colours: (N, 3) 8-bit sRGB.

    Returns:
        (N,) 0x00RRGGBB.
    """
    red, green, blue = colours.astype(np.uint32).T
    packed: NDArray[np.uint32] = red << 16 | green << 8 | blue
    return packed
