# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Hardware and software of the measuring machine; nothing that names the machine or its user."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import re
import subprocess
from pathlib import Path
from typing import Any

CODE = ("benchmarks", "config", "msg", "reflest_core", "reflest_ros", "srv")
"""What decides on the figures."""
ROOT = Path(__file__).resolve().parents[2]
LIBRARIES = (
    "numpy",
    "numba",
    "opencv-python-headless",
    "torch",
    "open3d-cpu",
    "ros-jazzy-rclpy",
    "ros-jazzy-rmw-fastrtps-cpp",
)


def describe_machine() -> dict[str, Any]:
    """Processor, cores, memory, system, versions and commit."""
    return {
        "cpu": _cpu(),
        "cores": len(os.sched_getaffinity(0)),
        "memory_gb": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "libraries": {name: version for name in LIBRARIES if (version := _version(name))},
        "commit": commit(),
        "load_at_start": round(os.getloadavg()[0], 2),
    }


def stolen_seconds() -> float:
    """Seconds since boot that the hypervisor took from this virtual machine, summed over cores."""
    fields = Path("/proc/stat").read_text().split("\n", 1)[0].split()
    return int(fields[8]) / os.sysconf("SC_CLK_TCK")


def commit() -> str:
    """The checked out commit, with ``+`` where tracked files differ from it."""
    try:
        head = _git("rev-parse", "--short=12", "HEAD")
        changed = _git("status", "--porcelain", "--untracked-files=no", "--", *CODE)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return head + ("+" if changed else "")


def _git(*arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def _cpu() -> str:
    match = re.search(r"model name\s*:\s*(.+)", Path("/proc/cpuinfo").read_text())
    return match.group(1) if match else platform.processor() or "unknown"


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None
