# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Messages that a publisher numbered and that never came."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

FASTEST = 1000.0
"""Messages a second: a gap that would need more is a number of another publisher."""


class PublicationGaps:
    """Counts what is missing between the messages of a topic's only publisher.

    The middleware's own event for lost messages is not used: with rmw_fastrtps before
    https://github.com/ros2/rmw_fastrtps/pull/890 taking it can lock up the whole process. Neither
    does rclpy say which publisher sent a message. So a number counts only where one publisher can
    have counted so far since the last message.
    """

    def __init__(self) -> None:
        """Begin without a message."""
        self._last: tuple[int, float] | None = None

    def begin(self) -> None:
        """Compare no number with earlier ones: publishers have come or gone."""
        self._last = None

    def lost_before(self, number: int | None, now: float, publishers: int) -> int:
        """Count the messages that are missing before a message.

        Args:
            number: The publisher's own count, or None where the middleware has none.
            now: When the message came, seconds.
            publishers: Publishers of the topic; the numbers of several are not compared.

        Returns:
            The number of missing messages; 0 where the publisher is new or another one.
        """
        last = self._last
        self._last = None if number is None or publishers != 1 else (number, now)
        if number is None or last is None or publishers != 1:
            return 0
        lost = number - last[0] - 1
        return lost if 0 < lost <= FASTEST * (now - last[1]) else 0


def with_message_info(callback: Callable[[Any, dict[str, Any]], None]) -> Callable[..., None]:
    """Let a callback with message and info be called by each of rclpy's executors.

    ``EventsExecutor`` of rclpy 7.1 passes both as one tuple, the other executors pass two
    arguments. The signature stays, for rclpy sees by it that the callback wants the info.

    Args:
        callback: Takes a message and its info.

    Returns:
        The callback for a subscription.
    """

    @functools.wraps(callback)
    def call(*arguments: Any) -> None:
        message, info = arguments if len(arguments) == 2 else arguments[0]
        callback(message, info)

    return call
