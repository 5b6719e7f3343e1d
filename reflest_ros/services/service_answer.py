# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How every service answers: success, and a message that says what was done or why not."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypeVar

from reflest_core.errors import ReflestError


class Answer(Protocol):
    """What every response holds."""

    success: bool
    message: str


AnyAnswer = TypeVar("AnyAnswer", bound=Answer)


def answer_with(response: AnyAnswer, work: Callable[[], str]) -> AnyAnswer:
    """Fill ``response`` with what ``work`` says, or with why it failed, and the time it took."""
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


def given_path(text: str) -> Path:
    """The path that a request names; :class:`ReflestError` where it names none."""
    if not text:
        raise ReflestError("the request's path is empty: name a file on the node's machine")
    return Path(text).expanduser()
