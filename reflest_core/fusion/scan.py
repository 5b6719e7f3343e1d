# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan: frames go in, the observed surface comes out (paper, Sec. 3.1)."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames import sight
from reflest_core.fusion.frames.background_light import (
    background_pixels,
    sampling_step,
    without_holes,
)
from reflest_core.fusion.frames.foreground import (
    FramePixels,
    classify_pixels,
    foreground_background_means,
)
from reflest_core.fusion.frames.region import Region, RegionShape
from reflest_core.fusion.frames.visibility import visible_voxels
from reflest_core.fusion.frames.window import cropped, object_window
from reflest_core.fusion.frames.work_sphere import WorkSphere, view_middle
from reflest_core.fusion.fused_frame import FusedFrame
from reflest_core.fusion.observations.exposure import surface_shifts
from reflest_core.fusion.observations.redundancy import WELL_KNOWN_SHARE, known_frame
from reflest_core.fusion.poses.disagreement import contradicted_blocks
from reflest_core.fusion.scan_state import ScanState
from reflest_core.fusion.snapshot import MOST_VOXELS, observed_surface
from reflest_core.fusion.tsdf.volume import SurfaceUpdate
from reflest_core.light.exposure_gain import may_share_view
from reflest_core.surface.observed_surface import ObservedSurface

FAR = 100.0
"""Metres from the origin of the world frame: a scan that begins farther away has an origin of its
own, for float32 holds no hundredths of a millimetre there, and keys of voxels end at 5 km."""
NEW_SURFACE_SHARE = 0.2
"""A frame near a stored view is a new view if more than this share of what it sees is new."""


@dataclass(frozen=True)
class SeenVoxels:
    """Surface voxels that a view truly sees.

    Attributes:
        rows: (R,) int64, their rows in the store.
        positions: (R, 3) float32, metres.
        colours: (R, 3) uint8 sRGB, what the view saw of them.
    """

    rows: NDArray[np.int64]
    positions: NDArray[np.float32]
    colours: NDArray[np.uint8]


