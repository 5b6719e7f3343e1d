# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The waiting messages of every topic, let in by their stamps."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import cast

from reflest_core.capture.messages import CameraInfoMessage, Role, SensorMessage, TransformsMessage
from reflest_core.capture.refusal import FrameRefused
from reflest_core.capture.sync.match_refusals import MatchRefusals
from reflest_core.capture.sync.queues import Calibrations, StampedQueue
from reflest_core.capture.sync.stamp_clock import StampClock, StampVerdict
from reflest_core.capture.sync.transform_buffer import TransformBuffer

INFO_ROLES = (Role.CAMERA_INFO, Role.DEPTH_INFO)


class Inbox:
    """A queue for each role, the cameras' calibrations and the transforms."""

    def __init__(
        self,
        roles: Iterable[Role],
        topics: dict[Role, str],
        refuse: Callable[[FrameRefused], None],
        transforms: TransformBuffer,
        jump: float,
        on_clock_jump: Callable[[str], None],
    ) -> None:
        """Begin with empty queues.

        Args:
            roles: streams that wait for one another.
            topics: names of the streams for sentences.
            refuse: called with what cannot be used.
            transforms: takes what comes by tf.
            jump: seconds back that count as a clock that was reset.
            on_clock_jump: called where stamps start again.
        """
        self.queues: dict[Role, StampedQueue[SensorMessage]] = {
            role: StampedQueue() for role in roles
        }
        self.infos = {role: Calibrations() for role in INFO_ROLES}
        self._topics = topics
        self._refuse = refuse
        self._transforms = transforms
        self._on_clock_jump = on_clock_jump
        self._jump = jump
        self._clock = StampClock(jump)
        self._refusals = MatchRefusals(topics)

    def add(self, role: Role, message: SensorMessage) -> None:
        """Let a message wait, or refuse it by its stamp.

        Args:
            role: the stream of the message.
            message: as it was received or recorded.
        """
        if isinstance(message, TransformsMessage):
            is_static = role is Role.TF_STATIC
            for refusal in self._transforms.add(message, is_static, self._topics[role]):
                self._refuse(refusal)
        elif isinstance(message, CameraInfoMessage):
            infos = self.infos[role]
            if not infos.is_known(message) and self._is_next(role, message.stamp_ns):
                infos.add(message)
        elif self._is_next(role, message.stamp_ns):
            self.queues[role].push(message.stamp_ns, message)

    def waiting(self, role: Role) -> StampedQueue[SensorMessage] | Calibrations:
        """What waits of a role other than the transforms.

        Args:
            role: the stream of the message.
        """
        return self.infos[role] if role in self.infos else self.queues[role]

    def forget_before(self, stamp_ns: int) -> None:
        """Drop the partners that no later colour image can ask for.

        Args:
            stamp_ns: nanoseconds.
        """
        for role in (*self.queues, *self.infos):
            if role is not Role.RGB:
                self.waiting(role).forget_before(stamp_ns)

    def reset(self) -> None:
        """Forget what waits and every stamp; calibrations stay, for they may have been latched."""
        self._clock.reset()
        for role in (*self.queues, *self.infos):
            self._forget(role)
        self._transforms.forget_after(0)

    def _is_next(self, role: Role, stamp_ns: int) -> bool:
        """Judge a stamp; refuse it, or make room for it where time went back."""
        if stamp_ns < 0:
            self._refuse(self._refusals.negative(role, stamp_ns))
            return False
        latest = cast(int, self._clock.latest(role))
        verdict = self._clock.take(role, stamp_ns)
        if verdict is StampVerdict.LATE:
            self._refuse(self._refusals.late(role, stamp_ns, latest))
        elif verdict is StampVerdict.BEFORE_JUMP:
            self._refuse(self._refusals.before_jump(role, stamp_ns))
        elif verdict is StampVerdict.TOPIC_WAS_AHEAD:
            self._refuse(self._refusals.was_ahead(role, latest, stamp_ns))
            self._refuse_waiting(role)
        elif verdict is StampVerdict.CLOCK_JUMPED:
            self._restart(self._refusals.clock_jump(role, latest, stamp_ns, self._jump), stamp_ns)
        return verdict not in (StampVerdict.LATE, StampVerdict.BEFORE_JUMP)

    def _restart(self, jump: FrameRefused, stamp_ns: int) -> None:
        self._refuse(jump)
        for role in (*self.queues, *self.infos):
            self._refuse_waiting(role)
        self._transforms.forget_after(stamp_ns + round(self._jump * 1e9))
        self._on_clock_jump(str(jump))

    def _refuse_waiting(self, role: Role) -> None:
        """Forget a topic's messages; of colour, each is a frame that is lost."""
        for message in self._forget(role):
            if role is Role.RGB:
                self._refuse(self._refusals.before_jump(role, message.stamp_ns))

    def _forget(self, role: Role) -> list[SensorMessage]:
        if role in self.infos:
            self.infos[role].restart()
            return []
        return self.queues[role].clear()
