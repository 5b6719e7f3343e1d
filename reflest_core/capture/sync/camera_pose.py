# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The colour camera's pose at an image, with the frames that its messages name compared."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.messages import Match, Role, plain_frame
from reflest_core.capture.pose import matrix_of_parameter, pose_at
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.sync.transform_buffer import TransformBuffer


class CameraPoses:
    """Takes poses to the colour camera's optical frame, and holds on to one world frame."""

    def __init__(
        self, settings: CaptureSettings, topics: dict[Role, str], transforms: TransformBuffer
    ) -> None:
        """Begin without a world frame.

        Args:
            settings: parameters of the group ``capture``.
            topics: names of the streams for sentences.
            transforms: all that came by tf.
        """
        self._settings = settings
        self._topics = topics
        self._transforms = transforms
        self._child_to_camera = matrix_of_parameter("pose_to_camera", settings.pose_to_camera)
        self._is_child_set = settings.is_pose_to_camera_set
        self._world_frame = ""

    def forget_world(self) -> None:
        """Let the next pose name another world frame."""
        self._world_frame = ""

    def of(self, match: Match) -> NDArray[np.float64]:
        """Return ``T_world_camera`` (4, 4) at the colour image's stamp.

        Args:
            match: messages of one frame.

        Raises:
            FrameRefused: POSE_INVALID, or FRAME_MISMATCH where the pose is of another frame or in
                another world.
        """
        topic = self._topics[Role.POSE]
        child_to_camera = self._child_to(match)
        world = self._checked_world(match)
        pose = pose_at(match.rgb.stamp_ns, match.pose_before, match.pose_after, topic)
        self._world_frame = world
        return pose @ child_to_camera

    def _child_to(self, match: Match) -> NDArray[np.float64]:
        child, camera = match.pose_before.child_frame_id, match.rgb.frame_id
        is_same = not child or plain_frame(child) == plain_frame(camera)
        if is_same or self._is_child_set or not self._settings.check_frame_ids:
            return self._child_to_camera
        try:
            return self._transforms.matrix(child, camera, match.rgb.stamp_ns)
        except FrameRefused as refusal:
            raise FrameRefused(
                RefusalCause.FRAME_MISMATCH,
                f"{self._topics[Role.POSE]} is the pose of {child!r}, the images are in "
                f"{camera!r}: set capture.pose_to_camera or publish the transform ({refusal})",
            ) from refusal

    def _checked_world(self, match: Match) -> str:
        world = self._world_frame
        for named in map(plain_frame, (match.pose_before.frame_id, match.pose_after.frame_id)):
            world = world or named
            if self._settings.check_frame_ids and named and named != world:
                raise FrameRefused(
                    RefusalCause.FRAME_MISMATCH,
                    f"{self._topics[Role.POSE]} changed its world frame from {world!r} to "
                    f"{named!r}: see that one tracker alone writes it, or reset the scan to go on "
                    "in the new frame",
                )
        return world
