# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Nanoseconds as a stamp of ROS."""

from __future__ import annotations

from builtin_interfaces.msg import Time


def ns_to_stamp(stamp_ns: int) -> Time:
    """``builtin_interfaces/Time`` of nanoseconds since the epoch."""
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=seconds, nanosec=nanoseconds)
