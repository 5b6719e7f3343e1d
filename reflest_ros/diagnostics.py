"""What the node says about itself on ``/diagnostics``."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from reflest_core.capture.refusal import RefusalLog
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_ros.estimation_worker import EstimationWorker
from reflest_ros.fusion_worker import FusionWorker
from reflest_ros.silence import SilenceWatch


@dataclass
class EstimateCounts:
    """What became of the keyframes; written by the node, read here."""

    published: int = 0
    failed: int = 0
    last_failure: str = ""
    last_latency: float = math.nan
    last_time: float = field(default=math.nan)

    def published_one(self, estimate: BrdfEstimate) -> None:
        """Count an estimate that was published now."""
        self.published += 1
        self.last_latency = estimate.latency
        self.last_time = time.monotonic()


class Diagnostics:
    """Publishes one status each period: counts, refusals by cause, store against budget."""

    def __init__(
        self,
        node: Node,
        fusion: FusionWorker,
        estimation: EstimationWorker,
        refusals: RefusalLog,
        estimates: EstimateCounts,
        silence: SilenceWatch,
        budget_mb: float,
    ) -> None:
        self._node = node
        self._fusion = fusion
        self._estimation = estimation
        self._refusals = refusals
        self._estimates = estimates
        self._silence = silence
        self._budget_mb = budget_mb
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)

    def publish(self) -> None:
        """Publish the state as it is now."""
        silent = self._silence.check()
        status = DiagnosticStatus(
            name=f"{self._node.get_name()}: scan",
            hardware_id="reflest",
            values=[KeyValue(key=key, value=value) for key, value in self._values().items()],
        )
        if silent:
            status.level = DiagnosticStatus.WARN
            status.message = f"no messages on {', '.join(silent)}"
        elif self._refusals.counts:
            cause, _ = self._refusals.counts.most_common(1)[0]
            status.level = DiagnosticStatus.WARN
            status.message = self._refusals.first_message[cause]
        else:
            status.level = DiagnosticStatus.OK
            status.message = "scanning"
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(array)

    def _values(self) -> dict[str, str]:
        counts, estimates = self._fusion.counts, self._estimates
        values = {
            f"messages {role.value}": str(number)
            for role, number in counts.messages.items()
            if number > 0
        }
        values |= {
            "frames matched": str(counts.matched),
            "frames fused": str(counts.fused),
            "queue": str(self._fusion.waiting),
            "keyframes": str(counts.keyframes),
            "keyframes skipped": str(self._estimation.skipped),
            "keyframes without an estimate": str(estimates.failed),
            "last reason for no estimate": estimates.last_failure,
            "estimates": str(estimates.published),
            "last estimate's age (s)": f"{time.monotonic() - estimates.last_time:.3f}",
            "last estimate's latency (s)": f"{estimates.last_latency:.3f}",
            "voxels": str(counts.voxels),
            "observations": str(counts.observations),
            "views": str(counts.views),
            "store (MB)": f"{counts.nbytes / 1e6:.1f}",
            "store budget (MB)": f"{self._budget_mb:.1f}",
        }
        # A copy, for the fusion thread may add a cause meanwhile.
        refused = dict(self._refusals.counts)
        return values | {f"refused {cause.value}": str(n) for cause, n in refused.items()}
