# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recorded capture or a saved scan, scanned in a thread while the page shows how far it is."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from reflest_core.capture.capture import Capture
from reflest_core.capture.refusal import CaptureError, FrameRefused
from reflest_core.errors import ReflestError
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.export.errors import ExportError
from reflest_core.fusion.settings import RegionSettings
from reflest_core.viewer.shown_scan import ShownScan
from reflest_core.viewer.source import (
    Keyframe,
    Outcome,
    SourceState,
    ViewerError,
    exported_files,
    saved_files,
)

OpenCapture = Callable[[Pipeline], Capture]
"""Opens the capture from its beginning for a scanner."""

GRACE = 5.0
"""Seconds that a scan gets to end."""


class CaptureSource:
    """Scans a capture from its beginning, again for each region; or shows a saved scan.

    Estimates at keyframes take at most half of the time.
    """

    def __init__(
        self,
        path: Path,
        settings: ReflestSettings,
        open_again: OpenCapture | None,
    ) -> None:
        """Begin to scan.

        Args:
            path: of the capture or the saved scan.
            settings: all parameters.
            open_again: opens the capture; None for a saved scan.

        Raises:
            ReflestError: The file cannot be opened, or a setting is wrong.
        """
        self.name = path.name or str(path)
        self.up = settings.estimation.up
        self._path, self._settings, self._open = path, settings, open_again
        self._stem = re.sub(r"[^A-Za-z0-9_.-]+", "_", path.stem) or "scan"
        self._lock = threading.Lock()
        self._state = SourceState(progress="opening", is_working=True)
        self._done: Pipeline | None = None
        self._stopping, self._thread = threading.Event(), threading.Thread()
        self._begin(settings)

    @property
    def can_rescan(self) -> bool:
        """True for captures."""
        return self._open is not None

    def state(self) -> SourceState:
        """What there is to show now."""
        return self._state

    def set_region(self, centre: tuple[float, float, float], radius: float) -> Outcome:
        """Scan a sphere of the capture, from its beginning.

        Args:
            centre: world frame, metres.
            radius: metres.

        Raises:
            ReflestError: The region is out of range, or a saved scan is shown.
        """
        self._check_capture("another region")
        region = RegionSettings.sphere(centre, radius)
        self._restart(replace(self._settings, region=region))
        return Outcome(f"scanning the sphere of {radius:g} m around the click")

    def reset(self) -> Outcome:
        """Scan the capture from its beginning with the region of the command line.

        Raises:
            ViewerError: A saved scan is shown.
        """
        self._check_capture("a new scan")
        self._restart(self._settings)
        return Outcome("scanning again from the beginning")

    def save(self) -> Outcome:
        """The scan file.

        Raises:
            ReflestError: Not all is scanned yet.
        """
        return saved_files(self._finished(), self._stem)

    def export(self, format_name: str) -> Outcome:
        """The exported surface or light.

        Args:
            format_name: a key of :data:`~reflest_core.viewer.source.FORMATS`.

        Raises:
            ReflestError: Not all is scanned yet, or there is nothing to export.
        """
        scanner, scan = self._finished(), self._state.scan
        if scan is None:
            raise ViewerError(f"there is nothing to export: {self._state.progress}")
        return exported_files(scanner, scan.found, self._stem, format_name)

    def close(self) -> None:
        """End the scan; what takes longer, such as a first compilation, ends with the process."""
        self._end(GRACE)

    def _end(self, patience: float | None) -> None:
        self._stopping.set()
        if self._thread.is_alive():
            self._thread.join(patience)

    def _check_capture(self, wish: str) -> None:
        if self._open is None:
            raise ViewerError(f"{self.name} is a saved scan: open its capture for {wish}")

    def _finished(self) -> Pipeline:
        if self._done is None:
            raise ViewerError("the scan is not finished yet: wait for the end of the capture")
        return self._done

    def _restart(self, settings: ReflestSettings) -> None:
        with self._lock:
            self._end(None)
            self._begin(settings)

    def _begin(self, settings: ReflestSettings) -> None:
        """Open everything now, so that mistakes are reported at once; then scan in a thread."""
        scanner = Pipeline(settings)
        self._done, self._stopping = None, threading.Event()
        if self._open is None:
            scanner.load(self._path)
            work = partial(self._conclude, scanner, ())
        else:
            work = partial(self._scan, self._open(scanner), scanner, self._stopping)
        self._state = SourceState(progress="reading", is_working=True)
        self._thread = threading.Thread(target=self._guarded, args=(work,), daemon=True)
        self._thread.start()

    def _guarded(self, work: Callable[[], None]) -> None:
        try:
            work()
        except (ReflestError, OSError) as error:
            self._state = replace(self._state, progress=str(error), is_working=False)

    def _scan(self, capture: Capture, scanner: Pipeline, stopping: threading.Event) -> None:
        keyframes: list[Keyframe] = []
        fused, free_at = 0, 0.0
        for frame in capture:
            if stopping.is_set():
                return
            try:
                scanned = scanner.fuse(frame)
            except FrameRefused as refusal:
                capture.refuse(refusal)
                continue
            fused += 1
            if scanned.keyframe is not None:
                began, found = time.monotonic(), None
                if began >= free_at:
                    found = self._show(scanner, scanned.keyframe)
                    free_at = 2.0 * time.monotonic() - began
                keyframes.append(Keyframe.of(frame.relative_to(scanner.scan.origin), found))
            share = capture.frames_seen / max(capture.frame_total or 0, capture.frames_seen)
            total = f" of {capture.frame_total}" if capture.frame_total else ""
            self._state = replace(
                self._state,
                keyframes=tuple(keyframes),
                progress=f"frame {capture.frames_seen}{total}, "
                f"{scanner.scan.voxel_count:,} voxels, {scanner.scan.view_count} views",
                share=0.95 * share,
            )
        if not fused:
            reasons = "; ".join(capture.refusals.first_message.values())
            raise CaptureError(f"{self.name} has no usable frame: {reasons or 'it is empty'}")
        if not stopping.is_set():
            self._conclude(scanner, tuple(keyframes))

    def _show(self, scanner: Pipeline, snapshot: KeyframeSnapshot) -> MaterialMap | None:
        try:
            found = scanner.materials(snapshot)
            self._state = replace(self._state, scan=ShownScan.of(scanner.scan, found, self.up))
        except (NoEstimate, ExportError):
            return None
        return found

    def _conclude(self, scanner: Pipeline, keyframes: tuple[Keyframe, ...]) -> None:
        self._state = replace(self._state, progress="estimating from all voxels", share=0.95)
        found = scanner.final_materials()
        scan = ShownScan.of(scanner.scan, found, self.up)
        self._done = scanner
        count = len(found.materials)
        self._state = SourceState(
            scan,
            keyframes,
            f"{count} material{'s' if count != 1 else ''}, {scanner.scan.voxel_count:,} voxels, "
            f"{scanner.scan.view_count} views",
            1.0,
        )
