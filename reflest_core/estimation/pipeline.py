# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The live path in one object: frames in, keyframes out, estimates on demand.

The ROS node and ``reflest replay`` both drive this class, so that they agree bit for bit.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.environment.known_rooms import read_known_light
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pose_problem import poses_explain, with_poses
from reflest_core.estimation.scan_memory import ScanMemory
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.frames.sight import check_frame_pose
from reflest_core.fusion.fused_frame import FusedFrame
from reflest_core.fusion.keyframe import KeyframePolicy
from reflest_core.fusion.poses.check import PoseCheck, PoseReport
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import RegionSettings
from reflest_core.fusion.snapshot import MOST_VOXELS
from reflest_core.segmentation.segmenter import Segmenter
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import Partition

EVERY_VOXEL = 1 << 24
"""More voxels than a scan's memory budget holds."""
MISPLACED = (RefusalCause.POSE_INVALID, RefusalCause.NO_OVERLAP)
"""Causes for which a frame after a jump of the tracker is refused."""


@dataclass(frozen=True)
class KeyframeSnapshot:
    """The surface as it stood when the keyframe was fused.

    Attributes:
        stamp_ns: stamp of the keyframe's image.
        frame_id: frame of the colour camera.
        surface: a copy of the scan, thinned evenly where it is large; ``around`` where that is
            there and the snapshot came with a fused frame.
        world_frame_id: frame of the surface and of the pose.
        T_world_camera: (4, 4) float64, the keyframe's pose; None where no frame was fused yet, as
            after a load.
        voxel_count: of the whole scan; None where the surface is all there is.
        observation_count: of the whole scan; None where the surface is all there is.
        light_problem: why light that was known before the scan was not used, or "".
        poses: how well the scan's depth maps meet; None where none were fused.
        memory: what is remembered of this scan's materials; None where it is one material.
        middle: (3,) float64, world frame, the surface point in the middle of the view; None where a
            region or a mask says what is looked at.
        around: the surface around it; None where ``surface`` has all voxels.
        bounds: what bounds the scan, world frame; None where that is not known.
    """

    stamp_ns: int
    frame_id: str
    surface: ObservedSurface
    world_frame_id: str = ""
    T_world_camera: NDArray[np.float64] | None = None
    voxel_count: int | None = None
    observation_count: int | None = None
    light_problem: str = ""
    poses: PoseReport | None = None
    memory: ScanMemory | None = None
    middle: NDArray[np.float64] | None = None
    around: ObservedSurface | None = None
    bounds: Region | None = None


@dataclass(frozen=True)
class ScannedFrame:
    """What one frame did to the scan.

    Attributes:
        fused: counts and times of the frame.
        keyframe: the snapshot to estimate from, None where the frame was no keyframe.
    """

    fused: FusedFrame
    keyframe: KeyframeSnapshot | None


