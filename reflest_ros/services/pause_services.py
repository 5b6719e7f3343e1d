# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/pause`` and ``~/resume``: deactivate and activate, for those who speak no lifecycle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.lifecycle import LifecycleNode
from std_srvs.srv import Trigger

from reflest_core.errors import ReflestError
from reflest_ros.services.service_answer import answer_with


class PauseServices:
    """They take turns with the lifecycle's own services, in the executor's one thread.

    ``is_active`` says whether the node is active, None while it is not configured. ``failure`` is
    why the last transition failed.
    """

    def __init__(
        self,
        node: LifecycleNode,
        is_active: Callable[[], bool | None],
        failure: Callable[[], ReflestError | None],
    ) -> None:
        self._node = node
        self._is_active = is_active
        self._failure = failure
        node.create_service(Trigger, "~/pause", self.pause)
        node.create_service(Trigger, "~/resume", self.resume)

    def pause(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Stop listening; the scan is kept."""
        return answer_with(
            response, lambda: self._bring(False, self._node.trigger_deactivate, "paused")
        )

    def resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Listen again; the scan goes on."""
        return answer_with(
            response, lambda: self._bring(True, self._node.trigger_activate, "scanning")
        )

    def _bring(self, is_active: bool, trigger: Callable[[], Any], state: str) -> str:
        if self._is_active() is None:
            raise ReflestError("the node is not configured: configure it first")
        if self._is_active() == is_active:
            return f"{state} already"
        trigger()
        if failure := self._failure():
            raise failure
        return state
