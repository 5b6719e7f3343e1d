# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded topics that help where they exist: the depth camera's calibration, and transforms."""

from __future__ import annotations

from reflest_core.capture.formats.candidate_topic import CandidateTopic
from reflest_core.capture.formats.cdr import CAMERA_INFO, TRANSFORMS
from reflest_core.capture.messages import Role

NAMES = {Role.TF: "/tf", Role.TF_STATIC: "/tf_static"}


def depth_info_topic(candidates: list[CandidateTopic], topics: dict[Role, str]) -> str | None:
    """The camera_info beside the depth topic, unless it is colour's."""
    infos = [topic for topic in candidates if topic.message_type == CAMERA_INFO]
    beside = info_beside(infos, topics[Role.DEPTH])
    return beside if beside != topics[Role.CAMERA_INFO] else None


def info_beside(infos: list[CandidateTopic], image: str) -> str | None:
    """The camera_info in an image topic's folder, as ROS drivers name it, else None."""
    parent = image.rpartition("/")[0]
    # image_transport adds a level: camera/image_raw/compressed belongs to camera/camera_info.
    for folder in (parent, parent.rpartition("/")[0]):
        if f"{folder}/camera_info" in [topic.name for topic in infos]:
            return f"{folder}/camera_info"
    return None


def transform_topics(candidates: list[CandidateTopic]) -> dict[Role, str]:
    """``/tf`` and ``/tf_static`` where they are; in a namespace, where there is one of each."""
    recorded = [topic.name for topic in candidates if topic.message_type == TRANSFORMS]
    chosen = {}
    for role, name in NAMES.items():
        fitting = [topic for topic in recorded if topic.endswith(name)]
        if name in fitting or len(fitting) == 1:
            chosen[role] = name if name in fitting else fitting[0]
    return chosen
