# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Services of the node that are answered in threads of their own.

The node's executor has one thread, which must go on receiving images. rclpy's executors with
several threads spend more on every message than fusion does, so they get the services alone.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import Executor, MultiThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_services_default
from rclpy.service import Service
from rclpy.type_support import check_is_valid_srv_type

from reflest_ros.threads import Spinning

Answer = Callable[[Any, Any], Any]
Failed = Callable[[Any, Any, str], None]


class ServicePool:
    """Answers some of a node's services; no exception of theirs ends the process."""

    def __init__(
        self, owner: Node, name: str, threads: int, on_crash: Callable[[BaseException], None]
    ) -> None:
        """Prepare the threads.

        Args:
            owner: The node that offers the services.
            name: Name of the pool's thread.
            threads: Services that are answered at once; at least 2.
            on_crash: Called with what ended the pool.
        """
        self._owner = owner
        self._services: list[Service[Any, Any]] = []
        self._group = ReentrantCallbackGroup()
        executor = MultiThreadedExecutor(threads, context=owner.context)
        executor.add_node(_ServicesAlone(owner, self._services))
        self._spinning = Spinning(executor, name, on_crash)

    @property
    def services(self) -> list[Service[Any, Any]]:
        """The services of this pool."""
        return list(self._services)

    def adopt(self, service: Service[Any, Any], failed: Failed, answer: Answer | None) -> None:
        """Answer a service that rclpy made for the node.

        Args:
            service: It must not be in another executor.
            failed: Fills the response where the callback raised; takes request, response, reason.
            answer: The callback; None: the service's own.
        """
        if answer is None:
            service.callback = self._checked(service, service.callback, failed)
        else:
            service.callback = self._guarded(answer, failed)
        service.callback_group = self._group
        self._group.add_entity(service)
        self._services.append(service)

    def create(self, service_type: type, name: str, answer: Answer) -> None:
        """Offer a service that answers ``success`` and ``message``; each answer is logged.

        Args:
            service_type: A generated service.
            name: Relative to the node, as ``~/save``.
            answer: The callback; its docstring describes the service in ``docs/node.md``.
        """
        full_name = self._owner.resolve_service_name(name)
        qos = qos_profile_services_default
        check_is_valid_srv_type(service_type)
        with self._owner.handle:
            implementation = _rclpy.Service(
                self._owner.handle, service_type, full_name, qos.get_c_qos_profile()
            )
        log = self._owner.get_logger()

        def logged(request: Any, response: Any) -> Any:
            response = answer(request, response)
            if response.success:
                log.info(f"{full_name}: {response.message}")
            else:
                log.warning(f"{full_name} failed: {response.message}")
            return response

        logged.__doc__ = answer.__doc__
        guarded = self._guarded(logged, _fail)
        service = Service(implementation, service_type, full_name, guarded, self._group, qos)
        self._group.add_entity(service)
        self._services.append(service)
        self._spinning.wake()

    def withdraw(self, services: list[Service[Any, Any]]) -> None:
        """Take services away that :meth:`create` made.

        Args:
            services: Some of :attr:`services`.
        """
        for service in services:
            self._services.remove(service)
            service.destroy()
        self._spinning.wake()

    def start(self) -> None:
        """Begin to answer."""
        self._spinning.start()

    def stop(self) -> None:
        """End the threads after the current answers; the services go.

        A service keeps its node's part in the middleware alive. One that were left to garbage
        collection would go on being found by clients, and answer none.
        """
        self._spinning.stop()
        self.withdraw(self.services)

    def _checked(self, service: Service[Any, Any], answer: Answer, failed: Failed) -> Answer:
        """``answer`` of rclpy, whose exceptions are mistakes in the request."""
        log = self._owner.get_logger()

        def call(request: Any, response: Any) -> Any:
            try:
                return answer(request, response)
            except Exception as error:
                log.warning(f"{service.srv_name}: a request cannot be used: {error!r:.200}")
                failed(request, response, f"the request cannot be used: {error!r:.200}")
                return response

        return call

    def _guarded(self, answer: Answer, failed: Failed) -> Answer:
        """``answer``, with every exception made into an answer and an error in the log."""
        log = self._owner.get_logger()

        def call(request: Any, response: Any) -> Any:
            try:
                return answer(request, response)
            except Exception as error:
                log.error("".join(traceback.format_exception(error)).rstrip())
                failed(request, response, f"internal error, please report it: {error!r}")
                return response

        call.__doc__ = answer.__doc__
        return call


class _ServicesAlone:
    """What an executor sees of the node: the services of one pool."""

    subscriptions: tuple[Any, ...] = ()
    timers: tuple[Any, ...] = ()
    clients: tuple[Any, ...] = ()
    guards: tuple[Any, ...] = ()
    waitables: tuple[Any, ...] = ()

    def __init__(self, owner: Node, services: list[Service[Any, Any]]) -> None:
        self.executor: Executor | None = None
        self._owner = owner
        self._services = services

    @property
    def services(self) -> Iterator[Service[Any, Any]]:
        return iter(list(self._services))


def _fail(_: Any, response: Any, reason: str) -> None:
    response.success = False
    response.message = reason
