# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The calibrations of one camera: only changes are kept, and the last one for good."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import replace

from reflest_core.capture.messages import CameraInfoMessage

ANY_TIME = -(2**63)


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
        """Whether ``info`` says what the last one said; if earlier, that was in force earlier."""
        if not self._infos or replace(info, stamp_ns=self._infos[-1].stamp_ns) != self._infos[-1]:
            return False
        if info.stamp_ns < self._infos[-1].stamp_ns:
            known = [one for one in self._infos[:-1] if one.stamp_ns < info.stamp_ns]
            self._infos = [*known, info]
        return True

    def add(self, info: CameraInfoMessage) -> None:
        """Take a change; its stamp must come after ``latest``."""
        self._infos.append(info)

    @property
    def oldest(self) -> CameraInfoMessage:
        """The oldest that is kept."""
        return self._infos[0]

    def pop_oldest(self) -> CameraInfoMessage:
        """Remove and return the oldest."""
        return self._infos.pop(0)

    def at(self, stamp_ns: int) -> CameraInfoMessage | None:
        """The calibration in force: the last at or before the stamp, else the first after it."""
        if not self._infos:
            return None
        after = bisect_right(self._infos, stamp_ns, key=lambda info: info.stamp_ns)
        return self._infos[max(after - 1, 0)]

    def forget_before(self, stamp_ns: int) -> None:
        """Drop all before the one in force at the stamp."""
        after = bisect_right(self._infos, stamp_ns, key=lambda info: info.stamp_ns)
        del self._infos[: max(after - 1, 0)]

    def restart(self) -> None:
        """Keep the last one alone, for whatever stamp: it may have been latched."""
        self._infos = [replace(info, stamp_ns=ANY_TIME) for info in self._infos[-1:]]
