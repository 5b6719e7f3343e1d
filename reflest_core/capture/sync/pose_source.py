# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where an image's pose comes from: a topic of poses, or the tree of transforms."""

from __future__ import annotations

from typing import Protocol

from reflest_core.capture.messages import AnyImage, PoseMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.sync.queues import StampedQueue
from reflest_core.capture.sync.transform_buffer import TransformBuffer


class PoseSource(Protocol):
    """Answers for one image at a time, in stamp order."""

    def has_reached(self, rgb: AnyImage) -> bool:
        """Whether no later message can change the image's pose.

        Args:
            rgb: a colour image, whose stamp counts.
        """
        ...

    def around(self, rgb: AnyImage) -> tuple[PoseMessage, PoseMessage]:
        """Return the poses to interpolate between; raises :class:`FrameRefused`.

        Args:
            rgb: a colour image, whose stamp counts.
        """
        ...


class TopicPoses:
    """``PoseStamped`` or ``Odometry`` messages that wait in ``queue``."""

    def __init__(self, queue: StampedQueue[PoseMessage], topic: str, longest_gap: float) -> None:
        """Read poses of a queue.

        Args:
            queue: takes the messages.
            topic: for sentences.
            longest_gap: seconds between two poses that are interpolated at most.
        """
        self._queue = queue
        self._topic = topic
        self._longest_gap = longest_gap

    def has_reached(self, rgb: AnyImage) -> bool:
        """Whether a pose at or after the image has come.

        Args:
            rgb: a colour image, whose stamp counts.
        """
        return self._queue.has_reached(rgb.stamp_ns)

    def around(self, rgb: AnyImage) -> tuple[PoseMessage, PoseMessage]:
        """Return the pose before and the pose after; raises POSE_MISSING.

        Args:
            rgb: a colour image, whose stamp counts.
        """
        before, after = self._queue.bracket(rgb.stamp_ns)
        if before is None or after is None:
            side = "before" if before is None else "after"
            raise self._missing(rgb, f"there is none {side} it to interpolate from")
        gap = (after.stamp_ns - before.stamp_ns) / 1e9
        if gap > self._longest_gap:
            raise self._missing(
                rgb,
                f"the poses around it are {gap:.3f} s apart; publish them faster or raise "
                f"capture.max_pose_gap ({self._longest_gap:g} s)",
            )
        return before, after

    def _missing(self, rgb: AnyImage, why: str) -> FrameRefused:
        return FrameRefused(
            RefusalCause.POSE_MISSING,
            f"no message on {self._topic} (pose) matches the colour image at "
            f"{rgb.stamp_ns / 1e9:.3f} s: {why}",
        )


class TransformPoses:
    """The camera's frame in ``world_frame``, from tf."""

    def __init__(self, transforms: TransformBuffer, world_frame: str, rgb_topic: str) -> None:
        """Read poses of a buffer.

        Args:
            transforms: takes what comes by tf.
            world_frame: the frame that poses are in.
            rgb_topic: for sentences.
        """
        self._transforms = transforms
        self._world_frame = world_frame
        self._rgb_topic = rgb_topic

    def has_reached(self, rgb: AnyImage) -> bool:
        """Whether every transform on the way is known up to the image.

        Args:
            rgb: a colour image, whose stamp counts.
        """
        return not rgb.frame_id or self._transforms.has_reached(
            self._world_frame, rgb.frame_id, rgb.stamp_ns
        )

    def around(self, rgb: AnyImage) -> tuple[PoseMessage, PoseMessage]:
        """Return the pose at the image's stamp, twice; raises TRANSFORM_MISSING.

        Args:
            rgb: a colour image, whose stamp counts.
        """
        if not rgb.frame_id:
            raise FrameRefused(
                RefusalCause.TRANSFORM_MISSING,
                f"{self._rgb_topic} names no frame_id, so tf has no pose for it: set it in the "
                "camera driver, or choose capture.pose_source pose",
            )
        pose = self._transforms.pose(self._world_frame, rgb.frame_id, rgb.stamp_ns)
        return pose, pose
