# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""All services of the node, sorted by how long an answer may take."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.service import Service

from reflest_ros.services.service_pool import Answer, ServicePool

QUICK_THREADS, CONTROL_THREADS, ESTIMATE_THREADS, WORK_THREADS = 2, 4, 8, 4
"""Services of each kind that are answered at once."""


class NodeServices:
    """Four pools, so that what is slow holds up nothing that is quick.

    Attributes:
        quick: Answers from what is in memory: state, parameters.
        control: Changes the node: transitions, parameters, the scan.
        estimates: Waits for estimates.
        work: Waits for fusion, estimation and disks.
    """

    def __init__(
        self,
        node: Node,
        services: list[Service[Any, Any]],
        change_state: Answer,
        on_crash: Callable[[BaseException], None],
    ) -> None:
        """Adopt the services that every managed node has.

        Args:
            node: The node.
            services: What rclpy made for it.
            change_state: Answers ``~/change_state``.
            on_crash: Called with what ended a pool.
        """
        self.quick = ServicePool(node, "quick services", QUICK_THREADS, on_crash)
        self.control = ServicePool(node, "control services", CONTROL_THREADS, on_crash)
        self.estimates = ServicePool(node, "estimate services", ESTIMATE_THREADS, on_crash)
        self.work = ServicePool(node, "work services", WORK_THREADS, on_crash)
        for service in services:
            if service.srv_type is ChangeState:
                self.control.adopt(service, _not_changed, change_state)
            elif service.srv_type is SetParameters:
                self.control.adopt(service, _none_set, None)
            elif service.srv_type is SetParametersAtomically:
                self.control.adopt(service, _not_set, None)
            else:
                self.quick.adopt(service, _nothing, None)
        self._lasting = {pool: pool.services for pool in self._pools}

    @property
    def all(self) -> list[Service[Any, Any]]:
        """Every service of the node."""
        return [service for pool in self._pools for service in pool.services]

    def keep(self) -> None:
        """Let the services that exist now outlast :meth:`withdraw`."""
        self._lasting = {pool: pool.services for pool in self._pools}

    def withdraw(self) -> None:
        """Take away the services that were created since :meth:`keep`."""
        for pool in self._pools:
            kept = self._lasting[pool]
            pool.withdraw([service for service in pool.services if service not in kept])

    def start(self) -> None:
        """Begin to answer."""
        for pool in self._pools:
            pool.start()

    def stop(self) -> None:
        """End the threads after the current answers."""
        for pool in self._pools:
            pool.stop()

    @property
    def _pools(self) -> tuple[ServicePool, ...]:
        return (self.quick, self.control, self.estimates, self.work)


def _not_changed(_: Any, response: Any, reason: str) -> None:
    response.success = False


def _none_set(request: Any, response: Any, reason: str) -> None:
    """One result for each parameter; those that were set before the error keep theirs."""
    failed = SetParametersResult(successful=False, reason=reason)
    missing = len(request.parameters) - len(response.results)
    response.results = [*response.results, *[failed] * missing]


def _not_set(_: Any, response: Any, reason: str) -> None:
    response.result = SetParametersResult(successful=False, reason=reason)


def _nothing(_: Any, response: Any, reason: str) -> None:
    """These responses hold what is known, which is nothing."""
