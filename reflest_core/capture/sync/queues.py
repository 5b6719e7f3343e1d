# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The waiting messages of one topic, in stamp order, and the calibrations of one camera."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import replace
from typing import Generic, TypeVar

from reflest_core.capture.messages import CameraInfoMessage

T = TypeVar("T")
ANY_TIME = -(2**63)


class StampedQueue(Generic[T]):
    """Answers which message stands next to a stamp; remembers how far the topic has come."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._messages: list[T] = []
        self.latest: int | None = None

    def __len__(self) -> int:
        return len(self._stamps)

    def push(self, stamp_ns: int, message: T) -> None:
        """Append a message; its stamp must come after ``latest``.

        Args:
            stamp_ns: nanoseconds.
            message: as it was received or recorded.
        """
        self._stamps.append(stamp_ns)
        self._messages.append(message)
        self.latest = stamp_ns

    def pop_oldest(self) -> T:
        """Remove and return the oldest message.

        Returns:
            The message.
        """
        self._stamps.pop(0)
        return self._messages.pop(0)

    @property
    def oldest(self) -> T:
        """The oldest waiting message."""
        return self._messages[0]

    @property
    def newest(self) -> T:
        """The newest waiting message."""
        return self._messages[-1]

    def has_reached(self, stamp_ns: int) -> bool:
        """Whether a message at or after ``stamp_ns`` was ever pushed.

        Args:
            stamp_ns: nanoseconds.
        """
        return self.latest is not None and self.latest >= stamp_ns

    def nearest(self, stamp_ns: int) -> T | None:
        """Return the message nearest in stamp (the earlier of two as near), None when empty.

        Args:
            stamp_ns: nanoseconds.
        """
        after = bisect_left(self._stamps, stamp_ns)
        around = [index for index in (after - 1, after) if 0 <= index < len(self._stamps)]
        if not around:
            return None
        return self._messages[min(around, key=lambda index: abs(self._stamps[index] - stamp_ns))]

    def bracket(self, stamp_ns: int) -> tuple[T | None, T | None]:
        """Return the last message at or before and the first at or after ``stamp_ns``.

        Args:
            stamp_ns: nanoseconds.
        """
        before = bisect_right(self._stamps, stamp_ns) - 1
        after = bisect_left(self._stamps, stamp_ns)
        return (
            self._messages[before] if before >= 0 else None,
            self._messages[after] if after < len(self._stamps) else None,
        )

    def clear(self) -> list[T]:
        """Forget everything, ``latest`` too; return what waited.

        Returns:
            What waited.
        """
        waiting = self._messages
        self._stamps, self._messages, self.latest = [], [], None
        return waiting

    def forget_before(self, stamp_ns: int) -> None:
        """Drop what no later stamp can ask for: all before the last message at or before it.

        Args:
            stamp_ns: nanoseconds.
        """
        keep_from = max(bisect_right(self._stamps, stamp_ns) - 1, 0)
        del self._stamps[:keep_from], self._messages[:keep_from]


class Calibrations:
    """``CameraInfo`` messages by stamp. Cameras repeat them, or latch a single one."""

    def __init__(self) -> None:
        self._infos: list[CameraInfoMessage] = []

    def __len__(self) -> int:
        return len(self._infos)

    @property
    def latest(self) -> int | None:
        """Stamp of the last change."""
        return self._infos[-1].stamp_ns if self._infos else None

    def is_known(self, info: CameraInfoMessage) -> bool:
        """Whether ``info`` says what the last one said; if earlier, that was in force earlier.

        Args:
            info: as the driver published it.
        """
        if not self._infos or replace(info, stamp_ns=self._infos[-1].stamp_ns) != self._infos[-1]:
            return False
        if info.stamp_ns < self._infos[-1].stamp_ns:
            known = [one for one in self._infos[:-1] if one.stamp_ns < info.stamp_ns]
            self._infos = [*known, info]
        return True

    def add(self, info: CameraInfoMessage) -> None:
        """Take a change; its stamp must come after ``latest``.

        Args:
            info: as the driver published it.
        """
        self._infos.append(info)

    @property
    def oldest(self) -> CameraInfoMessage:
        """The oldest that is kept."""
        return self._infos[0]

    def pop_oldest(self) -> CameraInfoMessage:
        """Remove and return the oldest.

        Returns:
            It.
        """
        return self._infos.pop(0)

    def at(self, stamp_ns: int) -> CameraInfoMessage | None:
        """The calibration in force: the last at or before the stamp, else the first after it.

        Args:
            stamp_ns: nanoseconds.
        """
        if not self._infos:
            return None
        after = bisect_right(self._infos, stamp_ns, key=lambda info: info.stamp_ns)
        return self._infos[max(after - 1, 0)]

    def forget_before(self, stamp_ns: int) -> None:
        """Drop all before the one in force at the stamp.

        Args:
            stamp_ns: nanoseconds.
        """
        after = bisect_right(self._infos, stamp_ns, key=lambda info: info.stamp_ns)
        del self._infos[: max(after - 1, 0)]

    def restart(self) -> None:
        """Keep the last one alone, for whatever stamp: it may have been latched."""
        self._infos = [replace(info, stamp_ns=ANY_TIME) for info in self._infos[-1:]]
