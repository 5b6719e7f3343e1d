# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Opens the capture that a command line names."""

import argparse
from typing import Any

from reflest_core.capture.capture import Capture
from reflest_core.capture.formats.topics import TopicChoice
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.settings import CaptureSettings


def open_source(
    options: argparse.Namespace, settings: CaptureSettings, **listeners: Any
) -> Capture:
    """Open the capture with the topics and intrinsics that the options give.

    Args:
        options: All options of a command with :func:`~.scan_options.add_scan_options`.
        settings: How the capture is read.
        **listeners: ``on_refusal``, ``on_clock_jump`` and ``on_warning`` of
            :func:`~reflest_core.capture.open_capture.open_capture`.

    Raises:
        CaptureError: The capture cannot be read, or an option does not apply to it.
    """
    topics = TopicChoice(
        rgb=options.rgb_topic,
        depth=options.depth_topic,
        camera_info=options.camera_info_topic,
        pose=options.pose_topic,
        mask=options.mask_topic,
        depth_camera_info=options.depth_camera_info_topic,
    )
    pinhole = tuple(options.intrinsics) if options.intrinsics else None
    return open_capture(options.capture, topics, settings, pinhole, **listeners)
