"""Names the inputs that nothing comes from."""

from __future__ import annotations

import time

from rclpy.node import Node

from reflest_ros.subscriptions import Input


class SilenceWatch:
    """Warns once each time that inputs fall silent, with what is known about their publishers."""

    def __init__(self, node: Node, inputs: list[Input], limit: float) -> None:
        self._node = node
        self._inputs = inputs
        self._limit = limit
        self._silent: set[str] = set()

    def check(self) -> list[str]:
        """Return the topics that are silent now; warn where one has become so."""
        now = time.monotonic()
        silent = [one for one in self._inputs if now - one.last_arrival > self._limit]
        names = {one.topic for one in silent}
        if names - self._silent:
            waits = "; ".join(self._describe(one) for one in silent)
            self._node.get_logger().warning(
                f"no message for {self._limit:g} s on {waits}. Remap the topic, set its name under "
                "topics, or start its publisher"
            )
        self._silent = names
        return sorted(names)

    def _describe(self, one: Input) -> str:
        publishers = self._node.get_publishers_info_by_topic(one.topic)
        if not publishers:
            return f"{one.topic} ({one.role.value}; it has no publisher)"
        offered = ", ".join(sorted({p.qos_profile.reliability.name.lower() for p in publishers}))
        return f"{one.topic} ({one.role.value}; {len(publishers)} publisher(s), {offered})"
