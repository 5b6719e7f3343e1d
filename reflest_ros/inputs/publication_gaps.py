# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Messages that a publisher numbered and that never came."""

from __future__ import annotations


class PublicationGaps:
    """Counts what is missing between the messages of a topic's only publisher.

    The middleware's own event for lost messages is not used: with rmw_fastrtps before
    https://github.com/ros2/rmw_fastrtps/pull/890 taking it can lock up the whole process.
    """

    def __init__(self) -> None:
        self._last: int | None = None

    def lost_before(self, number: int | None) -> int:
        """How many are missing before the message of this number.

        ``number``: the publisher's own count, or None where the middleware has none. A number that
        is not above the last is of a publisher that began anew.
        """
        last, self._last = self._last, number
        if number is None or last is None:
            return 0
        return max(number - last - 1, 0)
