# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Saves the scan now and then, so that a node that is killed goes on where it was."""

from __future__ import annotations

import math
import time
from concurrent.futures import Future
from pathlib import Path

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.timer import Timer

from reflest_core.errors import ReflestError
from reflest_core.estimation.scanner import Scanner
from reflest_core.fusion.scan_file import ScanFileError
from reflest_ros.settings import AutosaveSettings
from reflest_ros.workers.fusion_worker import FusionWorker


class Autosave:
    """Keeps one file up to date with the scan; without a path, does nothing.

    ``saved_at``: when the file was last written, ``time.monotonic``, NaN before. ``duration``:
    seconds that it took. ``failure``: why the last attempt failed, "" where it did not.

    Raises :class:`ReflestError` where the file could never be written.
    """

    def __init__(self, node: Node, settings: AutosaveSettings, scanner: Scanner) -> None:
        self.path = Path(settings.path).expanduser() if settings.path else None
        self.saved_at = math.nan
        self.duration = math.nan
        self.failure = ""
        self._node = node
        self._log = node.get_logger()
        self._period = settings.period
        self._scanner = scanner
        self._timer: Timer | None = None
        if self.path is not None and not self.path.parent.is_dir():
            raise ReflestError(
                f"autosave.path = {self.path}: there is no folder {self.path.parent}: make it"
            )
        self._saved = self._state

    def resume(self) -> bool:
        """Go on from the file where there is one; one that cannot be read is put aside.

        The scan keeps the region of interest and the fusion settings that it was begun with.
        Raises :class:`ReflestError` where the file system does not let the file be used.
        """
        if self.path is None:
            return False
        try:
            if not self._load(self.path):
                return False
        except OSError as error:
            raise ReflestError(f"autosave.path = {self.path} cannot be used: {error}") from error
        self._saved = self._state
        scan = self._scanner.scan
        self._log.info(
            f"resumed the scan in {self.path}: {scan.voxel_count} voxels, {scan.view_count} views, "
            f"region of interest {scan.region_settings.shape}, voxels of {scan.fusion.voxel_size} m"
        )
        return True

    def _load(self, path: Path) -> bool:
        # What a process that was killed while it wrote has left.
        for partial in path.parent.glob(f".{path.name}.*.partial"):
            partial.unlink(missing_ok=True)
        if not path.exists():
            return False
        try:
            self._scanner.load(path)
        except ScanFileError as error:
            aside = path.with_name(f"{path.name}.unreadable")
            path.replace(aside)
            self._log.warning(f"a new scan begins: {error} (it is kept as {aside})")
            return False
        return True

    def start(self, fusion: FusionWorker) -> None:
        """Save every period, between two frames."""
        if self.path is None:
            return
        last: Future[None] | None = None

        def on_time() -> None:
            nonlocal last
            if last is None or last.done():
                last = fusion.call(self.save)

        self._timer = self._node.create_timer(
            self._period, on_time, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def stop(self) -> None:
        """Save a last time; the fusion thread must have ended."""
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
        self.save()

    def save(self) -> None:
        """Write the file if the scan has changed; a failure is counted and warned of once."""
        state = self._state
        if self.path is None or state == self._saved:
            return
        started = time.monotonic()
        try:
            self._scanner.save(self.path)
        except ReflestError as error:
            if not self.failure:
                self._log.warning(f"the scan goes on without autosave: {error}")
            self.failure = str(error)
            return
        self.failure = ""
        self._saved = state
        self.saved_at = time.monotonic()
        self.duration = self.saved_at - started

    @property
    def _state(self) -> tuple[int, int, int | None]:
        """Differs where the scan differs."""
        scan = self._scanner.scan
        return id(scan), scan.frame_number, scan.last_stamp_ns
