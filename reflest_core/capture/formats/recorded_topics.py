# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded topics: which are copies of others, and which help where they exist."""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.capture.formats.cdr import CAMERA_INFO, TRANSFORMS
from reflest_core.capture.messages import Role

TRANSPORTS = ("/compressedDepth", "/compressed")
"""What image_transport appends to a topic's name for its compressed forms; the better first."""
TRANSFORM_NAMES = {Role.TF: "/tf", Role.TF_STATIC: "/tf_static"}


@dataclass(frozen=True)
class CandidateTopic:
    """A recorded topic.

    Attributes:
        name: Of the topic.
        message_type: As ``sensor_msgs/msg/Image``.
        encoding: Of its first image; "" for other types.
    """

    name: str
    message_type: str
    encoding: str = ""

    def __str__(self) -> str:
        """Name, type and encoding, for sentences."""
        kind = self.message_type.split("/")[-1]
        return f"{self.name} ({kind}{', ' + self.encoding if self.encoding else ''})"


def without_copies(topics: list[CandidateTopic]) -> list[CandidateTopic]:
    """Leave out the compressed copies of images that are there raw, or compressed better.

    Args:
        topics: topics of one role.
    """
    names = {topic.name for topic in topics}

    def is_copy(name: str) -> bool:
        for rank, transport in enumerate(TRANSPORTS):
            base = name.removesuffix(transport)
            if base != name:
                return any(base + better in names for better in ("", *TRANSPORTS[:rank]))
        return False

    return [topic for topic in topics if not is_copy(topic.name)]


def depth_info_topic(candidates: list[CandidateTopic], topics: dict[Role, str]) -> str | None:
    """The camera_info beside the depth topic, unless it is colour's.

    Args:
        candidates: topics of the recording.
        topics: the topics chosen so far, by role.
    """
    infos = [topic for topic in candidates if topic.message_type == CAMERA_INFO]
    beside = info_beside(infos, topics[Role.DEPTH])
    return beside if beside != topics[Role.CAMERA_INFO] else None


def info_beside(infos: list[CandidateTopic], image: str) -> str | None:
    """The camera_info in an image topic's folder, as ROS drivers name it, else None.

    Args:
        infos: ``camera_info`` topics of the recording.
        image: an image topic.
    """
    parent = image.rpartition("/")[0]
    # image_transport adds a level: camera/image_raw/compressed belongs to camera/camera_info.
    for folder in (parent, parent.rpartition("/")[0]):
        if f"{folder}/camera_info" in [topic.name for topic in infos]:
            return f"{folder}/camera_info"
    return None


def transform_topics(candidates: list[CandidateTopic]) -> dict[Role, str]:
    """``/tf`` and ``/tf_static`` where they are; in a namespace, where there is one of each.

    Args:
        candidates: topics of the recording.
    """
    recorded = [topic.name for topic in candidates if topic.message_type == TRANSFORMS]
    chosen = {}
    for role, name in TRANSFORM_NAMES.items():
        fitting = [topic for topic in recorded if topic.endswith(name)]
        if name in fitting or len(fitting) == 1:
            chosen[role] = name if name in fitting else fitting[0]
    return chosen
