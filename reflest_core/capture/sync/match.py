# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the matcher yields: the messages that make one frame."""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.capture.messages import AnyImage, CameraInfoMessage, PoseMessage


@dataclass(frozen=True, eq=False)
class Match:
    """Messages of one moment; the two poses bracket the colour image's stamp."""

    rgb: AnyImage
    depth: AnyImage
    camera_info: CameraInfoMessage
    depth_info: CameraInfoMessage | None
    pose_before: PoseMessage
    pose_after: PoseMessage
    mask: AnyImage | None
