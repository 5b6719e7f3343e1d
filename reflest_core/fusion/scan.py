# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan: frames go in, the observed surface comes out (paper, Sec. 3.1)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames import sight
from reflest_core.fusion.frames.background_light import background_pixels, sampling_step
from reflest_core.fusion.frames.foreground import classify_pixels
from reflest_core.fusion.frames.region import Region, RegionShape
from reflest_core.fusion.frames.view_middle import view_middle
from reflest_core.fusion.frames.visibility import visible_voxels
from reflest_core.fusion.frames.window import cropped, object_window
from reflest_core.fusion.frames.work_sphere import WorkSphere, without_holes
from reflest_core.fusion.fused_frame import FusedFrame
from reflest_core.fusion.memory_budget import MemoryBudget, MemoryBudgetError
from reflest_core.fusion.observations.colour_statistics import foreground_background_means
from reflest_core.fusion.observations.exposure import surface_shifts
from reflest_core.fusion.observations.observation_chunks import ChunkPool
from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.redundancy import WELL_KNOWN_SHARE, known_frame
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.poses.disagreement import contradicted_blocks
from reflest_core.fusion.scan_check import check_arrays, checked_header
from reflest_core.fusion.scan_file import damaged, read_scan, restore_rows, write_scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.snapshot import MOST_VOXELS, observed_surface
from reflest_core.fusion.tsdf.volume import TsdfVolume
from reflest_core.light.exposure_gain import may_share_view
from reflest_core.light.light_map import LightMap
from reflest_core.surface.material_ids import GivenIds
from reflest_core.surface.observed_surface import ObservedSurface

FAR = 100.0
"""Metres from the origin of the world frame: a scan that begins farther away has an origin of its
own, for float32 holds no hundredths of a millimetre there, and keys of voxels end at 5 km."""
NEW_SURFACE_SHARE = 0.2
"""A frame near a stored view is a new view if more than this share of what it sees is new."""


