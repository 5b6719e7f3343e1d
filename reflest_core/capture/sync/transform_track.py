# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The recent poses of one frame in its parent: interpolated between, never beyond."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.messages import PoseMessage
from reflest_core.capture.pose import pose_at
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.sync.queues import StampedQueue

HISTORY_NS = 10 * 10**9  # as long as tf2 keeps it
MOST_SAMPLES = 10_000
SAME = 1e-6  # metres, and parts of a quaternion


class TransformTrack:
    """Poses of one child frame, all in the same parent frame."""

    def __init__(self, first: PoseMessage, is_static: bool, jump_ns: int) -> None:
        """Begin with one pose.

        Args:
            first: the first pose.
            is_static: whether it holds for all times.
            jump_ns: nanoseconds back that count as a clock that was reset.
        """
        self.parent = first.frame_id
        self.is_static = is_static
        self._jump_ns = jump_ns
        self._queue: StampedQueue[PoseMessage] = StampedQueue()
        self.add(first)

    def add(self, transform: PoseMessage) -> None:
        """Take the next pose; one that is late is left out, one far back starts a new track.

        Args:
            transform: of one pair of frames.
        """
        queue, stamp_ns = self._queue, transform.stamp_ns
        if self.is_static or (
            queue.latest is not None and stamp_ns <= queue.latest - self._jump_ns
        ):
            queue.clear()
        if not queue.has_reached(stamp_ns):
            queue.push(stamp_ns, transform)
        queue.forget_before(stamp_ns - HISTORY_NS)
        if len(queue) > MOST_SAMPLES:
            queue.pop_oldest()

    def is_at(self, transform: PoseMessage) -> bool:
        """Whether a transform is the last one again, in the same parent, but for rounding.

        Args:
            transform: of one pair of frames.
        """
        last = self._queue.newest
        return transform.frame_id == self.parent and _is_same(last, transform)

    def has_reached(self, stamp_ns: int) -> bool:
        """Whether no later message can change the pose at the stamp.

        Args:
            stamp_ns: nanoseconds.
        """
        return self.is_static or self._queue.has_reached(stamp_ns)

    def matrix_at(self, stamp_ns: int, longest_gap: float) -> NDArray[np.float64]:
        """Return ``T_parent_child`` (4, 4).

        Args:
            stamp_ns: nanoseconds.
            longest_gap: seconds between two transforms that are interpolated at most.

        Raises:
            FrameRefused: TRANSFORM_MISSING where the poses do not enclose the stamp closely.
        """
        before, after = (self._queue.oldest,) * 2 if self.is_static else self._around(stamp_ns)
        gap = (after.stamp_ns - before.stamp_ns) / 1e9
        if gap > longest_gap:
            raise self._missing(
                stamp_ns,
                f"those around it are {gap:.3f} s apart; publish it faster or raise "
                f"capture.max_transform_gap ({longest_gap:g} s)",
            )
        at = before.stamp_ns if self.is_static else stamp_ns
        return pose_at(at, before, after, "tf")

    def _around(self, stamp_ns: int) -> tuple[PoseMessage, PoseMessage]:
        before, after = self._queue.bracket(stamp_ns)
        if before is None:
            first = self._queue.oldest.stamp_ns / 1e9
            raise self._missing(stamp_ns, f"what is known begins at {first:.3f} s")
        if after is None:
            raise self._missing(
                stamp_ns,
                f"the last one is of {before.stamp_ns / 1e9:.3f} s; see that its "
                "publisher runs and that its clock is the camera's",
            )
        return before, after

    def _missing(self, stamp_ns: int, why: str) -> FrameRefused:
        child = self._queue.oldest.child_frame_id
        return FrameRefused(
            RefusalCause.TRANSFORM_MISSING,
            f"no transform from {child!r} to {self.parent!r} at {stamp_ns / 1e9:.3f} s: {why}",
        )


def _is_same(one: PoseMessage, other: PoseMessage) -> bool:
    """Whether two poses are equal but for rounding; q and -q are one rotation."""
    shift = max(abs(a - b) for a, b in zip(one.position, other.position, strict=True))
    cosine = sum(a * b for a, b in zip(one.orientation, other.orientation, strict=True))
    return shift < SAME and abs(cosine) > 1.0 - SAME
