# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Callbacks that are told how a message came, under each of rclpy's executors."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any


def with_message_info(callback: Callable[[Any, dict[str, Any]], None]) -> Callable[..., None]:
    """Let ``callback(message, info)`` be called with both as one tuple, too.

    ``EventsExecutor`` of rclpy 7.1 calls it like that, the other executors with two arguments. The
    signature stays: by it rclpy tells that the callback wants the info.
    """

    @functools.wraps(callback)
    def call(*arguments: Any) -> None:
        message, info = arguments if len(arguments) == 2 else arguments[0]
        callback(message, info)

    return call
