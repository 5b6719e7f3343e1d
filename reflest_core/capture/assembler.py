# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Messages in, frames out: match in time, decode, check; what fails is refused by cause."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera_info import CalibratedCamera
from reflest_core.capture.frame import Frame
from reflest_core.capture.images.decode import decode_colour, decode_depth, decode_mask
from reflest_core.capture.images.depth_gaps import fill_gaps
from reflest_core.capture.images.depth_registration import along_axis
from reflest_core.capture.images.rectify import CheckedCamera, Rectifier
from reflest_core.capture.messages import Match, Role, SensorMessage, plain_frame
from reflest_core.capture.refusal import FrameRefused, RefusalCause, RefusalLog
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.sync.camera_pose import CameraPoses
from reflest_core.capture.sync.depth_alignment import DepthAlignment
from reflest_core.capture.sync.matching import Matcher
from reflest_core.capture.sync.transform_buffer import TransformBuffer

RefusalListener = Callable[[FrameRefused, bool], None]
RELATIVE_NAMES: Mapping[Role, str] = {role: role.value for role in Role}


class FrameAssembler:
    """Assembles frames from the messages of a camera and a tracker.

    ``on_clock_jump`` is called within :meth:`add` when stamps start again, before it returns frames
    of after the jump; what waited has been dropped by then.

    Attributes:
        refusals: What was refused so far, by cause.
    """

    def __init__(
        self,
        settings: CaptureSettings,
        topics: Mapping[Role, str] = RELATIVE_NAMES,
        on_refusal: RefusalListener | None = None,
        on_clock_jump: Callable[[str], None] = lambda _: None,
        on_warning: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Begin without messages.

        Args:
            settings: parameters of the group ``capture``.
            topics: names of the streams for sentences.
            on_refusal: called with each refusal, and whether it is the first of its cause.
            on_clock_jump: called where stamps start again.
            on_warning: called with sentences about the recording.
        """
        self.refusals = RefusalLog()
        self._settings = settings
        self._topics = {**RELATIVE_NAMES, **topics}
        self._on_refusal = on_refusal
        transforms = TransformBuffer(settings.max_transform_gap, settings.clock_jump)
        self._camera = CheckedCamera(
            self._topics[Role.CAMERA_INFO], self._topics[Role.RGB], settings, on_warning
        )
        self._poses = CameraPoses(settings, self._topics, transforms)
        self._alignment = DepthAlignment(settings, self._topics, transforms, on_warning)
        self._matcher = Matcher(
            settings, self._topics, self.refuse, transforms, self._alignment, on_clock_jump
        )

    def add(self, role: Role, message: SensorMessage) -> list[Frame]:
        """Take one message; return the frames that it completes, in stamp order.

        Args:
            role: the stream of the message.
            message: as it was received or recorded.
        """
        return self._frames(self._matcher.add(role, message))

    def flush(self) -> list[Frame]:
        """Return the frames that still can be made at the end of a capture."""
        return self._frames(self._matcher.flush())

    def reset(self) -> None:
        """Forget what waits, every topic's last stamp and the world's name, but no calibration."""
        self._matcher.reset()
        self._poses.forget_world()

    def refuse(self, refusal: FrameRefused) -> None:
        """Count a refusal, of this stage or of a later one, and notify the listener.

        Args:
            refusal: with its cause and sentence.
        """
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
        self._check_info_frame(match)
        camera, rectifier = self._camera.of(match.camera_info)
        T_world_camera = self._poses.of(match)
        rgb = decode_colour(match.rgb, self._topics[Role.RGB])
        self._check_size(Role.RGB, rgb, camera)
        mask = None
        if match.mask is not None:
            mask = decode_mask(match.mask, self._topics[Role.MASK])
            self._check_size(Role.MASK, mask, camera)
        depth = self._depth(match, camera, rectifier)
        if rectifier is not None:
            rgb = rectifier.colour(rgb)
            mask = None if mask is None else rectifier.mask(mask)
        return Frame(
            stamp_ns=match.rgb.stamp_ns,
            rgb=rgb,
            depth=depth,
            T_world_camera=T_world_camera,
            intrinsics=camera.intrinsics,
            mask=mask,
            frame_id=match.rgb.frame_id,
            world_frame_id=match.pose_before.frame_id,
            depth_source=self._topics[Role.DEPTH],
        )

    def _depth(
        self, match: Match, camera: CalibratedCamera, rectifier: Rectifier | None
    ) -> NDArray[np.float32]:
        topic = self._topics[Role.DEPTH]
        settings = self._settings
        is_rotated = settings.depth_encoding == "rotated"
        depth = decode_depth(match.depth, topic, settings.depth_unit(), is_rotated)
        if self._alignment.is_needed(match.rgb, match.depth):
            return self._alignment.register(depth, match, camera)
        self._check_size(Role.DEPTH, depth, camera)
        depth = depth if rectifier is None else rectifier.depth(depth)
        if settings.depth_kind == "ray":
            depth = along_axis(depth, camera.intrinsics)
        return fill_gaps(depth)

    def _check_info_frame(self, match: Match) -> None:
        described, colour = match.camera_info.frame_id, match.rgb.frame_id
        if (
            self._settings.check_frame_ids
            and described
            and colour
            and (plain_frame(described) != plain_frame(colour))
        ):
            raise FrameRefused(
                RefusalCause.FRAME_MISMATCH,
                f"{self._topics[Role.CAMERA_INFO]} describes the camera {described!r}, colour is "
                f"in {colour!r}: choose the colour camera's info, or turn off "
                "capture.check_frame_ids if it is",
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
