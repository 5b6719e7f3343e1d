# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The tree of coordinate frames of ``/tf`` and ``/tf_static``, at any stamp.

Fed by messages alone, live or from a bag. What is not known is refused: it never becomes the
identity, and nothing is extrapolated.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.messages import PoseMessage, TransformsMessage, plain_frame
from reflest_core.capture.pose import check_pose, quaternion_of
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.sync.transform_track import TransformTrack

MOST_FRAMES = 4096
MOST_NAMED = 8


class TransformBuffer:
    """Every frame's recent poses in its parent."""

    def __init__(self, longest_gap: float, jump: float) -> None:
        """Begin without transforms.

        Args:
            longest_gap: seconds between two transforms that are interpolated at most.
            jump: seconds back that count as a clock that was reset.
        """
        self._longest_gap = longest_gap
        self._jump_ns = round(jump * 1e9)
        self._tracks: dict[str, TransformTrack] = {}

    def add(self, message: TransformsMessage, is_static: bool, topic: str) -> list[FrameRefused]:
        """Take what is right in a message; return a TRANSFORM_INVALID for each that is not.

        Args:
            message: as it was received or recorded.
            is_static: whether they hold for all times.
            topic: how sentences name the stream.
        """
        refusals = []
        for transform in message.transforms:
            try:
                self._add(_checked(transform, topic), is_static, topic)
            except FrameRefused as refusal:
                refusals.append(refusal)
        return refusals

    def forget_after(self, stamp_ns: int) -> None:
        """Forget what moves and has come past a stamp, as after a clock jump.

        Args:
            stamp_ns: nanoseconds.
        """
        self._tracks = {
            name: track
            for name, track in self._tracks.items()
            if track.is_static or not track.has_reached(stamp_ns)
        }

    def has_reached(self, target: str, source: str, stamp_ns: int) -> bool:
        """Whether no later message can change :meth:`matrix`.

        Args:
            target: frame to transform to.
            source: frame to transform from.
            stamp_ns: nanoseconds.
        """
        path = self._path(target, source)
        return path is not None and all(
            self._tracks[frame].has_reached(stamp_ns) for frame in (*path[0], *path[1])
        )

    def matrix(self, target: str, source: str, stamp_ns: int) -> NDArray[np.float64]:
        """Return ``T_target_source`` (4, 4): points in ``source`` to points in ``target``.

        Args:
            target: frame to transform to.
            source: frame to transform from.
            stamp_ns: nanoseconds.

        Raises:
            FrameRefused: TRANSFORM_MISSING, naming the frame that is not known at the stamp.
        """
        path = self._path(target, source)
        if path is None:
            raise FrameRefused(RefusalCause.TRANSFORM_MISSING, self._unconnected(target, source))
        to_target, to_source = (self._climbed(frames, stamp_ns) for frames in path)
        return np.asarray(np.linalg.inv(to_target) @ to_source)

    def pose(self, world: str, frame: str, stamp_ns: int) -> PoseMessage:
        """Return the pose of ``frame`` in ``world`` as a message; raises as :meth:`matrix`.

        Args:
            world: world frame.
            frame: frame whose pose is asked for.
            stamp_ns: nanoseconds.
        """
        matrix = self.matrix(world, frame, stamp_ns)
        x, y, z = matrix[:3, 3].tolist()
        return PoseMessage(stamp_ns, world, (x, y, z), quaternion_of(matrix[:3, :3]), frame)

    def _add(self, transform: PoseMessage, is_static: bool, topic: str) -> None:
        child = transform.child_frame_id
        known = self._tracks.get(child)
        if known and known.is_static and not is_static and known.is_at(transform):
            return  # a static transform that is also published slowly
        if known and known.parent == transform.frame_id and known.is_static == is_static:
            known.add(transform)
        elif known or len(self._tracks) < MOST_FRAMES:
            self._tracks[child] = TransformTrack(transform, is_static, self._jump_ns)
        else:
            raise _invalid(topic, f"more than {MOST_FRAMES} frames: {child!r} is left out")

    def _ancestry(self, frame: str) -> list[str]:
        """``frame``, its parent, and so on to the root."""
        chain = [plain_frame(frame)]
        while (track := self._tracks.get(chain[-1])) and track.parent not in chain:
            chain.append(track.parent)
        return chain

    def _path(self, target: str, source: str) -> tuple[list[str], list[str]] | None:
        """Frames below the nearest common ancestor: target's side, source's side, each upwards."""
        above_target, above_source = self._ancestry(target), self._ancestry(source)
        for height, frame in enumerate(above_target):
            if frame in above_source:
                return above_target[:height], above_source[: above_source.index(frame)]
        return None

    def _climbed(self, frames: list[str], stamp_ns: int) -> NDArray[np.float64]:
        """The pose of the first of ``frames`` in the parent of the last, (4, 4)."""
        matrix = np.eye(4)
        for frame in frames:
            matrix = self._tracks[frame].matrix_at(stamp_ns, self._longest_gap) @ matrix
        return matrix

    def _unconnected(self, target: str, source: str) -> str:
        known = sorted({*self._tracks, *(track.parent for track in self._tracks.values())})
        listed = ", ".join(known[:MOST_NAMED]) + (", ..." if len(known) > MOST_NAMED else "")
        return (
            f"no transform from {source!r} to {target!r}: tf "
            f"{f'knows {listed} and does not join the two' if known else 'holds nothing yet'}; "
            "publish the missing one, or set capture.world_frame and the images' frame_id rightly"
        )


def _checked(transform: PoseMessage, topic: str) -> PoseMessage:
    parent, child = plain_frame(transform.frame_id), plain_frame(transform.child_frame_id)
    if not parent or not child or parent == child:
        raise _invalid(topic, f"the transform of {child!r} in {parent!r} joins no two frames")
    try:
        check_pose(transform, f"{topic} ({child} in {parent})")
    except FrameRefused as refusal:
        raise FrameRefused(RefusalCause.TRANSFORM_INVALID, str(refusal)) from refusal
    return replace(transform, frame_id=parent, child_frame_id=child)


def _invalid(topic: str, why: str) -> FrameRefused:
    return FrameRefused(
        RefusalCause.TRANSFORM_INVALID, f"{topic}: {why}; check the publisher of that transform"
    )
