# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The waiting messages of one topic, in stamp order."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import Generic, TypeVar

T = TypeVar("T")


class StampedQueue(Generic[T]):
    """Answers which message stands next to a stamp; remembers how far the topic has come."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._messages: list[T] = []
        self.latest: int | None = None

    def __len__(self) -> int:
        return len(self._stamps)

    def push(self, stamp_ns: int, message: T) -> None:
        """Append a message; its stamp must come after ``latest``."""
        self._stamps.append(stamp_ns)
        self._messages.append(message)
        self.latest = stamp_ns

    def pop_oldest(self) -> T:
        """Remove and return the oldest message."""
        self._stamps.pop(0)
        return self._messages.pop(0)

    @property
    def oldest(self) -> T:
        """The oldest waiting message."""
        return self._messages[0]

    def has_reached(self, stamp_ns: int) -> bool:
        """Whether a message at or after ``stamp_ns`` was ever pushed."""
        return self.latest is not None and self.latest >= stamp_ns

    def nearest(self, stamp_ns: int) -> T | None:
        """Return the message nearest in stamp (the earlier of two as near), None when empty."""
        after = bisect_left(self._stamps, stamp_ns)
        around = [index for index in (after - 1, after) if 0 <= index < len(self._stamps)]
        if not around:
            return None
        return self._messages[min(around, key=lambda index: abs(self._stamps[index] - stamp_ns))]

    def bracket(self, stamp_ns: int) -> tuple[T | None, T | None]:
        """Return the last message at or before and the first at or after ``stamp_ns``."""
        before = bisect_right(self._stamps, stamp_ns) - 1
        after = bisect_left(self._stamps, stamp_ns)
        return (
            self._messages[before] if before >= 0 else None,
            self._messages[after] if after < len(self._stamps) else None,
        )

    def clear(self) -> list[T]:
        """Forget everything, ``latest`` too; return what waited."""
        waiting = self._messages
        self._stamps, self._messages, self.latest = [], [], None
        return waiting

    def forget_before(self, stamp_ns: int) -> None:
        """Drop what no later stamp can ask for: all before the last message at or before it."""
        keep_from = max(bisect_right(self._stamps, stamp_ns) - 1, 0)
        del self._stamps[:keep_from], self._messages[:keep_from]
