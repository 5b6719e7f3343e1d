"""Messages in, frames out: match in time, decode, check; what fails is refused by cause."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera, check_camera_info
from reflest_core.capture.decode import decode_colour, decode_depth, decode_mask
from reflest_core.capture.frame import Frame
from reflest_core.capture.matching import Match, Matcher
from reflest_core.capture.messages import (
    AnyImage,
    CameraInfoMessage,
    PoseMessage,
    Role,
    SensorMessage,
)
from reflest_core.capture.pose import pose_at, pose_to_camera_matrix
from reflest_core.capture.rectify import Rectifier
from reflest_core.capture.refusal import FrameRefused, RefusalCause, RefusalLog
from reflest_core.capture.settings import CaptureSettings

RefusalListener = Callable[[FrameRefused, bool], None]
RELATIVE_NAMES: Mapping[Role, str] = {role: role.value for role in Role}


class FrameAssembler:
    """Assembles frames from the messages of a camera and a tracker.

    ``topics`` gives the names for its sentences. ``on_refusal(refusal, is_first)`` is called for
    every refusal; ``is_first`` marks the first of its cause.
    """

    def __init__(
        self,
        settings: CaptureSettings,
        topics: Mapping[Role, str] = RELATIVE_NAMES,
        on_refusal: RefusalListener | None = None,
    ) -> None:
        self.refusals = RefusalLog()
        self._settings = settings
        self._topics = {**RELATIVE_NAMES, **topics}
        self._on_refusal = on_refusal
        self._matcher = Matcher(settings, self._topics, self.refuse)
        self._child_to_camera = pose_to_camera_matrix(settings.pose_to_camera)
        self._is_child_set = not np.array_equal(self._child_to_camera, np.eye(4))
        self._calibration: tuple[CameraInfoMessage, CalibratedCamera, Rectifier | None] | None
        self._calibration = None

    def add(self, role: Role, message: SensorMessage) -> list[Frame]:
        """Take one message; return the frames that it completes, in stamp order."""
        return self._frames(self._matcher.add(role, message))

    def add_rgb(self, message: AnyImage) -> list[Frame]:
        """Take a colour image."""
        return self.add(Role.RGB, message)

    def add_depth(self, message: AnyImage) -> list[Frame]:
        """Take a depth image registered to the colour camera."""
        return self.add(Role.DEPTH, message)

    def add_camera_info(self, message: CameraInfoMessage) -> list[Frame]:
        """Take the colour camera's calibration."""
        return self.add(Role.CAMERA_INFO, message)

    def add_pose(self, message: PoseMessage) -> list[Frame]:
        """Take a pose."""
        return self.add(Role.POSE, message)

    def add_mask(self, message: AnyImage) -> list[Frame]:
        """Take a mask of the scanned object (with ``use_mask`` alone)."""
        return self.add(Role.MASK, message)

    def flush(self) -> list[Frame]:
        """Return the frames that still can be made at the end of a capture."""
        return self._frames(self._matcher.flush())

    def reset(self) -> None:
        """Forget what waits and every topic's last stamp, as after a clock jump."""
        self._matcher.reset()

    def refuse(self, refusal: FrameRefused) -> None:
        """Count a refusal, of this stage or of a later one, and tell the listener."""
        is_first = self.refusals.add(refusal)
        if self._on_refusal is not None:
            self._on_refusal(refusal, is_first)

    def _frames(self, matches: list[Match]) -> list[Frame]:
        frames = []
        for match in matches:
            try:
                frames.append(self._frame(match))
            except FrameRefused as refusal:
                self.refuse(refusal)
        return frames

    def _frame(self, match: Match) -> Frame:
        camera, rectifier = self._camera(match.camera_info)
        self._check_frame_ids(match)
        pose = pose_at(
            match.rgb.stamp_ns, match.pose_before, match.pose_after, self._topics[Role.POSE]
        )
        rgb = decode_colour(match.rgb, self._topics[Role.RGB])
        self._check_size(Role.RGB, rgb, camera)
        depth = decode_depth(match.depth, self._topics[Role.DEPTH], self._settings.depth_scale)
        self._check_size(Role.DEPTH, depth, camera)
        mask = self._mask(match, camera)
        if rectifier is not None:
            rgb, depth = rectifier.colour(rgb), rectifier.depth(depth)
            mask = None if mask is None else rectifier.mask(mask)
        if not depth.any():
            raise FrameRefused(
                RefusalCause.DEPTH_EMPTY,
                f"{self._topics[Role.DEPTH]} at {match.depth.stamp_ns / 1e9:.3f} s has no valid "
                "pixel: move the camera into its depth range",
            )
        return Frame(
            stamp_ns=match.rgb.stamp_ns,
            rgb=rgb,
            depth=depth,
            T_world_camera=pose @ self._child_to_camera,
            intrinsics=camera.intrinsics,
            mask=mask,
            frame_id=match.rgb.frame_id,
            world_frame_id=match.pose_before.frame_id,
        )

    def _camera(self, info: CameraInfoMessage) -> tuple[CalibratedCamera, Rectifier | None]:
        if self._calibration is None or self._calibration[0] is not info:
            camera = check_camera_info(info, self._topics[Role.CAMERA_INFO], self._settings)
            rectifier = Rectifier(camera) if camera.distortion else None
            self._calibration = (info, camera, rectifier)
        return self._calibration[1:]

    def _check_frame_ids(self, match: Match) -> None:
        if not self._settings.check_frame_ids:
            return
        colour_frame = match.rgb.frame_id
        if match.depth.frame_id and colour_frame and match.depth.frame_id != colour_frame:
            raise FrameRefused(
                RefusalCause.FRAME_MISMATCH,
                f"{self._topics[Role.DEPTH]} is in frame {match.depth.frame_id!r}, colour in "
                f"{colour_frame!r}: use depth aligned to colour, or turn off "
                "capture.check_frame_ids if it is",
            )
        child = match.pose_before.child_frame_id
        if child and child != colour_frame and not self._is_child_set:
            raise FrameRefused(
                RefusalCause.FRAME_MISMATCH,
                f"{self._topics[Role.POSE]} is the pose of {child!r}, the images are in "
                f"{colour_frame!r}: set capture.pose_to_camera",
            )

    def _check_size(self, role: Role, image: NDArray[np.generic], camera: CalibratedCamera) -> None:
        height, width = image.shape[:2]
        expected = (camera.intrinsics.width, camera.intrinsics.height)
        if (width, height) != expected:
            raise FrameRefused(
                RefusalCause.SIZE,
                f"{self._topics[role]} has {width} x {height} pixels, "
                f"{self._topics[Role.CAMERA_INFO]} describes {expected[0]} x {expected[1]}: use "
                "depth aligned to colour and the colour camera's info",
            )

    def _mask(self, match: Match, camera: CalibratedCamera) -> NDArray[np.bool_] | None:
        if match.mask is None:
            return None
        mask = decode_mask(match.mask, self._topics[Role.MASK])
        self._check_size(Role.MASK, mask, camera)
        return mask
