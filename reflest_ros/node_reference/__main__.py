# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m reflest_ros.node_reference > docs/node.md``."""

from __future__ import annotations

import sys

from reflest_core.errors import ReflestError
from reflest_ros.node_reference.live_node import observe_node
from reflest_ros.node_reference.page import page


def main() -> int:
    """Print the page.

    Returns:
        0, or 2 with one sentence where something is not described.
    """
    try:
        print(page(observe_node()), end="")
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
