# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/pause`` and ``~/resume``: deactivate and activate for clients without the lifecycle types."""

from __future__ import annotations

from typing import Protocol

from lifecycle_msgs.msg import Transition
from std_srvs.srv import Trigger

from reflest_core.errors import ReflestError
from reflest_ros.services.answers import answer_with
from reflest_ros.services.service_pool import ServicePool


class ManagedNode(Protocol):
    """What pausing needs of the node."""

    @property
    def is_active(self) -> bool | None:
        """Whether it is active; None where it is not configured."""

    def change(self, transition_id: int) -> None:
        """Make a transition; raises :class:`ReflestError` with the reason why not.

        Args:
            transition_id: of ``lifecycle_msgs/Transition``.
        """


class PauseServices:
    """Both succeed where the node is in the wanted state already."""

    def __init__(self, node: ManagedNode, pool: ServicePool) -> None:
        """Create the services.

        Args:
            node: The node.
            pool: Answers them.
        """
        self._node = node
        pool.create(Trigger, "~/pause", self.pause)
        pool.create(Trigger, "~/resume", self.resume)

    def pause(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Stop listening; the scan is kept.

        Args:
            _: empty.
            response: to fill in.
        """
        return answer_with(
            response, lambda: self._bring(False, Transition.TRANSITION_DEACTIVATE, "paused")
        )

    def resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Listen again; the scan continues.

        Args:
            _: empty.
            response: to fill in.
        """
        return answer_with(
            response, lambda: self._bring(True, Transition.TRANSITION_ACTIVATE, "scanning")
        )

    def _bring(self, is_active: bool, transition_id: int, state: str) -> str:
        if self._node.is_active is None:
            raise ReflestError("the node is not configured: configure it first")
        if self._node.is_active == is_active:
            return f"{state} already"
        self._node.change(transition_id)
        return state
