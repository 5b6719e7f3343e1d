# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Distinguishes a clock that was set back from one wrong stamp and from a late message."""

from __future__ import annotations

import enum

from reflest_core.capture.messages import Role


class StampVerdict(enum.Enum):
    """What to do with a message, by its stamp."""

    NEXT = "it comes after its topic's last one: take it"
    LATE = "it does not: refuse it"
    TOPIC_WAS_AHEAD = "its topic alone was ahead of time: forget what waits on it, take this"
    CLOCK_JUMPED = "the clock went back: forget what waits on every topic, take this"
    BEFORE_JUMP = "it was sent before the clock went back: drop it"


class StampClock:
    """Remembers how far each topic has come.

    One stamp far back may be a mistake, two that agree are a jump. After it, topics that have not
    followed yet still deliver some messages of before it.
    """

    def __init__(self, jump: float) -> None:
        """Begin without stamps.

        Args:
            jump: least step back, seconds, that is a reset and no lateness.
        """
        self._jump_ns = round(jump * 1e9)
        self._latest: dict[Role, int] = {}
        self._before_jump: dict[Role, int] = {}
        self._suspect: tuple[Role, int] | None = None

    def latest(self, role: Role) -> int | None:
        """The last stamp that was taken on a topic, ns.

        Args:
            role: the stream of the message.
        """
        return self._latest.get(role)

    def reset(self) -> None:
        """Forget every stamp: any may come next."""
        self._latest, self._before_jump, self._suspect = {}, {}, None

    def take(self, role: Role, stamp_ns: int) -> StampVerdict:
        """Judge the next stamp of a topic and remember it unless it is refused.

        Args:
            role: the stream of the message.
            stamp_ns: nanoseconds.
        """
        verdict = self._judge(role, stamp_ns)
        if verdict is StampVerdict.CLOCK_JUMPED:
            self._before_jump = self._latest
            self._latest, self._suspect = {}, None
        if verdict not in (StampVerdict.LATE, StampVerdict.BEFORE_JUMP):
            self._before_jump.pop(role, None)
            self._latest[role] = stamp_ns
            if self._suspect is not None and self._suspect[0] is role:
                self._suspect = None
        return verdict

    def _judge(self, role: Role, stamp_ns: int) -> StampVerdict:
        if self._is_of_before_jump(role, stamp_ns):
            return StampVerdict.BEFORE_JUMP
        latest = self._latest.get(role)
        if latest is None or stamp_ns > latest:
            return StampVerdict.NEXT
        if stamp_ns > latest - self._jump_ns:
            return StampVerdict.LATE
        others = [other for known, other in self._latest.items() if known is not role]
        if not any(other > stamp_ns + self._jump_ns for other in others):
            return StampVerdict.TOPIC_WAS_AHEAD
        if self._is_confirmed(role, stamp_ns):
            return StampVerdict.CLOCK_JUMPED
        self._suspect = (role, stamp_ns)
        return StampVerdict.LATE

    def _is_confirmed(self, role: Role, stamp_ns: int) -> bool:
        """Whether an earlier stamp far back agrees with this one."""
        if self._suspect is None or abs(stamp_ns - self._suspect[1]) >= self._jump_ns:
            return False
        return role is not self._suspect[0] or stamp_ns > self._suspect[1]

    def _is_of_before_jump(self, role: Role, stamp_ns: int) -> bool:
        before = self._before_jump.get(role)
        if before is None or not self._latest:
            return False
        is_ahead = stamp_ns > max(self._latest.values()) + self._jump_ns
        return is_ahead and abs(stamp_ns - before) < self._jump_ns
