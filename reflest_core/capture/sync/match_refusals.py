# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Why a message found no partner, in a sentence that names the topic and the parameter."""

from __future__ import annotations

from reflest_core.capture.messages import AnyImage, Role
from reflest_core.capture.refusal import FrameRefused, RefusalCause

MISSING = {
    Role.DEPTH: RefusalCause.DEPTH_MISSING,
    Role.CAMERA_INFO: RefusalCause.CAMERA_INFO_MISSING,
    Role.POSE: RefusalCause.POSE_MISSING,
    Role.MASK: RefusalCause.MASK_MISSING,
}


class MatchRefusals:
    """Makes the refusals of a matcher whose topics have these names."""

    def __init__(self, topics: dict[Role, str]) -> None:
        """Remember the names.

        Args:
            topics: names of the streams for sentences.
        """
        self._topics = topics

    def missing(self, role: Role, rgb: AnyImage, why: str) -> FrameRefused:
        """A colour image has no partner of ``role``.

        Args:
            role: the stream of the message.
            rgb: a colour image, whose stamp counts.
            why: what is missing, as a clause.
        """
        return FrameRefused(
            MISSING[role],
            f"no message on {self._topics[role]} ({role.value}) matches the colour image at "
            f"{_seconds(rgb.stamp_ns)}: {why}",
        )

    def negative(self, role: Role, stamp_ns: int) -> FrameRefused:
        """A stamp lies before 1970.

        Args:
            role: the stream of the message.
            stamp_ns: nanoseconds.
        """
        return FrameRefused(
            RefusalCause.STAMP_INVALID,
            f"{self._topics[role]} has the negative stamp {_seconds(stamp_ns)}: see that its "
            "publisher fills in header.stamp",
        )

    def late(self, role: Role, stamp_ns: int, latest_ns: int) -> FrameRefused:
        """A stamp does not come after the topic's last one.

        Args:
            role: the stream of the message.
            stamp_ns: nanoseconds.
            latest_ns: the latest stamp before, nanoseconds.
        """
        return FrameRefused(
            RefusalCause.TIME_BACKWARDS,
            f"{self._topics[role]} at {_seconds(stamp_ns)} does not come after "
            f"{_seconds(latest_ns)}: see that one publisher alone writes the topic and stamps "
            "each message again",
        )

    def before_jump(self, role: Role, stamp_ns: int) -> FrameRefused:
        """A message of before a clock jump came, or still waited, after it.

        Args:
            role: the stream of the message.
            stamp_ns: nanoseconds.
        """
        return FrameRefused(
            RefusalCause.TIME_BACKWARDS,
            f"{self._topics[role]} at {_seconds(stamp_ns)} is dropped: the clock went back before "
            "it found its partners",
        )

    def was_ahead(self, role: Role, ahead_ns: int, stamp_ns: int) -> FrameRefused:
        """One topic's stamp was ahead of its later ones.

        Args:
            role: the stream of the message.
            ahead_ns: how far it was ahead, nanoseconds.
            stamp_ns: nanoseconds.
        """
        return FrameRefused(
            RefusalCause.TIME_BACKWARDS,
            f"{self._topics[role]} went from {_seconds(ahead_ns)} back to {_seconds(stamp_ns)}, "
            "the other topics did not: what waited on it is dropped; check its publisher's clock",
        )

    def clock_jump(self, role: Role, latest_ns: int, stamp_ns: int, bound: float) -> FrameRefused:
        """All stamps start again.

        Args:
            role: the stream of the message.
            latest_ns: the latest stamp before, nanoseconds.
            stamp_ns: nanoseconds.
            bound: parameter ``capture.clock_jump``, seconds.
        """
        return FrameRefused(
            RefusalCause.CLOCK_JUMP,
            f"the clock jumped back from {_seconds(latest_ns)} to {_seconds(stamp_ns)}, first on "
            f"{self._topics[role]}: what waited is dropped and matching goes on from there; if "
            f"no bag or simulation was restarted, check the publishers' clocks (capture.clock_jump "
            f"is {bound:g} s)",
        )

    def never_came(self, role: Role, absent: Role, size: int) -> FrameRefused:
        """A queue is full and its partner has never sent anything.

        Args:
            role: the stream of the message.
            absent: the stream that never came.
            size: messages that wait.
        """
        return FrameRefused(
            MISSING.get(absent, RefusalCause.QUEUE_FULL),
            f"{size} messages on {self._topics[role]} wait and the oldest is dropped: nothing has "
            f"come on {self._topics[absent]} ({absent.value}); publish it or set its topic",
        )

    def lags(self, role: Role, behind: Role, reached_ns: int, size: int) -> FrameRefused:
        """A queue is full and its partner has not come as far.

        Args:
            role: the stream of the message.
            behind: the stream that lags.
            reached_ns: how far that stream has come, nanoseconds.
            size: messages that wait.
        """
        return FrameRefused(
            RefusalCause.QUEUE_FULL,
            f"{size} messages on {self._topics[role]} wait and the oldest is dropped: "
            f"{self._topics[behind]} ({behind.value}) has only come as far as "
            f"{_seconds(reached_ns)}; compare the publishers' clocks, or raise capture.queue_size",
        )


def _seconds(stamp_ns: int) -> str:
    return f"{stamp_ns / 1e9:.3f} s"
