"""How each topic is received and sent."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

OUTPUT_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
"""The last estimate stays readable for those who subscribe later."""

INPUT_DEPTH = 30
"""Messages that DDS holds for a callback; callbacks only queue, so that few ever wait."""


def input_qos(reliability: str) -> QoSProfile:
    """Quality of service of the inputs; ``reliability`` is best_effort or reliable."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=INPUT_DEPTH,
        reliability=ReliabilityPolicy[reliability.upper()],
        durability=DurabilityPolicy.VOLATILE,
    )
