# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One live run: node and bag player as processes, and the fate of every message."""

from __future__ import annotations

import os
import subprocess
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from benchmarks.live.listener import Listener, LiveRunFailed
from benchmarks.live.message_account import account
from benchmarks.measuring.resident_memory import peak_mb
from benchmarks.scene.table_scene import REGION
from reflest_core.synbrdf.sequences.bag_writer import RGB
from reflest_ros.demo.playback import running
from reflest_ros.process import use_private_domain

START_LIMIT = 240.0
"""Seconds; the first start after installation compiles."""
SETTLE_LIMIT = 120.0
"""Seconds after the bag's end in which the node must be through with it."""
QUIET_DIAGNOSTICS = 3
"""Unchanged diagnostics after which nothing more is coming."""
CHANGING = ("messages", "frames", "keyframes", "estimates", "refused")
"""Beginnings of the diagnostics that stand still when the node is through."""


MATERIALS = "/reflectance/materials"


def measure(bag: str, frames: int, seconds: float, has_viewer: bool = False) -> dict[str, Any]:
    """Play a bag at the speed of its stamps to a node with default settings.

    The region of interest is that of the table scene.

    Args:
        bag: The rosbag2 folder.
        frames: Number of its frames.
        seconds: Its duration.
        has_viewer: Whether ``ros2 run reflest_ros viewer`` runs beside the node, no page open.

    Raises:
        LiveRunFailed: a process ended early or missed its time limit.
    """
    use_private_domain()
    listener = Listener()
    try:
        started = time.monotonic()
        with running(["-m", "reflest_ros.estimator", "--ros-args", *_region()]) as node:
            ready = lambda: _is_alive(node) and listener.has_subscriber(RGB)  # noqa: E731
            listener.listen_until(ready, START_LIMIT, "the estimator's start")
            start_up = time.monotonic() - started
            with ExitStack() as stack:
                if has_viewer:
                    command = ["-m", "reflest_ros.viewer", "--ros-args", "-p", "port:=0"]
                    stack.enter_context(running(command))
                    listener.listen_until(
                        lambda: _is_alive(node) and listener.has_subscriber(MATERIALS),
                        START_LIMIT,
                        "the viewer's start",
                    )
                cpu_before = _cpu_seconds(node.pid)
                _play(Path(bag), listener, node, seconds)
                _wait_until_through(listener, node)
                cores_used = (_cpu_seconds(node.pid) - cpu_before) / seconds
                peak = peak_mb(node.pid)
        if node.returncode != 0:
            raise LiveRunFailed(f"the estimator ended with exit code {node.returncode}")
    finally:
        listener.close()
    return {
        "seconds": seconds,
        "start_up_s": start_up,
        **account(frames, listener.diagnostics, listener.estimates),
        "peak_mb": peak,
        "cores_used": cores_used,
    }


def _region() -> list[str]:
    parameters = {
        "region.shape": REGION.shape,
        "region.centre": list(REGION.centre),
        "region.size": list(REGION.size),
    }
    return [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]


def _play(bag: Path, listener: Listener, node: subprocess.Popen[bytes], seconds: float) -> None:
    with running(["-m", "reflest_ros.bag_player", str(bag)]) as player:
        listener.listen_until(
            lambda: _is_alive(node) and player.poll() is not None,
            2.0 * seconds + START_LIMIT,
            "the end of the bag",
        )
    if player.returncode != 0:
        raise LiveRunFailed(f"the bag player ended with exit code {player.returncode}")


def _wait_until_through(listener: Listener, node: subprocess.Popen[bytes]) -> None:
    """Return once several diagnostics in a row have shown no progress."""
    last: dict[str, str] = {}
    seen = unchanged = 0

    def is_through() -> bool:
        nonlocal last, seen, unchanged
        _is_alive(node)
        if listener.diagnostics_count > seen:
            seen = listener.diagnostics_count
            values = listener.diagnostics
            now = {name: value for name, value in values.items() if name.startswith(CHANGING)}
            unchanged = unchanged + 1 if now == last else 0
            last = now
        return unchanged >= QUIET_DIAGNOSTICS and last != {}

    listener.listen_until(is_through, SETTLE_LIMIT, "the estimate of the last frame")


def _is_alive(process: subprocess.Popen[bytes]) -> bool:
    if process.poll() is not None:
        raise LiveRunFailed(f"the estimator ended with exit code {process.returncode}")
    return True


def _cpu_seconds(pid: int) -> float:
    """Processor time that the process has used so far, all threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
