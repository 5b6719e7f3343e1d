"""Matches colour, depth, calibration, pose and mask in time.

Colour is the reference. What matches a colour image is settled only when every other topic has
come as far as its stamp, so the matches do not depend on the order in which the topics' messages
arrive, as long as no queue overflows and the calibration does not change in mid-scan. Within a
topic, stamps must increase.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import cast

from reflest_core.capture.messages import (
    AnyImage,
    CameraInfoMessage,
    PoseMessage,
    Role,
    SensorMessage,
)
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.stamped_queue import StampedQueue

MISSING = {
    Role.DEPTH: RefusalCause.DEPTH_MISSING,
    Role.CAMERA_INFO: RefusalCause.CAMERA_INFO_MISSING,
    Role.POSE: RefusalCause.POSE_MISSING,
    Role.MASK: RefusalCause.MASK_MISSING,
}


@dataclass(frozen=True, eq=False)
class Match:
    """Messages of one moment; the two poses bracket the colour image's stamp."""

    rgb: AnyImage
    depth: AnyImage
    camera_info: CameraInfoMessage
    pose_before: PoseMessage
    pose_after: PoseMessage
    mask: AnyImage | None


class Matcher:
    """Holds each topic's waiting messages and yields matches in stamp order."""

    def __init__(
        self,
        settings: CaptureSettings,
        topics: dict[Role, str],
        refuse: Callable[[FrameRefused], None],
    ) -> None:
        self._settings = settings
        self._topics = topics
        self._refuse = refuse
        self._slop_ns = round(settings.slop * 1e9)
        self._wanted = [Role.CAMERA_INFO, Role.DEPTH, Role.POSE]
        if settings.use_mask:
            self._wanted.append(Role.MASK)
        self._queues: dict[Role, StampedQueue[SensorMessage]] = {}
        self.reset()

    def reset(self) -> None:
        """Forget everything that waits, and how far each topic had come."""
        self._queues = {role: StampedQueue() for role in (Role.RGB, *self._wanted)}

    def add(self, role: Role, message: SensorMessage) -> list[Match]:
        """Take one message; return the matches that it completes, in stamp order."""
        queue = self._queues[role]
        if role is Role.CAMERA_INFO and self._is_known(cast(CameraInfoMessage, message)):
            return []
        if queue.has_reached(message.stamp_ns):
            self._refuse(self._backwards(role, message.stamp_ns, cast(int, queue.latest)))
            return []
        queue.push(message.stamp_ns, message)
        matches = self._settle(is_closed=False)
        is_pose = role is Role.POSE
        size = self._settings.pose_queue_size if is_pose else self._settings.queue_size
        if len(queue) > size:
            queue.pop_oldest()
            self._refuse(self._overflowed(role, size))
        return matches

    def flush(self) -> list[Match]:
        """Settle what still waits with what is known; for the end of a capture."""
        return self._settle(is_closed=True)

    def _is_known(self, info: CameraInfoMessage) -> bool:
        """Whether the last calibration says the same: only changes need to be kept."""
        queue = self._queues[Role.CAMERA_INFO]
        if len(queue) == 0:
            return False
        latest = cast(CameraInfoMessage, queue.bracket(cast(int, queue.latest))[0])
        return replace(info, stamp_ns=latest.stamp_ns) == latest

    def _settle(self, is_closed: bool) -> list[Match]:
        matches = []
        colours = self._queues[Role.RGB]
        while len(colours) > 0:
            rgb = cast(AnyImage, colours.oldest)
            if not is_closed and not self._is_settled(rgb.stamp_ns):
                break
            colours.pop_oldest()
            try:
                matches.append(self._match(rgb))
            except FrameRefused as refusal:
                self._refuse(refusal)
            for role in self._wanted:
                self._queues[role].forget_before(rgb.stamp_ns)
        return matches

    def _is_settled(self, stamp_ns: int) -> bool:
        # A calibration may be published once, so that any is enough.
        return all(
            len(self._queues[role]) > 0
            if role is Role.CAMERA_INFO
            else self._queues[role].has_reached(stamp_ns)
            for role in self._wanted
        )

    def _match(self, rgb: AnyImage) -> Match:
        infos = self._queues[Role.CAMERA_INFO].bracket(rgb.stamp_ns)
        info = infos[0] if infos[0] is not None else infos[1]
        if info is None:
            raise self._missing(Role.CAMERA_INFO, rgb, "publish it or set its topic")
        depth = self._nearest_image(Role.DEPTH, rgb)
        before, after = self._poses(rgb)
        mask = self._nearest_image(Role.MASK, rgb) if self._settings.use_mask else None
        return Match(rgb, depth, cast(CameraInfoMessage, info), before, after, mask)

    def _nearest_image(self, role: Role, rgb: AnyImage) -> AnyImage:
        image = self._queues[role].nearest(rgb.stamp_ns)
        if image is None:
            raise self._missing(role, rgb, "check that the camera publishes it")
        distance_ns = abs(image.stamp_ns - rgb.stamp_ns)
        if distance_ns > self._slop_ns:
            raise self._missing(
                role,
                rgb,
                f"the nearest is {distance_ns / 1e6:.1f} ms away; synchronise the streams or "
                f"raise capture.slop ({self._settings.slop:g} s)",
            )
        return cast(AnyImage, image)

    def _poses(self, rgb: AnyImage) -> tuple[PoseMessage, PoseMessage]:
        before, after = self._queues[Role.POSE].bracket(rgb.stamp_ns)
        if before is None or after is None:
            side = "before" if before is None else "after"
            raise self._missing(Role.POSE, rgb, f"there is none {side} it to interpolate from")
        gap = (after.stamp_ns - before.stamp_ns) / 1e9
        if gap > self._settings.max_pose_gap:
            raise self._missing(
                Role.POSE,
                rgb,
                f"the poses around it are {gap:.3f} s apart; publish them faster or raise "
                f"capture.max_pose_gap ({self._settings.max_pose_gap:g} s)",
            )
        return cast(PoseMessage, before), cast(PoseMessage, after)

    def _missing(self, role: Role, rgb: AnyImage, why: str) -> FrameRefused:
        return FrameRefused(
            MISSING[role],
            f"no message on {self._topics[role]} ({role.value}) matches the colour image at "
            f"{rgb.stamp_ns / 1e9:.3f} s: {why}",
        )

    def _backwards(self, role: Role, stamp_ns: int, latest_ns: int) -> FrameRefused:
        return FrameRefused(
            RefusalCause.TIME_BACKWARDS,
            f"{self._topics[role]} at {stamp_ns / 1e9:.3f} s does not come after "
            f"{latest_ns / 1e9:.3f} s: restart the scan (reset) after a clock jump, and see that "
            "one publisher alone writes the topic",
        )

    def _overflowed(self, role: Role, size: int) -> FrameRefused:
        """Say what a full queue waits for: the first partner that has not come as far."""
        topic = self._topics[role]
        partners = self._wanted if role is Role.RGB else [Role.RGB]
        for partner in partners:
            if self._queues[partner].latest is None:
                cause = MISSING.get(partner, RefusalCause.QUEUE_FULL)
                return FrameRefused(
                    cause,
                    f"{size} messages on {topic} wait and the oldest is dropped: nothing has come "
                    f"on {self._topics[partner]} ({partner.value}); publish it or set its topic",
                )
        timed = [partner for partner in partners if partner is not Role.CAMERA_INFO]
        behind = min(timed, key=lambda partner: cast(int, self._queues[partner].latest))
        reached = cast(int, self._queues[behind].latest) / 1e9
        return FrameRefused(
            RefusalCause.QUEUE_FULL,
            f"{size} messages on {topic} wait and the oldest is dropped: {self._topics[behind]} "
            f"({behind.value}) has only come as far as {reached:.3f} s; compare the publishers' "
            "clocks, or raise capture.queue_size",
        )
