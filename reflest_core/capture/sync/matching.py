# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Matches colour, depth, calibration, pose and mask in time.

Colour is the reference. What matches a colour image is decided only when every other topic has
come as far as its stamp, so the matches do not depend on the order in which the topics' messages
arrive, as long as no queue overflows, none is waited for too long and the calibration does not
change in mid-scan. Within a topic, stamps must increase, until the clock goes back.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

from reflest_core.capture.messages import (
    AnyImage,
    CameraInfoMessage,
    Match,
    PoseMessage,
    Role,
    SensorMessage,
)
from reflest_core.capture.refusal import FrameRefused
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.sync.depth_alignment import DepthAlignment
from reflest_core.capture.sync.inbox import Inbox
from reflest_core.capture.sync.match_refusals import MatchRefusals
from reflest_core.capture.sync.pose_source import PoseSource, TopicPoses, TransformPoses
from reflest_core.capture.sync.queues import StampedQueue
from reflest_core.capture.sync.transform_buffer import TransformBuffer


class Matcher:
    """Yields the matches of what waits in the inbox, in stamp order."""

    def __init__(
        self,
        settings: CaptureSettings,
        topics: dict[Role, str],
        refuse: Callable[[FrameRefused], None],
        transforms: TransformBuffer,
        alignment: DepthAlignment,
        on_clock_jump: Callable[[str], None],
    ) -> None:
        """Begin with an empty inbox.

        Args:
            settings: parameters of the group ``capture``.
            topics: names of the streams for sentences.
            refuse: called with what cannot be used.
            transforms: takes what comes by tf.
            alignment: registers depth.
            on_clock_jump: called where stamps start again.
        """
        self._settings = settings
        self._refuse = refuse
        self._alignment = alignment
        self._refusals = MatchRefusals(topics)
        self._slop_ns = round(settings.slop * 1e9)
        self._max_wait_ns = round(settings.max_wait * 1e9)
        has_pose_topic = settings.pose_source != "tf"
        self._partners = [
            Role.DEPTH,
            *([Role.POSE] if has_pose_topic else []),
            *([Role.MASK] if settings.use_mask else []),
        ]
        self._inbox = Inbox(
            [Role.RGB, *self._partners],
            topics,
            refuse,
            transforms,
            settings.clock_jump,
            on_clock_jump,
        )
        self._poses: PoseSource = TransformPoses(transforms, settings.world_frame, topics[Role.RGB])
        if has_pose_topic:
            queue = cast("StampedQueue[PoseMessage]", self._inbox.queues[Role.POSE])
            self._poses = TopicPoses(queue, topics[Role.POSE], settings.max_pose_gap)

    def reset(self) -> None:
        """Forget what waits and how far each topic had come; calibrations stay."""
        self._inbox.reset()

    def add(self, role: Role, message: SensorMessage) -> list[Match]:
        """Take one message; return the matches that it completes, in stamp order.

        Args:
            role: the stream of the message.
            message: as it was received or recorded.
        """
        self._inbox.add(role, message)
        return self._decide(is_closed=False) + self._shorten(role)

    def flush(self) -> list[Match]:
        """Decide what still waits by what is known; for the end of a capture.

        Returns:
            The matches that still can be made.
        """
        return self._decide(is_closed=True)

    def _decide(self, is_closed: bool) -> list[Match]:
        matches: list[Match] = []
        colours = self._inbox.queues[Role.RGB]
        while len(colours) > 0:
            rgb = cast(AnyImage, colours.oldest)
            is_overdue = cast(int, colours.latest) - rgb.stamp_ns > self._max_wait_ns
            if not is_closed and not is_overdue and not self._is_decided(rgb):
                break
            matches += self._match_oldest()
        return matches

    def _is_decided(self, rgb: AnyImage) -> bool:
        # A calibration may be published once, so that any is enough.
        return (
            len(self._inbox.infos[Role.CAMERA_INFO]) > 0
            and all(self._inbox.queues[role].has_reached(rgb.stamp_ns) for role in self._partners)
            and self._poses.has_reached(rgb)
            and self._is_depth_decided(rgb)
        )

    def _is_depth_decided(self, rgb: AnyImage) -> bool:
        depth = cast("AnyImage | None", self._inbox.queues[Role.DEPTH].nearest(rgb.stamp_ns))
        if depth is None or abs(depth.stamp_ns - rgb.stamp_ns) > self._slop_ns:
            return True
        return self._alignment.is_decided(rgb, depth, self._depth_info(depth))

    def _match_oldest(self) -> list[Match]:
        """Match the oldest colour image, or refuse it."""
        rgb = cast(AnyImage, self._inbox.queues[Role.RGB].pop_oldest())
        try:
            return [self._match(rgb)]
        except FrameRefused as refusal:
            self._refuse(refusal)
            return []
        finally:
            self._inbox.forget_before(rgb.stamp_ns)

    def _match(self, rgb: AnyImage) -> Match:
        info = self._inbox.infos[Role.CAMERA_INFO].at(rgb.stamp_ns)
        if info is None:
            raise self._refusals.missing(Role.CAMERA_INFO, rgb, "publish it or set its topic")
        depth = self._nearest_image(Role.DEPTH, rgb)
        before, after = self._poses.around(rgb)
        mask = self._nearest_image(Role.MASK, rgb) if self._settings.use_mask else None
        return Match(rgb, depth, info, self._depth_info(depth), before, after, mask)

    def _depth_info(self, depth: AnyImage) -> CameraInfoMessage | None:
        return self._inbox.infos[Role.DEPTH_INFO].at(depth.stamp_ns)

    def _nearest_image(self, role: Role, rgb: AnyImage) -> AnyImage:
        image = self._inbox.queues[role].nearest(rgb.stamp_ns)
        if image is None:
            raise self._refusals.missing(role, rgb, "check that the camera publishes it")
        distance_ns = abs(image.stamp_ns - rgb.stamp_ns)
        if distance_ns > self._slop_ns:
            raise self._refusals.missing(
                role,
                rgb,
                f"the nearest is {distance_ns / 1e6:.1f} ms away; synchronise the streams or "
                f"raise capture.slop ({self._settings.slop:g} s)",
            )
        return cast(AnyImage, image)

    def _shorten(self, role: Role) -> list[Match]:
        """Give the oldest up where too many messages wait, and say what they wait for."""
        if role in (Role.TF, Role.TF_STATIC):
            return []
        is_pose = role is Role.POSE
        size = self._settings.pose_queue_size if is_pose else self._settings.queue_size
        waiting, colours = self._inbox.waiting(role), self._inbox.queues[Role.RGB]
        matches: list[Match] = []
        while len(waiting) > size:
            if role is not Role.RGB and len(colours) > 0:
                waiting.forget_before(colours.oldest.stamp_ns)
            if len(waiting) > size:
                # Partners of colour images wait because the images do.
                stuck = Role.RGB if len(colours) > 0 else role
                matches += self._give_up_oldest(stuck, size)
        return matches

    def _give_up_oldest(self, role: Role, size: int) -> list[Match]:
        refusal = self._overflowed(role, size)
        if refusal is None:
            return self._match_oldest()
        self._inbox.waiting(role).pop_oldest()
        self._refuse(refusal)
        return []

    def _overflowed(self, role: Role, size: int) -> FrameRefused | None:
        """Name the partner that never came or lags; None where only transforms are awaited."""
        partners = [Role.CAMERA_INFO, *self._partners] if role is Role.RGB else [Role.RGB]
        reached: dict[Role, int] = {}
        for partner in partners:
            latest = self._inbox.waiting(partner).latest
            if latest is None:
                return self._refusals.never_came(role, partner, size)
            reached[partner] = latest
        reached.pop(Role.CAMERA_INFO, None)
        behind = min(reached, key=lambda partner: reached[partner])
        if role is Role.RGB and reached[behind] >= self._inbox.queues[role].oldest.stamp_ns:
            return None
        return self._refusals.lags(role, behind, reached[behind], size)
