# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Saves the scan regularly, so that a node that is killed continues where it was."""

from __future__ import annotations

import contextlib
import fcntl
import math
import os
import time
from concurrent.futures import Future
from pathlib import Path

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.timer import Timer

from reflest_core.errors import ReflestError
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.fusion.scan_file import DamagedScanError, ScanFileError
from reflest_ros.settings import AutosaveSettings
from reflest_ros.workers.fusion_worker import FusionWorker


class AutosaveError(ReflestError):
    """The file of the parameter autosave.path cannot be used."""


class Autosave:
    """Keeps one file up to date with the scan; without a path, does nothing.

    Attributes:
        path: The file, or None.
        saved_at: When it was last written, ``time.monotonic``; NaN before.
        duration: Seconds that this took.
        failure: Why the last attempt failed, "" where it did not.
    """

    def __init__(self, node: Node, settings: AutosaveSettings, scanner: Pipeline) -> None:
        """Check that the file can be used, and lock it against other nodes.

        Args:
            node: Its timer saves.
            settings: The file and the period.
            scanner: The scan.

        Raises:
            AutosaveError: Another node uses the file, or it could never be written.
        """
        self.path = Path(settings.path).expanduser() if settings.path else None
        self.saved_at = math.nan
        self.duration = math.nan
        self.failure = ""
        self._node = node
        self._log = node.get_logger()
        self._period = settings.period
        self._scanner = scanner
        self._timer: Timer | None = None
        self._lock: int | None = None
        if self.path is not None:
            _check(self.path)
            self._lock = _lock(self.path)
        self._saved = self._state

    def resume(self) -> bool:
        """Continue the scan in the file, where there is one.

        The scan keeps the region of interest and the fusion settings that it was begun with. A
        scan that is damaged is renamed, and a new one begins; any other file stays as it is.

        Returns:
            Whether a scan was loaded.

        Raises:
            AutosaveError: The file is not a scan, or cannot be read or renamed.
        """
        if self.path is None:
            return False
        try:
            if not self._load(self.path):
                return False
        except (OSError, ScanFileError) as error:
            raise AutosaveError(f"autosave.path = {self.path} cannot be used: {error}") from error
        self._saved = self._state
        scan = self._scanner.scan
        self._log.info(
            f"resumed the scan in {self.path}: {scan.voxel_count} voxels, {scan.view_count} views, "
            f"region of interest {scan.region_settings.shape}, voxels of {scan.fusion.voxel_size} m"
        )
        return True

    def start(self, fusion: FusionWorker) -> None:
        """Save every period, between two frames.

        Args:
            fusion: Its thread saves.
        """
        if self.path is None:
            return
        last: Future[None] | None = None

        def on_time() -> None:
            nonlocal last
            if last is None or last.done():
                last = fusion.call_now(self.save)

        self._timer = self._node.create_timer(
            self._period, on_time, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def stop(self) -> None:
        """Save a last time and unlock the file; the fusion thread must have ended."""
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None
        self.save()
        self.unlock()

    def unlock(self) -> None:
        """Let other nodes use the file."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def save(self) -> None:
        """Write the file if the scan has changed; a failure is logged once and shown."""
        state = self._state
        if self.path is None or state == self._saved:
            return
        started = time.monotonic()
        try:
            self._scanner.save(self.path)
        except (ReflestError, OSError) as error:
            if not self.failure:
                self._log.warning(f"the scan continues without autosave: {error}")
            self.failure = str(error)
            return
        self.failure = ""
        self._saved = state
        self.saved_at = time.monotonic()
        self.duration = self.saved_at - started

    def _load(self, path: Path) -> bool:
        # What a process that was killed while it wrote has left; the lock says that it is gone.
        target = path.resolve()
        for partial in target.parent.glob(f".{target.name}.*.partial"):
            with contextlib.suppress(OSError):
                partial.unlink()
        if not path.exists():
            return False
        try:
            self._scanner.load(path)
        except DamagedScanError as error:
            aside = target.with_name(f"{target.name}.damaged-{time.strftime('%Y%m%d-%H%M%S')}")
            target.rename(aside)
            self._log.warning(f"a new scan begins: {error} (it is kept as {aside})")
            return False
        return True

    @property
    def _state(self) -> tuple[int, int, int | None]:
        """Differs where the scan differs."""
        scan = self._scanner.scan
        return id(scan), scan.frame_number, scan.last_stamp_ns


def _check(path: Path) -> None:
    """Refuse what could never be the file of a scan."""
    try:
        if not path.parent.is_dir():
            raise AutosaveError(
                f"autosave.path = {path}: there is no folder {path.parent}: make it"
            )
        if path.exists() and not path.is_file():
            kind = "a folder" if path.is_dir() else "not a regular file"
            raise AutosaveError(f"autosave.path = {path} is {kind}: name a file")
        if not os.access(path.resolve().parent, os.W_OK):
            raise AutosaveError(f"autosave.path = {path}: its folder cannot be written")
    except (OSError, ValueError) as error:
        raise AutosaveError(f"autosave.path = {path} cannot be used: {error}") from None


def _lock(path: Path) -> int:
    """Lock an empty file beside the autosave's, which stays; the lock ends with the process."""
    target = path.resolve()
    lock = target.with_name(f".{target.name}.lock")
    try:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    except OSError as error:
        raise AutosaveError(f"autosave.path = {path} cannot be locked: {error}") from None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise AutosaveError(
            f"autosave.path = {path} is used by another node: give each node its own file"
        ) from None
    return descriptor