class Pipeline:
    """Fuses frames and estimates the material of what they show.

    :meth:`estimate` only reads its snapshot: it may run in one other thread while frames go on.

    Attributes:
        settings: all parameters.
        estimator: estimates the materials of what was scanned.
        scan: what was scanned.
        keyframes: which frames are estimated from.
        poses: how well frames meet.
        is_all_shown: says at a keyframe whether somebody looks at the whole surface; its snapshot
            then has voxels of all of it, beside those around the middle of the view.
    """

    def __init__(self, settings: ReflestSettings) -> None:
        """Load the weights and allocate the scan.

        Args:
            settings: all parameters.

        Raises:
            ReflestError: The weights or the known light cannot be read.
        """
        self.settings = settings
        self.estimator = Estimator(settings.estimation)
        path = settings.estimation.known_light
        self._known_light = read_known_light(Path(path)) if path else None
        self.scan = Scan(settings.fusion, settings.region)
        self.keyframes = KeyframePolicy(settings.keyframe)
        self.poses = PoseCheck()
        self.is_all_shown: Callable[[], bool] = lambda: False
        self._last_pose: NDArray[np.float64] | None = None
        self._memory = ScanMemory()

    def fuse(self, frame: Frame) -> ScannedFrame:
        """Fuse one frame.

        Args:
            frame: later than the frame before.

        Returns:
            What it did, with a snapshot if it was a keyframe.

        Raises:
            FrameRefused: The frame cannot be used; the scan is as it was.
        """
        try:
            fused = self.scan.fuse(frame)
        except FrameRefused as refusal:
            if refusal.cause not in MISPLACED:
                raise
            check_frame_pose(frame)  # a pose that is none says nothing of a jump
            after_jump = self.poses.add(frame, is_fused=False)
            if after_jump is None or self.settings.fusion.on_jump == "keep":
                raise
            fused = self._go_on_after_jump(after_jump, frame)
        else:
            after_jump = self.poses.add(frame)
            if after_jump is not None and self.settings.fusion.on_jump != "keep":
                fused = self._go_on_after_jump(after_jump, frame)
        self._last_pose = frame.T_world_camera
        if not self.keyframes.is_keyframe(frame.stamp_ns, frame.T_world_camera):
            return ScannedFrame(fused, None)
        return ScannedFrame(fused, self.keyframe_snapshot())

    def _go_on_after_jump(self, first: Frame, frame: Frame) -> FusedFrame:
        """Forget the surface, or what the two frames since the tracker's jump contradict of it.

        These two are fused again, into what is left.
        """
        is_new = self.settings.fusion.on_jump == "new_scan"
        self.poses.drop_before_jump(is_new)
        if is_new:
            self.scan.reset()
            self._memory = ScanMemory()
        else:
            self.scan.check_after_jump((first, frame))
            self.scan.restart_clock()
        with contextlib.suppress(FrameRefused):  # it was fused for what lay before the jump
            self.scan.fuse(first)
        return self.scan.fuse(frame)

    def snapshot(self, most_voxels: int = MOST_VOXELS) -> KeyframeSnapshot:
        """Copy the scan to estimate from, with the last frame's stamp and pose.

        Args:
            most_voxels: a larger scan is thinned evenly to so many voxels.
        """
        around = None
        if most_voxels <= MOST_VOXELS:
            around = self.scan.snapshot_around_middle(most_voxels)
        poses = self.poses.report
        return self._as_keyframe(self.scan.snapshot(most_voxels), around, poses)

    def keyframe_snapshot(self) -> KeyframeSnapshot:
        """Copy what the estimate at a keyframe needs, once: every copy delays the next frame."""
        around, poses = self.scan.snapshot_around_middle(), self.poses.latest_report
        if around is None or self.is_all_shown():
            return self._as_keyframe(self.scan.snapshot(), around, poses)
        surface = replace(around, light=self.scan.light.observed())
        return self._as_keyframe(surface, around, poses)

    def _as_keyframe(
        self, surface: ObservedSurface, around: ObservedSurface | None, poses: PoseReport
    ) -> KeyframeSnapshot:
        scan, problem = self.scan, ""
        if self._known_light is not None and surface.light is not None:
            joined = self._known_light.joined(surface.light)
            surface, problem = replace(surface, light=joined.light), joined.problem
        return KeyframeSnapshot(
            scan.last_stamp_ns or 0,
            scan.frame_id,
            surface,
            scan.world_frame_id,
            self._last_pose,
            scan.store.observed_count,
            scan.observation_count,
            problem,
            poses,
            self._memory if scan.region_settings.shape == "none" else None,
            None if scan.middle is None else scan.middle + scan.origin,
            None if around is None else replace(around, light=surface.light),
            scan.bounds,
        )

    def estimate(self, snapshot: KeyframeSnapshot) -> BrdfEstimate:
        """Estimate the region's material, or else the one in the middle of the view.

        Of a large scan without a region the :data:`.MOST_VOXELS` voxels around the middle of the
        view are divided into materials. The answer depends on the snapshot alone.

        Args:
            snapshot: the scan at a keyframe.

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        with poses_explain(snapshot.poses):
            return self._estimate(snapshot)

    def _estimate(self, snapshot: KeyframeSnapshot) -> BrdfEstimate:
        header = snapshot.stamp_ns, snapshot.frame_id, snapshot.light_problem
        is_part, estimate = snapshot.around is not None, None
        surface = snapshot.surface if snapshot.around is None else snapshot.around
        if snapshot.middle is not None:
            estimate = self.estimator.material_at(surface, snapshot.middle, *header)
        if estimate is not None:
            return with_poses(estimate, snapshot.poses)
        estimate = with_poses(self.estimator.estimate(surface, *header), snapshot.poses)
        if is_part or snapshot.voxel_count is None or snapshot.observation_count is None:
            return estimate
        return replace(
            estimate,
            voxel_count=snapshot.voxel_count,
            observation_count=snapshot.observation_count,
        )

    def materials(self, snapshot: KeyframeSnapshot) -> MaterialMap:
        """Estimate each material of a snapshot, all in one light.

        With a region of interest all is one material; without, the scan is divided into materials,
        whose ids stay from keyframe to keyframe. So snapshots are to come in their order, from one
        thread at a time.

        Args:
            snapshot: the scan at a keyframe.

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        surface, header = snapshot.surface, (snapshot.stamp_ns, snapshot.frame_id)
        with poses_explain(snapshot.poses):
            if snapshot.memory is None:
                whole = Partition.whole(surface)
                found = self.estimator.materials(surface, whole, *header, snapshot.light_problem)
            else:
                found = self.estimator.segmented_materials(
                    surface, snapshot.memory, *header, snapshot.light_problem
                )
        materials = (
            replace(material, estimate=with_poses(material.estimate, snapshot.poses))
            for material in found.materials
        )
        return replace(found, materials=tuple(materials), world_frame_id=snapshot.world_frame_id)

    def final_materials(self) -> MaterialMap:
        """Estimate each material of the whole scan, from all voxels and from scratch.

        The map does not depend on earlier estimates; the ids of a saved scan stay.

        Raises:
            NoEstimate: Too few voxels were observed.
        """
        self._memory = ScanMemory(Segmenter(self.scan.material_ids))
        return self.materials(self.snapshot(EVERY_VOXEL))

    def restart_clock(self) -> None:
        """Go on with frames of any stamp, as after a clock jump; what was scanned stays."""
        self.scan.restart_clock()
        self.keyframes.reset()
        self.poses.restart()

    def set_region(self, region: RegionSettings) -> None:
        """Begin a scan of another region of interest, unless it is the one that is scanned.

        Args:
            region: world frame, metres.
        """
        if region != self.scan.region_settings:
            self.scan.set_region(region)
            self._begin(ScanMemory())

    def reset(self) -> None:
        """Forget everything that was scanned."""
        self.scan.reset()
        self._begin(ScanMemory())

    def save(self, path: Path) -> None:
        """Write volume, store and views to one file, whole or not at all.

        Args:
            path: it is replaced if it exists.

        Raises:
            ReflestError: The file cannot be written.
        """
        self.scan.material_ids = self._memory.segmenter.given_ids
        self.scan.save(path)

    def load(self, path: Path) -> None:
        """Continue a saved scan; the scan stays as it was if that fails.

        Args:
            path: A file that :meth:`save` wrote.

        Raises:
            ReflestError: The file cannot be used.
        """
        self.continue_scan(self.read(path))

    def read(self, path: Path) -> Scan:
        """Read a saved scan, in any thread; nothing changes.

        Args:
            path: A file that :meth:`save` wrote.

        Returns:
            The scan with this scanner's memory budget and threads, for :meth:`continue_scan`.

        Raises:
            ReflestError: The file cannot be used.
        """
        return Scan.load(path, self.settings.fusion)

    def continue_scan(self, scan: Scan) -> None:
        """Continue another scan; the next frame may have any stamp.

        Args:
            scan: It belongs to this scanner from now on.
        """
        self.scan = scan
        self.scan.restart_clock()
        self._begin(ScanMemory(Segmenter(scan.material_ids)))

    def _begin(self, memory: ScanMemory) -> None:
        self._memory, self._last_pose = memory, None
        self.keyframes.reset()
        self.poses = PoseCheck()

    def prepare_estimation(self, estimation: EstimationSettings) -> Callable[[], None]:
        """Load what other estimation settings need; nothing changes yet.

        Args:
            estimation: The new settings.

        Returns:
            What puts them to use, from the next estimate on.

        Raises:
            ReflestError: The weights or the known light cannot be used.
        """
        estimator, known_light = Estimator(estimation), self._known_light
        if estimation.known_light != self.settings.estimation.known_light:
            path = estimation.known_light
            known_light = read_known_light(Path(path)) if path else None

        def put_to_use() -> None:
            self.settings = replace(self.settings, estimation=estimation)
            self.estimator, self._known_light = estimator, known_light

        return put_to_use
