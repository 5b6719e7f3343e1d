# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Hears when simulated time is set back."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.clock import JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node


class ClockWatch:
    """Tells ``on_jump(sentence)`` when the node's clock goes back by ``threshold`` s or more.

    It is told in the thread that sets the clock, and must not block.
    """

    def __init__(self, node: Node, threshold: float, on_jump: Callable[[str], None]) -> None:
        def after(jump: TimeJump) -> None:
            back = -jump.delta.nanoseconds / 1e9
            if back > 0.0:  # rather than a clock that was switched
                on_jump(f"/clock went back by {back:.3f} s: what waited to be fused is dropped")

        self._handle = node.get_clock().create_jump_callback(
            JumpThreshold(
                min_forward=None,
                min_backward=Duration(nanoseconds=-round(threshold * 1e9)),
                on_clock_change=False,
            ),
            post_callback=after,
        )

    def stop(self) -> None:
        """Listen no longer."""
        self._handle.unregister()
