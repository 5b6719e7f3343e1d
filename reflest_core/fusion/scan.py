# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan: frames go in, the observed surface comes out (paper, Sec. 3.1)."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.errors import ReflestError
from reflest_core.fusion.frames.background_light import background_pixels
from reflest_core.fusion.frames.foreground import classify_pixels
from reflest_core.fusion.frames.object_in_sight import KnownObject
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.frames.visibility import visible_voxels
from reflest_core.fusion.frames.window import cropped, object_window
from reflest_core.fusion.fused_frame import FusedFrame
from reflest_core.fusion.memory_budget import MemoryBudget
from reflest_core.fusion.observations.colour_statistics import foreground_background_means
from reflest_core.fusion.observations.observation_chunks import ChunkPool
from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.redundancy import WELL_KNOWN_SHARE, known_frame
from reflest_core.fusion.observations.surface_exposure import surface_shifts
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.scan_file import ScanFileError, read_scan, restore_rows, write_scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.snapshot import MOST_VOXELS, observed_surface
from reflest_core.fusion.tsdf.volume import TsdfVolume
from reflest_core.light.exposure_gain import may_share_view
from reflest_core.light.light_map import LightMap
from reflest_core.surface.observed_surface import ObservedSurface

NEW_SURFACE_SHARE = 0.2
"""A frame near a stored view is a new view if more than this share of what it sees is new."""


class MemoryBudgetError(ReflestError):
    """The machine cannot give what ``memory_budget_mb`` asks for."""


