# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The node's status on ``/diagnostics``."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from reflest_core.capture.messages import Role
from reflest_core.capture.refusal import RefusalCause
from reflest_ros.inputs.silence import SilenceWatch
from reflest_ros.scan_session import ScanSession
from reflest_ros.scan_trends import RecentCounts, ScanWarnings
from reflest_ros.settings import InputSettings

WINDOW = 5.0
"""Seconds over which rates are taken, and for which a refusal is news."""


@dataclass
class _Watched:
    """A session with its watches and recent counters."""

    session: ScanSession
    silence: SilenceWatch
    scan: ScanWarnings
    messages: RecentCounts[Role]
    refusals: RecentCounts[RefusalCause]


class Diagnostics:
    """Publishes one status each period: state, rates, refusals by cause, store against budget.

    Attributes:
        phase: What the node is doing while no session is watched; "" where it does nothing.
    """

    def __init__(self, node: Node, settings: InputSettings) -> None:
        """Create the publisher.

        Args:
            node: The node.
            settings: Limits of the warnings.
        """
        self.phase = ""
        self._has_twin = False
        self._node = node
        self._settings = settings
        self._watched: _Watched | None = None
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)

    def watch(self, session: ScanSession | None) -> None:
        """Report on another session from now on.

        Args:
            session: None where the node is not configured.
        """
        self._watched = None
        if session is not None:
            self._watched = _Watched(
                session,
                SilenceWatch(self._node, session.inputs.states, self._settings.silence),
                ScanWarnings(self._node, session.scanner),
                RecentCounts(WINDOW),
                RecentCounts(WINDOW),
            )
            # Rates count from here: a burst may come before the first period ends.
            _sample(self._watched)

    def publish(self) -> None:
        """Publish the state as it is now."""
        watched = self._watched
        status = DiagnosticStatus(
            name=f"{self._node.get_fully_qualified_name()}: scan",
            hardware_id="reflest",
            level=DiagnosticStatus.OK,
        )
        if watched is None:
            status.message = self.phase or "not configured"
        else:
            _sample(watched)
            watched.session.inputs.recheck_qos()
            status.message = "scanning" if watched.session.is_active else "paused"
            if warnings := _warnings(watched):
                status.level = DiagnosticStatus.WARN
                status.message = "; ".join(warnings)
            status.values = [KeyValue(key=k, value=v) for k, v in self._values(watched).items()]
        if twin := self._twin_problem():
            status.level = DiagnosticStatus.WARN
            status.message = f"{twin}; {status.message}"
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(array)

    def _twin_problem(self) -> str:
        """A sentence about another node of the same name, or ""; logged when it appears."""
        own = (self._node.get_name(), self._node.get_namespace())
        problem = ""
        if self._node.get_node_names_and_namespaces().count(own) > 1:
            name = self._node.get_fully_qualified_name()
            problem = (
                f"another node is named {name} too, and either may answer: start one with "
                "another name (-r __node:=NAME) or namespace"
            )
            if not self._has_twin:
                self._node.get_logger().warning(problem)
        self._has_twin = bool(problem)
        return problem

    def _values(self, watched: _Watched) -> dict[str, str]:
        session = watched.session
        counts, estimates = session.fusion.counts, session.output.counts
        values: dict[str, str] = {}
        for one in session.inputs.states:
            role = one.role.value
            values[f"messages {role}"] = str(one.count)
            values[f"rate {role} (Hz)"] = f"{watched.messages.rate(one.role):.2f}"
            if one.qos_problem:
                values[f"incompatible QoS {role}"] = one.qos_problem
        values |= {
            "matched ratio": f"{_matched_ratio(watched):.3f}",
            "frames matched": str(counts.matched),
            "frames fused": str(counts.fused),
            "frames redundant": str(counts.redundant),
            "frames of light alone": str(counts.light_alone),
            "queue": str(session.fusion.waiting),
            "keyframes": str(counts.keyframes),
            "keyframes skipped": str(session.estimation.skipped),
            "discarded keyframes": str(session.estimation.discarded),
            "discarded messages": str(counts.discarded),
            "keyframes without an estimate": str(estimates.failed),
            "last reason for no estimate": estimates.last_failure,
            "estimates": str(estimates.published),
            "last estimate's age (s)": f"{time.monotonic() - estimates.last_time:.3f}",
            "last estimate's latency (s)": f"{estimates.last_latency:.3f}",
            "material maps": str(session.output.materials.published),
            "materials": str(session.output.materials.count),
            "last material map's duration (s)": f"{session.output.materials.duration:.3f}",
            "last reason for no materials": session.output.materials.failure,
            **session.output.materials.details,
            "time of fusion (s)": f"{counts.fusion_seconds:.3f}",
            "depth agreement": f"{session.scanner.poses.agreement:.3f}",
            "colour agreement": f"{session.scanner.poses.colour_agreement:.3f}",
            "edge agreement": f"{session.scanner.poses.edge_agreement:.3f}",
            "warning of colours": session.scanner.poses.warning,
            "pose jumps": str(session.scanner.poses.jumps),
            "voxels": str(counts.voxels),
            "observations": str(counts.observations),
            "views": str(counts.views),
            "store (MB)": f"{counts.nbytes / 1e6:.1f}",
            "store budget (MB)": f"{session.scanner.scan.fusion.memory_budget_mb:.1f}",
            "store in use": f"{counts.fill:.3f}",
            "exposure drift (stops)": f"{counts.exposure_drift:.2f}",
            "exposure correction (stops)": f"{math.log2(counts.exposure_gain):.2f}",
            "light seen": f"{counts.light_seen:.3f}",
        }
        if session.autosave.path is not None:
            values |= {
                "autosave's age (s)": f"{time.monotonic() - session.autosave.saved_at:.3f}",
                "autosave's duration (s)": f"{session.autosave.duration:.3f}",
                "autosave's failure": session.autosave.failure,
            }
        # A copy, for the fusion thread may add a cause meanwhile.
        refused = dict(session.assembler.refusals.counts)
        return values | {f"refused {cause.value}": str(n) for cause, n in refused.items()}


def _sample(watched: _Watched) -> None:
    session, now = watched.session, time.monotonic()
    watched.messages.sample(now, {one.role: one.count for one in session.inputs.states})
    watched.refusals.sample(now, dict(session.assembler.refusals.counts))


def _matched_ratio(watched: _Watched) -> float:
    """Frames matched for each colour image so far; NaN where none came."""
    session = watched.session
    colours = session.fusion.counts.messages[Role.RGB]
    return session.fusion.counts.matched / colours if colours else math.nan


def _warnings(watched: _Watched) -> list[str]:
    """What is wrong now, most basic first."""
    session = watched.session
    warnings = [one.qos_problem for one in session.inputs.states if one.qos_problem]
    if session.is_active and (silence := watched.silence.check()):
        warnings.append(silence)
    refusals = session.assembler.refusals
    warnings += [
        sentence
        for cause, sentence in list(refusals.first_message.items())
        if watched.refusals.increase(cause) > 0
    ]
    warnings += watched.scan.check(session.fusion.counts)
    if session.autosave.failure:
        warnings.append(f"autosave fails: {session.autosave.failure}")
    return warnings