class Scan:
    """TSDF volume, voxel observations, views and light of one scan.

    Not thread-safe: fuse and snapshot from one thread. A snapshot is a copy, for any thread.

    Attributes:
        fusion: Settings.
        region_settings: The region of interest, world frame.
        origin: (3,) float64, of the scan's own coordinates in the world frame, metres: 0, or near
            the first camera where that is far away. Everything below is in the scan's coordinates.
        volume: The TSDF.
        store: The observations of voxels.
        views: The stored views.
        light: What the background showed.
        work_sphere: What is scanned where there is no region.
        middle: (3,) float64, the surface point in the middle of the last view; None before the
            first one, and where a region or a mask says what is looked at.
        frame_number: Frames fused.
        unchecked_until: Number of the last frame before a jump of the tracker: surface that was
            last seen up to then is dropped where later frames contradict it; -1 without a jump.
        last_stamp_ns: Stamp of the last one, None before the first.
        frame_id: The camera's frame of the last one.
        world_frame_id: The world frame of the last one.
    """

    def __init__(self, fusion: FusionSettings, region: RegionSettings) -> None:
        """Begin an empty scan.

        Args:
            fusion: Settings.
            region: The region of interest.

        Raises:
            MemoryBudgetError: The machine cannot give what ``memory_budget_mb`` asks for.
        """
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
            raise MemoryBudgetError.of(self.fusion) from None
        self.views = ViewTable(budget.views)
        self.light = LightMap()
        self.work_sphere, self.material_ids = WorkSphere(), GivenIds()
        self.middle: NDArray[np.float64] | None = None
        self._set_origin(np.zeros(3))
        self.frame_number, self.unchecked_until = 0, -1
        self.last_stamp_ns: int | None = None
        self.frame_id, self.world_frame_id = "", ""
        self._clock_ns: int | None = None

    def set_region(self, region: RegionSettings) -> None:
        """Begin a scan of another region.

        What was scanned is forgotten: F and B of the stored views belong to the old region.

        Args:
            region: The region of interest.
        """
        self.region_settings = region
        self.reset()

    def restart_clock(self) -> None:
        """Take any stamp next, as after a clock jump; what was scanned stays."""
        self._clock_ns = None

    def fuse(self, frame: Frame) -> FusedFrame:
        """Take a frame in; of one that looks away from the scanned surface, the light alone.

        Args:
            frame: A frame whose stamp is after that of the last one.

        Returns:
            What became of the frame.

        Raises:
            FrameRefused: ``TIME_BACKWARDS``, ``POSE_INVALID``, ``DEPTH_EMPTY`` or ``NO_OVERLAP``;
                nothing has changed.
        """
        sight.check_stamp(frame, self._clock_ns)
        if self.frame_number == 0:
            self._set_origin(_origin_near(frame.camera_centre))
        frame = frame.relative_to(self.origin)
        sight.check_reach(frame, self.fusion)
        whole, sphere, region = frame, self.work_sphere, self.region
        if self._is_scene(frame):
            sphere = sphere.updated(frame, self.fusion)
            region = sphere.region(self.fusion)
        window = object_window(frame, region)
        frame = cropped(whole, window)
        pixels = classify_pixels(frame, region, self.fusion)
        shows_surface = pixels.farthest > 0.0
        if not shows_surface and not self._looks_away(whole):
            radius = self.work_sphere.radius(self.fusion) if self.work_sphere.frames else 0.0
            raise sight.refusal_without_surface(whole, self.region, self.fusion, radius)
        is_foreground = np.zeros(whole.depth.shape, np.bool_)
        is_foreground[window.slices] = pixels.foreground
        self.last_stamp_ns = self._clock_ns = frame.stamp_ns
        self.frame_id, self.world_frame_id = frame.frame_id, frame.world_frame_id
        if not shows_surface:
            return self._fuse_light(whole)
        self.work_sphere = sphere
        self.middle = view_middle(whole, self.fusion.max_depth) if self._is_scene(whole) else None
        foreground, background = foreground_background_means(whole.rgb, is_foreground)
        fused = FusedFrame(frame.stamp_ns, frame.frame_id, foreground, background)
        if self.unchecked_until >= 0:
            self._drop_contradicted(frame)
        known = known_frame(
            frame, pixels, self.store, self.views, self.fusion.voxel_size, self.fusion.view_spacing
        )
        if known is not None and self.views.frames[known.view] >= self.fusion.frames_per_view:
            return dataclasses.replace(fused, view=known.view, is_redundant=True)
        self.frame_number += 1
        # The surface: fuse the depth, then renew what the store knows of the blocks it changed.
        threads = self.fusion.threads
        near, erased = self.volume.allocate(frame, pixels, self.frame_number)
        self.store.remove(erased)
        in_sight = self.volume.in_sight(near, frame, self.fusion.max_depth, self.frame_number)
        changed = self.volume.integrate(in_sight, frame, pixels, self.frame_number, threads)
        fused = dataclasses.replace(
            fused, blocks_projected=len(in_sight), blocks_changed=len(changed)
        )
        if known is not None and known.share >= WELL_KNOWN_SHARE:
            self.views.frames[known.view] += 1
            return dataclasses.replace(fused, view=known.view)
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
        if not has_row.all():
            rows, colours, positions = rows[has_row], colours[has_row], positions[has_row]
        if len(surface.positions):
            self._add_light(whole, is_foreground, surface.positions, rows, colours)
        view, is_new_view, kept = None, False, 0
        if len(rows):
            near = self.views.near(
                frame.camera_centre,
                sight.KnownSurface(positions).centre,
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
            kept = self.store.observe(
                rows[unseen], colours[unseen], view, self.views.centres, threads
            )
        return dataclasses.replace(
            fused,
            view=view,
            is_new_view=is_new_view,
            surface_voxels=len(surface.keys),
            voxels_seen=len(seen),
            observations_kept=kept,
        )

    def _set_origin(self, origin: NDArray[np.float64]) -> None:
        self.origin = origin
        self.region = Region.from_settings(self.region_settings).relative_to(origin)

    def check_after_jump(self, frames: Sequence[Frame]) -> None:
        """Drop what frames contradict, now and as further frames come.

        Args:
            frames: Those since the tracker jumped, world frame; they may have been fused already.
        """
        self.unchecked_until = self.frame_number
        for frame in frames:
            self._drop_contradicted(frame.relative_to(self.origin))

    def _drop_contradicted(self, frame: Frame) -> None:
        """Erase blocks that were last seen before a jump and are not where a frame shows them."""
        rows, count = self.store.rows, self.store.count
        old = np.flatnonzero(rows.last_seen[:count] <= self.unchecked_until)
        if not len(old):
            self.unchecked_until = -1
            return
        surface = rows.keys[old], rows.positions[old], rows.normals[old]
        self.store.remove(self.volume.remove(contradicted_blocks(*surface, frame)))

    def _is_scene(self, frame: Frame) -> bool:
        """Whether everything within the work sphere is scanned."""
        return frame.mask is None and self.region.shape is RegionShape.NONE

    def _add_light(
        self,
        frame: Frame,
        is_foreground: NDArray[np.bool_],
        positions: NDArray[np.float32],
        rows: NDArray[np.int64],
        colours: NDArray[np.uint8],
    ) -> None:
        """Add the background's colours, in the directions in which the surface sees them.

        Args:
            frame: The whole frame.
            is_foreground: (H, W) pixels on the scanned surface.
            positions: (V, 3) surface voxels of the changed blocks.
            rows: (R,) rows of the store that the frame sees.
            colours: (R, 3) 8-bit sRGB, their colours in this frame.
        """
        centre, radius = self._light_centre(frame, sight.KnownSurface(positions))
        if self._is_scene(frame):
            is_foreground = without_holes(frame.depth, is_foreground, sampling_step(frame))
        self.light.add_frame(
            *background_pixels(frame, is_foreground, frame.depth, centre, radius),
            lambda: surface_shifts(self.store, self.views, rows, colours, frame.camera_centre),
        )

    def _light_centre(
        self, frame: Frame, surface: sight.KnownSurface
    ) -> tuple[NDArray[np.float64], float]:
        """From where directions of light count, and how far from there what gives light is."""
        if self._is_scene(frame):
            return np.array(self.work_sphere.centre), self.work_sphere.radius(self.fusion)
        return surface.centre, surface.radius

    def _fuse_light(self, frame: Frame) -> FusedFrame:
        """Keep what a frame beside the surface shows of the light that falls on it."""
        nothing = np.zeros(frame.depth.shape, np.bool_)
        towards = self._light_centre(frame, self._known_surface())
        self.light.add_frame(*background_pixels(frame, nothing, frame.depth, *towards))
        return FusedFrame(
            frame.stamp_ns,
            frame.frame_id,
            *foreground_background_means(frame.rgb, nothing),
            is_light_alone=True,
        )

    def snapshot(self, most_voxels: int = MOST_VOXELS) -> ObservedSurface:
        """Copy what has been observed.

        Args:
            most_voxels: A larger surface is thinned evenly to so many voxels.

        Returns:
            The surface with its light, for use from any thread.
        """
        surface = observed_surface(self.store, self.views, self.fusion, most_voxels)
        return dataclasses.replace(surface, light=self.light.observed(), origin=self.origin)

    def snapshot_around_middle(self, most_voxels: int = MOST_VOXELS) -> ObservedSurface | None:
        """Copy the neighbourhood of the middle of the last view, where the scan is larger than it.

        Args:
            most_voxels: So many voxels are copied, those nearest to :attr:`middle`.

        Returns:
            The surface without its light; None where there is no middle, and where
            :meth:`snapshot` has all voxels.
        """
        if self.middle is None or self.store.observed_count <= most_voxels:
            return None
        stages = self.store, self.views, self.fusion
        surface = observed_surface(*stages, most_voxels, self.middle)
        return dataclasses.replace(surface, origin=self.origin)

    def save(self, path: Path | str) -> None:
        """Write the scan to one file, replacing it whole or not at all.

        Args:
            path: The file.

        Raises:
            OutputError: The file cannot be written; it is as it was before.
        """
        header = {
            "fusion": dataclasses.asdict(self.fusion),
            "region": dataclasses.asdict(self.region_settings),
            "origin": self.origin.tolist(),
            "frame_number": self.frame_number,
            "unchecked_until": self.unchecked_until,
            "last_stamp_ns": self.last_stamp_ns,
            "frame_id": self.frame_id,
            "world_frame_id": self.world_frame_id,
            "exposure_gain": self.light.gain,
            "work_sphere": dataclasses.asdict(self.work_sphere),
            "middle": None if self.middle is None else self.middle.tolist(),
            "next_material_id": self.material_ids.next_id,
        }
        arrays = {
            f"{part}_{name}": array[: stage.count]
            for part, stage in self._stages()
            for name, array in stage.arrays.items()
        }
        arrays |= {f"light_{name}": array for name, array in self.light.arrays.items()}
        write_scan(Path(path), header, arrays | self.material_ids.arrays)

    @classmethod
    def load(cls, path: Path | str, own: FusionSettings | None = None) -> Scan:
        """Read a saved scan; it continues exactly as the saved one would have.

        Args:
            path: The file.
            own: Settings of whoever loads it: their memory budget and threads hold, the rest is the
                scan's; None: all is the scan's.

        Returns:
            The scan.

        Raises:
            ScanFileError: The file is missing, damaged or of another version.
            MemoryBudgetError: The budget is too small for the scan, or too large for the machine.
        """
        path = Path(path)
        stored, arrays = read_scan(path)
        try:
            header = checked_header(stored)
            fusion = header.fusion
            if own is not None:
                fusion = dataclasses.replace(
                    fusion, memory_budget_mb=own.memory_budget_mb, threads=own.threads
                )
                MemoryBudget.from_settings(fusion).check_room(path, arrays)
            check_arrays(arrays, fusion, header.frame_number)
            scan = cls(fusion, header.region)
            scan._set_origin(np.array(header.origin))
            counts = {
                part: restore_rows(f"{part}_", stage.arrays, arrays)
                for part, stage in scan._stages()
            }
            restore_rows("light_", scan.light.arrays, arrays)
            scan.light.gain = header.exposure_gain
            scan.views.count = counts["views"]
            scan.volume.restore(counts["volume"])
            scan.store.restore(counts["store"], counts["chunks"], counts["views"])
            scan.frame_number = header.frame_number
            scan.unchecked_until = header.unchecked_until
            scan.last_stamp_ns = scan._clock_ns = header.last_stamp_ns
            scan.frame_id, scan.world_frame_id = header.frame_id, header.world_frame_id
            scan.work_sphere = WorkSphere.from_json(header.work_sphere)
            scan.middle = None if header.middle is None else np.array(header.middle)
            scan.material_ids = GivenIds.stored(stored, arrays)
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise damaged(path, error) from None
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
        """Whether a surface is known by now, and the frame shows what lies beside it."""
        return self.store.count > 0 and not self._known_surface().is_in_sight(frame)

    def _known_surface(self) -> sight.KnownSurface:
        return sight.KnownSurface.of(self.store.rows.positions[: self.store.count])

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


def _origin_near(centre: NDArray[np.float64]) -> NDArray[np.float64]:
    """Whole metres (3,) near a camera centre that is far from the origin; else 0."""
    if not (FAR < np.abs(centre).max() < np.inf):
        return np.zeros(3)
    return np.round(centre)