class Scan:
    """TSDF volume, voxel observation store and views of one scanned object.

    ``frame_id``, ``world_frame_id``: the camera's and the world frame's name in the last fused
    frame. Not thread-safe: fuse and snapshot from one thread. A snapshot is a copy, for any thread.
    """

    def __init__(self, fusion: FusionSettings, region: RegionSettings) -> None:
        self.fusion = fusion
        self.set_region(region)

    def reset(self) -> None:
        """Forget everything that was scanned."""
        budget = MemoryBudget.from_settings(self.fusion)
        try:
            self.volume = TsdfVolume(self.fusion.voxel_size, self.fusion.truncation, budget.blocks)
            self.store = ObservationStore(
                budget.voxels, budget.chunks, self.fusion.observations_per_voxel
            )
        except MemoryError:
            raise MemoryBudgetError(
                f"memory_budget_mb = {self.fusion.memory_budget_mb:g} MB is more than this machine "
                "can give: lower it"
            ) from None
        self.views = ViewTable(budget.views)
        self.light = LightMap()
        self.frame_number = 0
        self.last_stamp_ns: int | None = None
        self.frame_id = ""
        self.world_frame_id = ""
        self._clock_ns: int | None = None

    def set_region(self, region: RegionSettings) -> None:
        """Begin a scan of another region.

        What was scanned is forgotten: F and B of the stored views belong to the old region.
        """
        self.region_settings = region
        self.region = Region.from_settings(region)
        self.reset()

    def restart_clock(self) -> None:
        """Take any stamp next, as after a clock jump; what was scanned stays."""
        self._clock_ns = None

    def fuse(self, frame: Frame) -> FusedFrame:
        """Take a frame in; of one that looks away from the object, the light alone.

        Raises :class:`FrameRefused` (``TIME_BACKWARDS``, ``DEPTH_EMPTY``, ``NO_OVERLAP``) before
        anything has changed.
        """
        if self._clock_ns is not None and frame.stamp_ns <= self._clock_ns:
            raise FrameRefused(
                RefusalCause.TIME_BACKWARDS,
                f"the image stamp {frame.stamp_ns} ns is not after the last fused one "
                f"({self._clock_ns} ns): reset the scan if the clock or the bag was restarted",
            )
        whole, window = frame, object_window(frame, self.region)
        frame = cropped(whole, window)
        pixels = classify_pixels(frame, self.region, self.fusion)
        shows_object = bool(np.any(pixels.surface))
        if not shows_object and not self._looks_away(whole):
            raise self._refusal(whole)
        is_foreground = np.zeros(whole.depth.shape, np.bool_)
        is_foreground[window.slices] = pixels.foreground
        self.last_stamp_ns = self._clock_ns = frame.stamp_ns
        self.frame_id, self.world_frame_id = frame.frame_id, frame.world_frame_id
        if not shows_object:
            return self._fuse_light(whole)
        foreground, background = foreground_background_means(whole.rgb, is_foreground)
        known = known_frame(
            frame, pixels, self.store, self.views, self.fusion.voxel_size, self.fusion.view_spacing
        )
        if known is not None and self.views.frames[known.view] >= self.fusion.frames_per_view:
            return FusedFrame(
                frame.stamp_ns,
                frame.frame_id,
                known.view,
                False,
                True,
                foreground,
                background,
                0,
                0,
                0,
                0,
                0,
            )
        self.frame_number += 1

        # The surface: fuse the depth, then renew what the store knows of the blocks it changed.
        threads = self.fusion.threads
        near, erased = self.volume.allocate(frame, pixels, self.frame_number)
        self.store.remove(erased)
        in_sight = self.volume.in_sight(near, frame, self.fusion.max_depth, self.frame_number)
        changed = self.volume.integrate(in_sight, frame, pixels, self.frame_number, threads)
        if known is not None and known.share >= WELL_KNOWN_SHARE:
            self.views.frames[known.view] += 1
            return FusedFrame(
                frame.stamp_ns,
                frame.frame_id,
                known.view,
                False,
                False,
                foreground,
                background,
                len(in_sight),
                len(changed),
                0,
                0,
                0,
            )
        surface = self.volume.extract(changed, threads)
        self.store.move(surface.left, surface.left_to)
        stored = self.store.find(surface.keys, threads)
        self.store.refresh(stored, surface.positions, surface.normals, threads)

        # The observations: a row for each voxel that this view truly sees, then its colour.
        seen, colours = visible_voxels(
            surface.positions, surface.normals, frame, pixels, self.fusion, threads
        )
        positions = surface.positions[seen]
        rows = self.store.claim(
            surface.keys[seen], stored[seen], positions, surface.normals[seen], self.frame_number
        )
        has_row = rows >= 0
        rows, colours, positions = rows[has_row], colours[has_row], positions[has_row]

        # The light: the background's colours, in the directions in which the object sees them.
        if len(surface.positions):
            centre = surface.positions.mean(axis=0, dtype=np.float64)
            radius = float(np.sqrt(surface.positions.var(axis=0, dtype=np.float64).sum()))
            self.light.add_frame(
                *background_pixels(whole, is_foreground, whole.depth, centre, radius),
                lambda: surface_shifts(self.store, self.views, rows, colours, frame.camera_centre),
            )
        view, is_new_view, kept = None, False, 0
        if len(rows):
            near = self.views.near(
                frame.camera_centre,
                positions.mean(axis=0, dtype=np.float64),
                self.fusion.view_spacing,
            )
            unseen = self.store.unseen_from(rows, near, threads)
            is_new_view = (
                len(near) == 0
                or bool(unseen.mean() > NEW_SURFACE_SHARE)
                or not may_share_view(self.light.gain, float(self.views.gains[near[0]]))
            )
            view = self._add_view(frame, foreground, background) if is_new_view else int(near[0])
            self.views.frames[view] += 1
            kept = self.store.observe(rows[unseen], colours[unseen], view, self.views.centres)
        return FusedFrame(
            frame.stamp_ns,
            frame.frame_id,
            view,
            is_new_view,
            False,
            foreground,
            background,
            len(in_sight),
            len(changed),
            len(surface.keys),
            len(seen),
            kept,
        )

    def _fuse_light(self, frame: Frame) -> FusedFrame:
        """Keep what a frame beside the object shows of the light that falls on it."""
        nothing = np.zeros(frame.depth.shape, np.bool_)
        known = self._known_object()
        self.light.add_frame(
            *background_pixels(frame, nothing, frame.depth, known.centre, known.radius)
        )
        return FusedFrame(
            frame.stamp_ns,
            frame.frame_id,
            None,
            False,
            False,
            *foreground_background_means(frame.rgb, nothing),
            0,
            0,
            0,
            0,
            0,
            is_light_alone=True,
        )

    def snapshot(self, most_voxels: int = MOST_VOXELS) -> ObservedSurface:
        """Copy what has been observed.

        Args:
            most_voxels: A larger surface is thinned evenly to so many voxels.

        Returns:
            The surface with its light, for use from any thread.
        """
        surface = observed_surface(self.store, self.views, self.fusion.threads, most_voxels)
        return dataclasses.replace(surface, light=self.light.observed())

    def save(self, path: Path | str) -> None:
        """Write the scan to one file, replacing it whole or not at all."""
        header = {
            "fusion": dataclasses.asdict(self.fusion),
            "region": dataclasses.asdict(self.region_settings),
            "frame_number": self.frame_number,
            "last_stamp_ns": self.last_stamp_ns,
            "frame_id": self.frame_id,
            "world_frame_id": self.world_frame_id,
            "exposure_gain": self.light.gain,
        }
        arrays = {
            f"{part}_{name}": array[: stage.count]
            for part, stage in self._stages()
            for name, array in stage.arrays.items()
        }
        arrays |= {f"light_{name}": array for name, array in self.light.arrays.items()}
        write_scan(Path(path), header, arrays)

    @classmethod
    def load(cls, path: Path | str) -> Scan:
        """Read a saved scan; it goes on exactly as the saved one would have.

        Raises ``ScanFileError`` for a file that is missing, damaged or of another version.
        """
        header, arrays = read_scan(Path(path))
        try:
            scan = cls(
                FusionSettings(**header["fusion"]),
                RegionSettings(
                    header["region"]["shape"],
                    tuple(header["region"]["centre"]),
                    tuple(header["region"]["size"]),
                ),
            )
            counts = {
                part: restore_rows(f"{part}_", stage.arrays, arrays)
                for part, stage in scan._stages()
            }
            restore_rows("light_", scan.light.arrays, arrays)
            scan.light.gain = float(header["exposure_gain"])
            scan.views.count = counts["views"]
            scan.volume.restore(counts["volume"])
            scan.store.restore(counts["store"], counts["chunks"], counts["views"])
            scan.frame_number = int(header["frame_number"])
            stamp_ns = header["last_stamp_ns"]
            scan.last_stamp_ns = None if stamp_ns is None else int(stamp_ns)
            scan.frame_id = str(header.get("frame_id", ""))
            scan.world_frame_id = str(header.get("world_frame_id", ""))
            scan._clock_ns = scan.last_stamp_ns
        except (KeyError, TypeError, ValueError) as error:
            raise ScanFileError(f"{path} is a damaged scan file: {error}: save it again") from None
        return scan

    @property
    def voxel_count(self) -> int:
        """Surface voxels in the store."""
        return self.store.count

    @property
    def observation_count(self) -> int:
        """Observations in the store."""
        return self.store.observation_count

    @property
    def view_count(self) -> int:
        """Stored views."""
        return self.views.stored

    @property
    def nbytes(self) -> int:
        """Bytes reserved by volume, store, views and light; at most ``memory_budget_mb``."""
        return self.volume.nbytes + self.store.nbytes + self.views.nbytes + self.light.nbytes

    @property
    def fill(self) -> float:
        """Share of the fullest of volume, store and views; near 1, old voxels give way to new."""
        return max(
            self.volume.count / self.volume.capacity,
            self.store.count / self.store.capacity,
            self.store.pool.taken / self.store.pool.capacity,
            self.views.stored / self.views.capacity,
        )

    def _stages(
        self,
    ) -> tuple[tuple[str, TsdfVolume | ObservationStore | ChunkPool | ViewTable], ...]:
        return (
            ("volume", self.volume),
            ("store", self.store),
            ("chunks", self.store.pool),
            ("views", self.views),
        )

    def _looks_away(self, frame: Frame) -> bool:
        """Whether an object is known by now, and the frame shows what lies beside it."""
        return self.store.count > 0 and not self._known_object().is_in_sight(frame)

    def _known_object(self) -> KnownObject:
        return KnownObject.of(self.store.rows.positions[: self.store.count])

    def _refusal(self, frame: Frame) -> FrameRefused:
        """Why a frame without a pixel of the object is of no use."""
        if _has_depth(frame):
            return FrameRefused(RefusalCause.NO_OVERLAP, self._no_overlap_sentence(frame))
        return FrameRefused(
            RefusalCause.DEPTH_EMPTY,
            f"{frame.depth_source} at {frame.stamp_ns / 1e9:.3f} s has no valid pixel: move the "
            "camera into its depth range, or check the depth topic's encoding and unit",
        )

    def _no_overlap_sentence(self, frame: Frame) -> str:
        within = f"within max_depth = {self.fusion.max_depth:g} m"
        if frame.mask is not None:
            return f"no pixel of the mask has clear depth {within}: check the mask topic"
        if self.region.shape:
            return (
                f"no depth {within} lies in the region of interest: check the region's centre "
                "and size and the pose's frame"
            )
        return f"no depth lies {within}: raise max_depth or move closer"

    def _add_view(
        self,
        frame: Frame,
        foreground: NDArray[np.float32],
        background: NDArray[np.float32],
    ) -> int:
        if self.views.is_full:
            oldest = self.views.oldest()
            self.store.drop_views(oldest)
            self.views.forget(oldest)
        return self.views.put(
            frame.camera_centre, foreground, background, frame.stamp_ns, self.light.gain
        )


def _has_depth(frame: Frame) -> bool:
    return bool(np.any(np.isfinite(frame.depth) & (frame.depth > 0.0)))
