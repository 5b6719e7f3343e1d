# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Why a frame or a whole capture was not used: a cause that is counted, a sentence that helps."""

from __future__ import annotations

import enum
from collections import Counter

from reflest_core.errors import ReflestError


class CaptureError(ReflestError):
    """A capture cannot be opened, or gives no frame at all."""


class RefusalCause(enum.Enum):
    """The causes by which refused frames and messages are counted."""

    ENCODING = "encoding"
    SIZE = "size"
    TRUNCATED = "truncated"
    CAMERA_INFO_MISSING = "camera_info_missing"
    CAMERA_INFO_INVALID = "camera_info_invalid"
    POSE_INVALID = "pose_invalid"
    POSE_MISSING = "pose_missing"
    DEPTH_MISSING = "depth_missing"
    DEPTH_EMPTY = "depth_empty"
    MASK_MISSING = "mask_missing"
    FRAME_MISMATCH = "frame_mismatch"
    TRANSFORM_MISSING = "transform_missing"
    TRANSFORM_INVALID = "transform_invalid"
    STAMP_INVALID = "stamp_invalid"
    TIME_BACKWARDS = "time_backwards"
    CLOCK_JUMP = "clock_jump"
    NO_OVERLAP = "no_overlap"
    QUEUE_FULL = "queue_full"
    MESSAGE_LOST = "message_lost"
    INTERNAL_ERROR = "internal_error"


class FrameRefused(ReflestError):
    """A frame or message was refused; fusion's state is as it was before."""

    def __init__(self, cause: RefusalCause, message: str, count: int = 1) -> None:
        """Make a refusal.

        Args:
            cause: By which it is counted.
            message: One sentence that says what was wrong and what to change.
            count: Number of messages or frames that were refused at once.
        """
        super().__init__(message)
        self.cause = cause
        self.count = count


class RefusalLog:
    """Counts refusals by cause and keeps the first sentence of each."""

    def __init__(self) -> None:
        self.counts: Counter[RefusalCause] = Counter()
        self.first_message: dict[RefusalCause, str] = {}

    def add(self, refusal: FrameRefused) -> bool:
        """Count ``refusal``; return True the first time that its cause occurs.

        Args:
            refusal: with its cause and sentence.
        """
        self.counts[refusal.cause] += refusal.count
        is_first = refusal.cause not in self.first_message
        self.first_message.setdefault(refusal.cause, str(refusal))
        return is_first
