# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The estimator node: a managed (lifecycle) node that holds one scan session."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.service import Service

from reflest_core.errors import ReflestError
from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.diagnostics import Diagnostics
from reflest_ros.node_name import NODE_NAME
from reflest_ros.parameters import (
    declare_parameters,
    guard_parameters,
    warn_of_unknown_parameters,
)
from reflest_ros.scan_session import ScanSession
from reflest_ros.services.pause_services import PauseServices


class EstimatorNode(LifecycleNode):
    """Configure loads and allocates, activate subscribes, deactivate pauses, cleanup frees.

    Raises :class:`ReflestError` where a parameter cannot be used.
    """

    def __init__(self) -> None:
        super().__init__(NODE_NAME)
        self.has_crashed = threading.Event()
        self._session: ScanSession | None = None
        self._failure: ReflestError | None = None
        self._node_settings, self._settings = declare_parameters(self)
        warn_of_unknown_parameters(self)
        guard_parameters(self, self._apply)
        PauseServices(self, self._is_active, lambda: self._failure)
        self._diagnostics = Diagnostics(self, self._node_settings.input)
        # Diagnostics go on where simulated time stands still.
        self.create_timer(
            self._node_settings.input.diagnostics_period,
            self._diagnostics.publish,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def bring_up(self) -> None:
        """Configure and activate, where ``lifecycle.autostart`` says so; before the node spins.

        Raises :class:`ReflestError` with the reason why that failed.
        """
        if not self._node_settings.lifecycle.autostart:
            self.get_logger().info("waiting to be configured (lifecycle.autostart is false)")
            return
        for trigger in (self.trigger_configure, self.trigger_activate):
            trigger()
            if self._failure is not None:
                raise self._failure
            if self.has_crashed.is_set():
                return

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Load the weights, compile and allocate; services appear."""
        return self._transition(self._configure)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Subscribe."""
        return self._transition(self._activate)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Unsubscribe; the scan stays, and the services answer on."""
        return self._transition(self._deactivate)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Free the scan and the weights; services go."""
        return self._transition(self._close)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Free whatever is held."""
        return self._transition(self._close)

    @property
    def services_offered(self) -> list[Service[Any, Any]]:
        """Every service under this node's name, also those of its hidden helper."""
        waiting = [] if self._session is None else self._session.waiting_services.services
        return [*self.services, *waiting]

    def crash(self, error: BaseException) -> None:
        """Report what should not happen in one of the threads; the process then ends."""
        trace = "".join(traceback.format_exception(error))
        self.get_logger().fatal(f"stopping, for this should not happen: {trace}")
        self.has_crashed.set()

    def destroy_node(self) -> None:
        """End the threads, then the node."""
        self._close()
        super().destroy_node()

    def _transition(self, work: Callable[[], Any]) -> TransitionCallbackReturn:
        """Run ``work``; a user's mistake fails the transition, one of ours ends the node."""
        self._failure = None
        try:
            work()
        except ReflestError as error:
            self._failure = error
            if self.executor is not None:  # before it spins, bring_up raises the error
                self.get_logger().error(str(error))
            return TransitionCallbackReturn.FAILURE
        except Exception as error:  # rclpy would swallow it
            self.crash(error)
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _configure(self) -> None:
        self.get_logger().info(
            "starting (the first time after installation this compiles for a minute)"
        )
        self._session = ScanSession(self, self._node_settings, self._settings, self.crash)
        self._diagnostics.watch(self._session)

    def _activate(self) -> None:
        session = self._configured
        session.activate()
        self.get_logger().info(
            f"listening to {', '.join(session.inputs.topics.values())}; publishing "
            f"{session.output.topic} ({session.scanner.estimator.predictor.model_id})"
        )

    def _deactivate(self) -> None:
        self._configured.deactivate()
        self.get_logger().info("paused: the scan is kept")

    def _close(self) -> None:
        session, self._session = self._session, None
        if session is not None:
            self._diagnostics.watch(None)
            session.close()

    def _is_active(self) -> bool | None:
        return None if self._session is None else self._session.is_active

    @property
    def _configured(self) -> ScanSession:
        if self._session is None:
            raise ReflestError("the node is not configured")
        return self._session

    def _apply(self, settings: ReflestSettings) -> None:
        """Take changed live parameters; the structural ones are read-only."""
        if self._session is not None:
            self._session.apply(settings)
        self._settings = settings
