# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The region of interest in the node's parameters."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.parameter import Parameter

from reflest_core.errors import ReflestError
from reflest_core.fusion.settings import RegionSettings


def set_region_parameters(node: Node, region: RegionSettings) -> None:
    """Set the three parameters together; their guard hands a changed region to the scan.

    Raises :class:`ReflestError` with the reason where they are refused.
    """
    result = node.set_parameters_atomically(
        [
            Parameter("region.shape", value=region.shape),
            Parameter("region.centre", value=list(region.centre)),
            Parameter("region.size", value=list(region.size)),
        ]
    )
    if not result.successful:
        raise ReflestError(result.reason)
