# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Programs of the package as processes of their own, and what they print."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ENDING = 60.0
"""Seconds in which a process ends by itself."""
PATIENCE = 300.0
"""Seconds after which something is broken: no test waits so long for what works."""


def participants() -> int:
    """Participants of Fast DDS that this process holds, by their threads of events."""
    return sum(_name(task).startswith("dds.ev.") for task in Path("/proc/self/task").iterdir())


def _name(task: Path) -> str:
    """A thread's name; none where it has just ended."""
    try:
        return (task / "comm").read_text()
    except OSError:
        return ""


class OwnProcess:
    """A Python module that runs in a process group of its own; its output is read by line."""

    def __init__(
        self, module: str, arguments: list[str], domain_id: int, extra: dict[str, str]
    ) -> None:
        environment = {**os.environ, **extra, "ROS_DOMAIN_ID": str(domain_id)}
        self.lines: list[str] = []
        self._changed = threading.Condition()
        self._process = subprocess.Popen(
            [sys.executable, "-m", module, *arguments],
            cwd=ROOT,
            env=environment,
            text=True,
            start_new_session=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def output(self) -> str:
        return "".join(self.lines)

    @property
    def resident_mb(self) -> float:
        """Memory that the process holds now, MB of 10^6 bytes."""
        pages = int(Path(f"/proc/{self._process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 1e6

    @property
    def is_running(self) -> bool:
        return self._process.poll() is None

    def lines_with(self, pattern: str) -> list[str]:
        return [line for line in self.lines if re.search(pattern, line)]

    def wait_for_line(self, pattern: str, timeout: float = PATIENCE) -> str:
        """Return the first line that matches; fail with all output otherwise."""
        with self._changed:
            self._changed.wait_for(
                lambda: self.lines_with(pattern) or not self._reader.is_alive(), timeout
            )
        lines = self.lines_with(pattern)
        assert lines, f"no line with {pattern!r} in:\n{self.output}"
        return lines[0]

    def interrupt(self, number: int = signal.SIGINT) -> None:
        os.killpg(self._process.pid, number)

    def exit_code(self, timeout: float = PATIENCE) -> int:
        try:
            code = self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still running after {timeout} s:\n{self.output}") from None
        self._reader.join()
        return code

    def end(self) -> None:
        """Ask it to end, for what is killed leaves its shared memory behind; kill what will not."""
        if self.is_running:
            self.interrupt()
        try:
            self._process.wait(ENDING)
        except subprocess.TimeoutExpired:
            self.interrupt(signal.SIGKILL)
            self._process.wait()
        self._reader.join()

    def _read(self) -> None:
        for line in self._process.stdout:
            with self._changed:
                self.lines.append(line)
                self._changed.notify_all()
        with self._changed:
            self._changed.notify_all()
