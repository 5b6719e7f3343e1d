# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How every service answers: success, and a message that says what was done or why not."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol, TypeVar

from reflest_core.errors import ReflestError


class Response(Protocol):
    """The fields of every response."""

    success: bool
    message: str


AnyResponse = TypeVar("AnyResponse", bound=Response)


def answer_with(response: AnyResponse, work: Callable[[], str]) -> AnyResponse:
    """Do the work of a service and fill in its response.

    Args:
        response: Its ``duration`` in seconds is filled in where it has one.
        work: Returns what was done in one sentence; a :class:`ReflestError` or OSError of it is the
            reason that nothing was.

    Returns:
        The response.
    """
    started = time.monotonic()
    try:
        response.message = work()
        response.success = True
    except (ReflestError, OSError) as error:
        response.message = str(error)
        response.success = False
    if hasattr(response, "duration"):
        response.duration = time.monotonic() - started
    return response