class Scan(ScanState):
    """Takes frames in; its state is what they showed.

    Not thread-safe: fuse and snapshot from one thread. A snapshot is a copy, for any thread.
    """

    def fuse(self, frame: Frame) -> FusedFrame:
        """Take a frame in; of one that looks away from the scanned surface, the light alone.

        Args:
            frame: A frame whose stamp is after that of the last one.

        Returns:
            What was done with the frame.

        Raises:
            FrameRefused: ``STAMP_INVALID``, ``TIME_BACKWARDS``, ``POSE_INVALID``, ``DEPTH_EMPTY``
                or ``NO_OVERLAP``; nothing has changed.
        """
        whole = self._placed(frame)
        sphere, region = self._extent(whole)
        window = object_window(whole, region)
        frame = cropped(whole, window)
        pixels = classify_pixels(frame, region, self.fusion)
        shows_surface = pixels.farthest > 0.0
        if not shows_surface and not self._looks_away(whole):
            radius = self.work_sphere.radius(self.fusion) if self.work_sphere.frames else 0.0
            raise sight.refusal_without_surface(whole, self.region, self.fusion, radius)
        self.last_stamp_ns = self._clock_ns = frame.stamp_ns
        self.frame_id, self.world_frame_id = frame.frame_id, frame.world_frame_id
        if not shows_surface:
            return self._fuse_light(whole)
        self.work_sphere = sphere
        self.middle = view_middle(whole, self.fusion.max_depth) if self._is_scene(whole) else None
        is_foreground = np.zeros(whole.depth.shape, np.bool_)
        is_foreground[window.slices] = pixels.foreground
        means = foreground_background_means(whole.rgb, is_foreground)
        fused = FusedFrame(frame.stamp_ns, frame.frame_id, *means)
        if self.unchecked_until >= 0:
            self._drop_contradicted(frame)

        # What a near view showed already brings its depth alone, or nothing.
        known = known_frame(
            frame, pixels, self.store, self.views, self.fusion.voxel_size, self.fusion.view_spacing
        )
        if known is not None and self.views.frames[known.view] >= self.fusion.frames_per_view:
            return dataclasses.replace(fused, view=known.view, is_redundant=True)
        self.frame_number += 1
        changed, fused = self._integrate_depth(frame, pixels, fused)
        if known is not None and known.share >= WELL_KNOWN_SHARE:
            self.views.frames[known.view] += 1
            return dataclasses.replace(fused, view=known.view)

        surface, rows_of_surface = self._extract_surface(changed)
        seen, fused = self._find_visible(frame, pixels, surface, rows_of_surface, fused)
        if len(surface.positions):
            self._add_light(whole, is_foreground, surface.positions, seen)
        return self._keep_observations(frame, seen, fused)

    def _placed(self, frame: Frame) -> Frame:
        """Check stamp and pose, and turn a frame from the world into the scan's coordinates."""
        sight.check_stamp(frame, self._clock_ns)
        sight.check_frame_pose(frame)
        if self.frame_number == 0:
            self._set_origin(_origin_near(frame.camera_centre))
        frame = frame.relative_to(self.origin)
        sight.check_reach(frame, self.fusion)
        return frame

    def _extent(self, frame: Frame) -> tuple[WorkSphere, Region]:
        """The work sphere as the frame changes it, and the region that is scanned."""
        if not self._is_scene(frame):
            return self.work_sphere, self.region
        sphere = self.work_sphere.updated(frame, self.fusion)
        return sphere, sphere.region(self.fusion)

    def _integrate_depth(
        self, frame: Frame, pixels: FramePixels, fused: FusedFrame
    ) -> tuple[NDArray[np.int64], FusedFrame]:
        """Fuse the depth into the TSDF; returns the blocks that it changed, and the counts."""
        near, erased = self.volume.allocate(frame, pixels, self.frame_number)
        self.store.remove(erased)
        in_sight = self.volume.in_sight(near, frame, self.fusion.max_depth, self.frame_number)
        changed = self.volume.integrate(
            in_sight, frame, pixels, self.frame_number, self.fusion.threads
        )
        return changed, dataclasses.replace(
            fused, blocks_projected=len(in_sight), blocks_changed=len(changed)
        )

    def _extract_surface(
        self, changed: NDArray[np.int64]
    ) -> tuple[SurfaceUpdate, NDArray[np.int64]]:
        """Find the surface voxels in changed blocks, and renew what the store knows of them.

        Returns the surface and its rows in the store, negative where a voxel has none.
        """
        threads = self.fusion.threads
        surface = self.volume.extract(changed, threads)
        self.store.move(surface.left, surface.left_to)
        rows = self.store.find(surface.keys, threads)
        self.store.refresh(rows, surface.positions, surface.normals, threads)
        return surface, rows

    def _find_visible(
        self,
        frame: Frame,
        pixels: FramePixels,
        surface: SurfaceUpdate,
        rows_of_surface: NDArray[np.int64],
        fused: FusedFrame,
    ) -> tuple[SeenVoxels, FusedFrame]:
        """Find the voxels that the view truly sees, with a row in the store for each."""
        seen, colours = visible_voxels(
            surface.positions, surface.normals, frame, pixels, self.fusion, self.fusion.threads
        )
        positions = surface.positions[seen]
        rows = self.store.claim(
            surface.keys[seen],
            rows_of_surface[seen],
            positions,
            surface.normals[seen],
            self.frame_number,
        )
        has_row = rows >= 0
        if not has_row.all():
            rows, colours, positions = rows[has_row], colours[has_row], positions[has_row]
        return SeenVoxels(rows, positions, colours), dataclasses.replace(
            fused, surface_voxels=len(surface.keys), voxels_seen=len(seen)
        )

    def _keep_observations(self, frame: Frame, seen: SeenVoxels, fused: FusedFrame) -> FusedFrame:
        """Keep a colour of each seen voxel that no stored view near this one has observed."""
        if not len(seen.rows):
            return fused
        threads = self.fusion.threads
        centre = sight.KnownSurface(seen.positions).centre
        near = self.views.near(frame.camera_centre, centre, self.fusion.view_spacing)
        unseen = self.store.unseen_from(seen.rows, near, threads)
        is_new_view = (
            len(near) == 0
            or bool(unseen.mean() > NEW_SURFACE_SHARE)
            or not may_share_view(self.light.gain, float(self.views.gains[near[0]]))
        )
        view = self._add_view(frame, fused) if is_new_view else int(near[0])
        self.views.frames[view] += 1
        kept = self.store.observe(
            seen.rows[unseen], seen.colours[unseen], view, self.views.centres, threads
        )
        return dataclasses.replace(
            fused, view=view, is_new_view=is_new_view, observations_kept=kept
        )

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
        seen: SeenVoxels,
    ) -> None:
        """Add the background's colours, in the directions in which the surface sees them.

        Args:
            frame: The whole frame.
            is_foreground: (H, W) pixels on the scanned surface.
            positions: (V, 3) surface voxels of the changed blocks.
            seen: What the frame sees.
        """
        centre, radius = self._light_centre(frame, sight.KnownSurface(positions))
        if self._is_scene(frame):
            is_foreground = without_holes(frame.depth, is_foreground, sampling_step(frame))
        self.light.add_frame(
            *background_pixels(frame, is_foreground, frame.depth, centre, radius),
            lambda: surface_shifts(
                self.store, self.views, seen.rows, seen.colours, frame.camera_centre
            ),
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

    def _looks_away(self, frame: Frame) -> bool:
        """Whether a surface is known by now, and the frame shows what lies beside it."""
        return self.store.count > 0 and not self._known_surface().is_in_sight(frame)

    def _known_surface(self) -> sight.KnownSurface:
        return sight.KnownSurface.of(self.store.rows.positions[: self.store.count])

    def _add_view(self, frame: Frame, fused: FusedFrame) -> int:
        if self.views.is_full:
            oldest = self.views.oldest()
            self.store.drop_views(oldest)
            self.views.forget(oldest)
        return self.views.put(
            frame.camera_centre,
            fused.foreground,
            fused.background,
            frame.stamp_ns,
            self.light.gain,
        )


def _origin_near(centre: NDArray[np.float64]) -> NDArray[np.float64]:
    """Whole metres (3,) near a camera centre that is far from the origin; else 0."""
    if not (FAR < np.abs(centre).max() < np.inf):
        return np.zeros(3)
    return np.round(centre)
