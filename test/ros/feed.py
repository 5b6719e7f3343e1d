# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Views of the sphere sent to the node one after another, and what it says of bad ones."""

from __future__ import annotations

import dataclasses

from own_process import OwnProcess
from ros_peer import RosPeer
from sphere_messages import (
    CAMERA_INFO,
    DEPTH,
    POSE,
    RGB,
    camera_info_message,
    depth_message,
    pose_message,
    rgb_message,
)
from sphere_scene import PERIOD_NS, View, views

SOON = 60.0
"""Seconds within which a node on the slowest machine has named a cause."""


class Feed:
    """Sends views with rising stamps; ``send`` takes messages in the place of a view's own."""

    def __init__(self, node: OwnProcess, peer: RosPeer) -> None:
        self.node = node
        self.peer = peer
        self._views = list(views(8))
        self._count = 0

    def next_view(self, ahead: int = 1) -> View:
        """A view stamped ``ahead`` periods after the last one."""
        self._count += ahead
        stamp_ns = self._views[0].stamp_ns + self._count * PERIOD_NS
        return dataclasses.replace(self._views[self._count % 8], stamp_ns=stamp_ns)

    def send(self, view: View, **instead: object) -> None:
        """Send a view; ``rgb=None`` leaves a message out, another value replaces it."""
        for topic, name, make in (
            (CAMERA_INFO, "info", camera_info_message),
            (POSE, "pose", pose_message),
            (DEPTH, "depth", depth_message),
            (RGB, "rgb", rgb_message),
        ):
            message = instead[name] if name in instead else make(view)
            if message is not None:
                self.peer.publish(topic, message)

    def send_good(self) -> None:
        """Send a good frame and wait until it is fused: the node is alive, its scan is whole."""
        before = self.peer.count("frames fused")
        self.send(self.next_view())
        self.peer.wait_for_count("frames fused", before + 1)
        assert self.node.is_running

    def expect_refusal(self, cause: str, *words: str) -> None:
        """Soon there must be a count of ``cause`` and one warning, both with ``words``."""
        peer = self.peer
        peer.wait_until(lambda: peer.count(f"refused {cause}") > 0, f"no {cause}", SOON)
        warning = self.node.wait_for_line(rf"\(cause: {cause}; logged once\)", SOON)
        peer.wait_until(
            lambda: all(word in peer.state for word in words), f"not in {peer.state}", SOON
        )
        for word in words:
            assert word in warning
        assert len(self.node.lines_with(rf"cause: {cause};")) == 1
