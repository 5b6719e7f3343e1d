# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The estimator node: a managed (lifecycle) node that holds one scan session."""

from __future__ import annotations

import contextlib
import threading
import traceback
from collections.abc import Callable, Iterator
from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.service import Service

from reflest_core.errors import ReflestError
from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.diagnostics import Diagnostics
from reflest_ros.parameters import (
    ParameterGuard,
    declare_parameters,
    warn_of_unknown_parameters,
)
from reflest_ros.process import give_back_memory
from reflest_ros.scan_session import ScanSession
from reflest_ros.services.node_services import NodeServices
from reflest_ros.services.pause_services import PauseServices
from reflest_ros.settings import NODE_NAME, NodeSettings

BUSY_AFTER = 0.8
"""Seconds that a change of the node waits for another one before it is refused."""


class TransitionError(ReflestError):
    """The node is not in a state from which the transition leads."""


class EstimatorNode(LifecycleNode):
    """Configure loads and allocates, activate subscribes, deactivate pauses, cleanup frees.

    Its services are answered in threads of their own (:class:`NodeServices`), so that it answers
    while it starts, while images come and while it estimates.

    Attributes:
        has_crashed: Set where a thread of the node ended unexpectedly.
    """

    def __init__(self) -> None:
        """Declare parameters and services.

        Raises:
            ReflestError: A parameter cannot be used.
        """
        super().__init__(NODE_NAME)
        self.has_crashed = threading.Event()
        self._session: ScanSession | None = None
        self._failure: ReflestError | None = None
        self._changing = threading.RLock()
        self._node_settings, self._settings = declare_parameters(self)
        warn_of_unknown_parameters(self)
        ParameterGuard(self, self._prepare, lambda: self._session is not None)
        self.offered = NodeServices(self, list(self._services), self._change_state, self.crash)
        PauseServices(self, self.offered.control)
        self.offered.keep()
        self._diagnostics = Diagnostics(self, self._node_settings.input)
        # Diagnostics go on where simulated time stands still.
        self.create_timer(
            self._node_settings.input.diagnostics_period,
            self._diagnostics.publish,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        self.offered.start()

    @property
    def services(self) -> Iterator[Service[Any, Any]]:
        """None for the executor of the messages: :attr:`offered` answers them all."""
        return iter(())

    @property
    def is_active(self) -> bool | None:
        """Whether the node listens; None while it is not configured."""
        session = self._session
        return None if session is None else session.is_active

    def bring_up(self) -> None:
        """Configure and activate, where ``lifecycle.autostart`` says so.

        Raises:
            ReflestError: The reason why that failed.
        """
        if not self._node_settings.lifecycle.autostart:
            self.get_logger().info("waiting to be configured (lifecycle.autostart is false)")
            return
        for transition in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
            self.change(transition)

    def change(self, transition_id: int) -> None:
        """Make a transition.

        Args:
            transition_id: One of ``lifecycle_msgs/msg/Transition``.

        Raises:
            ReflestError: The transition is not possible now, or it failed; with the reason.
        """
        with self._change("another transition is in progress"):
            state = self._state_machine.current_state[1]
            # Public transitions of the state; rclpy raises for any other.
            valid = {one[0]: one[1] for one in self._state_machine.available_transitions}
            trigger = self._triggers.get(transition_id)
            if transition_id not in valid or trigger is None:
                names = ", ".join(valid[one] for one in valid if one in self._triggers) or "none"
                raise TransitionError(
                    f"transition {transition_id} is not possible in the state {state}; possible: "
                    f"{names}"
                )
            self._failure = None
            result = trigger()
            if self._failure is not None:
                raise self._failure
            if result is not TransitionCallbackReturn.SUCCESS:
                raise TransitionError(f"{valid[transition_id]} failed, see the log")

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Load the weights, compile and allocate; services appear.

        Args:
            state: the state that the transition begins in.
        """
        return self._transition(self._configure)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Subscribe.

        Args:
            state: the state that the transition begins in.
        """
        return self._transition(self._activate)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Unsubscribe; the scan is kept, and the services still answer.

        Args:
            state: the state that the transition begins in.
        """
        return self._transition(self._deactivate)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Free the scan and the weights; services go.

        Args:
            state: the state that the transition begins in.
        """
        return self._transition(self._close)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Free whatever is held.

        Args:
            state: the state that the transition begins in.
        """
        return self._transition(self._close)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Free whatever is held after an internal error; the node is unconfigured then.

        Args:
            state: the state that the transition begins in.
        """
        return self._transition(self._close)

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set parameters together; nothing else changes the node meanwhile.

        Args:
            parameter_list: New values.

        Returns:
            Success, or the reason why nothing was set.
        """
        with self._change("the node is busy with a transition"):
            return super().set_parameters_atomically(parameter_list)

    def crash(self, error: BaseException) -> None:
        """Report the unexpected end of a thread; the process then ends.

        Args:
            error: What the thread raised.
        """
        trace = "".join(traceback.format_exception(error))
        self.get_logger().fatal(f"stopping after an internal error, please report it: {trace}")
        self.has_crashed.set()

    def destroy_node(self) -> None:
        """End the threads, then the node."""
        self._close()
        self.offered.stop()
        super().destroy_node()
        # rclpy leaves it to garbage collection; until then the node would be seen by others.
        self._state_machine.destroy_when_not_in_use()

    @property
    def _triggers(self) -> dict[int, Callable[[], TransitionCallbackReturn]]:
        return {
            Transition.TRANSITION_CONFIGURE: self.trigger_configure,
            Transition.TRANSITION_CLEANUP: self.trigger_cleanup,
            Transition.TRANSITION_ACTIVATE: self.trigger_activate,
            Transition.TRANSITION_DEACTIVATE: self.trigger_deactivate,
            Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: self.trigger_shutdown,
            Transition.TRANSITION_INACTIVE_SHUTDOWN: self.trigger_shutdown,
            Transition.TRANSITION_ACTIVE_SHUTDOWN: self.trigger_shutdown,
        }

    @contextlib.contextmanager
    def _change(self, busy: str) -> Iterator[None]:
        """Let one thread at a time change the node; another one is refused after a while."""
        if not self._changing.acquire(timeout=BUSY_AFTER):
            raise TransitionError(f"{busy}: try again")
        try:
            yield
        finally:
            self._changing.release()

    def _change_state(
        self, request: ChangeState.Request, response: ChangeState.Response
    ) -> ChangeState.Response:
        """Make a transition that a client asks for, by its label or its number."""
        transition_id = request.transition.id
        if label := request.transition.label:
            known = {one[1]: one[0] for one in self._state_machine.available_transitions}
            transition_id = known.get(label, -1)
        try:
            self.change(transition_id)
            response.success = True
        except ReflestError as error:
            self.get_logger().error(str(error))
            response.success = False
        return response

    def _transition(self, work: Callable[[], Any]) -> TransitionCallbackReturn:
        """Run ``work``; a user's mistake fails the transition, an internal error cleans up."""
        try:
            work()
        except ReflestError as error:
            self._failure = error
            return TransitionCallbackReturn.FAILURE
        except Exception as error:  # rclpy would not log it
            trace = "".join(traceback.format_exception(error)).rstrip()
            self.get_logger().error(f"internal error, please report it: {trace}")
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _configure(self) -> None:
        self.get_logger().info(
            "starting (the first time after installation this compiles for some minutes)"
        )
        self._diagnostics.phase = "starting: loads the weights and compiles"
        try:
            session = ScanSession(
                self, self._node_settings, self._settings, self.offered, self.crash
            )
        finally:
            self._diagnostics.phase = ""
        self._session = session
        self._diagnostics.watch(session)

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
            self.offered.withdraw()
            del session
            give_back_memory()  # reference cycles hold its arrays, which Python would keep for long

    @property
    def _configured(self) -> ScanSession:
        if self._session is None:
            raise ReflestError("the node is not configured")
        return self._session

    def _prepare(
        self, node_settings: NodeSettings, settings: ReflestSettings
    ) -> Callable[[], None]:
        """Load what changed settings need; return what puts them to use."""
        session = self._session
        apply = session.prepare(settings) if session is not None else lambda: None

        def put_to_use() -> None:
            apply()
            self._node_settings, self._settings = node_settings, settings

        return put_to_use
