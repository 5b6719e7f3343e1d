# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which recorded topic plays which role: by type where that is unambiguous, else by name."""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.capture.formats.cdr import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    ODOMETRY,
    POSE_STAMPED,
)
from reflest_core.capture.formats.recorded_topics import (
    CandidateTopic,
    depth_info_topic,
    info_beside,
    transform_topics,
    without_copies,
)
from reflest_core.capture.images.decode import COLOUR_ENCODINGS, DEPTH_ENCODINGS, MASK_ENCODINGS
from reflest_core.capture.messages import Role
from reflest_core.capture.refusal import CaptureError

OPTION = {role: f"--{role.value.replace('_', '-')}-topic" for role in Role}
TYPES = {
    Role.RGB: (IMAGE, COMPRESSED_IMAGE),
    Role.DEPTH: (IMAGE, COMPRESSED_IMAGE),
    Role.CAMERA_INFO: (CAMERA_INFO,),
    Role.POSE: (POSE_STAMPED, ODOMETRY),
    Role.MASK: (IMAGE, COMPRESSED_IMAGE),
    Role.DEPTH_INFO: (CAMERA_INFO,),
}
ENCODINGS = {
    Role.RGB: (*COLOUR_ENCODINGS, "jpeg", "png"),
    Role.DEPTH: (*DEPTH_ENCODINGS, "compressedDepth", "16-bit png"),
    Role.MASK: (*MASK_ENCODINGS, "png"),
}


@dataclass(frozen=True)
class TopicChoice:
    """Topics that the user named; None: to be found. A mask is used only if named.

    Attributes:
        rgb: Colour images.
        depth: Depth images.
        camera_info: Calibration of the colour camera.
        pose: Poses or odometry.
        mask: Masks of the object.
        depth_camera_info: Calibration of the depth camera.
    """

    rgb: str | None = None
    depth: str | None = None
    camera_info: str | None = None
    pose: str | None = None
    mask: str | None = None
    depth_camera_info: str | None = None

    def named(self, role: Role) -> str | None:
        """Return the topic named for ``role``.

        Args:
            role: the stream of the message.
        """
        name: str | None = getattr(self, role.value)
        return name


def choose_topics(
    candidates: list[CandidateTopic], choice: TopicChoice, capture: str, pose_source: str = "pose"
) -> dict[Role, str]:
    """Return the topic of each role; a mask only where one is named, no pose where tf has it.

    Args:
        candidates: topics of the recording.
        choice: topics that the user named.
        capture: how sentences name the recording.
        pose_source: parameter ``capture.pose_source``.

    Raises:
        CaptureError: a topic is missing, of the wrong type or ambiguous; the sentence lists the
            topics that would fit and the option to set.
    """
    topics: dict[Role, str] = {}
    needed = [Role.RGB, Role.DEPTH, Role.CAMERA_INFO]
    for role in needed if pose_source == "tf" else [*needed, Role.POSE]:
        fitting = without_copies([topic for topic in candidates if _fits(topic, role)])
        if role is Role.RGB:
            fitting = _without_grey(fitting)
        if role is Role.CAMERA_INFO:
            fitting = _of_camera(fitting, topics[Role.RGB])
        topics[role] = _chosen(role, choice, candidates, fitting, capture)
    for role in (Role.MASK, Role.DEPTH_INFO):
        if choice.named(role) is not None:
            topics[role] = _chosen(role, choice, candidates, [], capture)
    depth_info = depth_info_topic(candidates, topics)
    if depth_info is not None:
        topics.setdefault(Role.DEPTH_INFO, depth_info)
    topics |= transform_topics(candidates)
    if pose_source == "tf" and Role.TF not in topics and Role.TF_STATIC not in topics:
        raise CaptureError(
            f"{capture} has no /tf or /tf_static to take poses from; it holds {_listed(candidates)}"
        )
    return topics


def _chosen(
    role: Role,
    choice: TopicChoice,
    candidates: list[CandidateTopic],
    fitting: list[CandidateTopic],
    capture: str,
) -> str:
    of_type = [topic for topic in candidates if topic.message_type in TYPES[role]]
    named = choice.named(role)
    if named is not None:
        if named in [topic.name for topic in of_type]:
            return named
        raise CaptureError(
            f"{capture} has no topic {named} that could be {role.value}: "
            f"{OPTION[role]} may be {_listed(of_type)}"
        )
    if len(fitting) == 1:
        return fitting[0].name
    if fitting:
        raise CaptureError(
            f"{capture} has {len(fitting)} topics that could be {role.value}: choose one with "
            f"{OPTION[role]}: {_listed(fitting)}"
        )
    raise CaptureError(_nothing_fits(role, of_type, candidates, capture))


def _nothing_fits(
    role: Role, of_type: list[CandidateTopic], candidates: list[CandidateTopic], capture: str
) -> str:
    types = " or ".join(TYPES[role])
    if role in ENCODINGS:
        types += f" in {', '.join(ENCODINGS[role])}"
    sentence = f"{capture} has no {role.value} topic ({types})"
    if role is Role.POSE and transform_topics(candidates):
        return f"{sentence}; it holds /tf: take poses from it with --world-frame (map or odom, say)"
    if of_type:
        return f"{sentence}; of that type there is {_listed(of_type)} ({OPTION[role]})"
    return f"{sentence}; it holds {_listed(candidates)}"


def _listed(topics: list[CandidateTopic]) -> str:
    return ", ".join(map(str, topics)) or "nothing of that type"


def _fits(topic: CandidateTopic, role: Role) -> bool:
    if topic.message_type not in TYPES[role]:
        return False
    if role not in ENCODINGS:
        return True
    # "16UC1; png compressed" and "32FC1; compressedDepth rvl" begin with the image's encoding.
    encoding = topic.encoding.split(";")[0].strip()
    is_depth = encoding in DEPTH_ENCODINGS or "compressedDepth" in topic.encoding
    if role is Role.DEPTH:
        # Infrared is mono16, too.
        return is_depth and (encoding != "mono16" or "depth" in topic.name.lower())
    if topic.message_type == COMPRESSED_IMAGE:
        return not is_depth and topic.encoding != ""
    return topic.encoding in COLOUR_ENCODINGS


def _without_grey(fitting: list[CandidateTopic]) -> list[CandidateTopic]:
    """Leave infrared and masks out where there is true colour."""
    return [topic for topic in fitting if topic.encoding != "mono8"] or fitting


def _of_camera(infos: list[CandidateTopic], rgb: str) -> list[CandidateTopic]:
    """Of several, prefer the one beside the colour topic."""
    beside = info_beside(infos, rgb)
    return [topic for topic in infos if topic.name == beside] or infos
