# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Finds jumps of the tracker: steps between consecutive frames that frames or time contradict.

A step is contradicted where the two depth maps stop meeting, and where they share nothing although
the images look alike. A step that is too fast is contradicted unless the depth maps meet well.
Where depth contradicts nothing, as along a plane, colours may (:mod:`.colours`).
"""

from __future__ import annotations

import math
import statistics
from collections import deque

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.agreement import Agreement, DepthSample, motion
from reflest_core.fusion.poses.colours import ColourCheck, PlacedFrame

STEADY = 0.8
"""Consecutive frames must have agreed so well for a jump to stand out."""
JUMP = 0.5
"""A jump cuts the agreement to less than this share of what it was."""
FAST_JUMP = 0.85
"""The same for a step that is too fast."""
FAST_COMMON = 0.65
"""The same of the share of all samples that are in sight of both frames and agree: a plane meets
itself wherever it is moved, but less of it is in sight of both."""
AGREEING = 0.6
"""Agreement of frames after a jump where the usual one is not known."""
STEP_SAMPLES = 300
"""Samples of a frame that are compared with the frame before it."""
FEWEST_STEPS = 3
"""Steps from which on the usual agreement is known."""
MOST_PENDING = 3
"""Contradicted steps in a row that may be one jump: poses are interpolated across it. After more
of them the poses are wrong, or the stamps are, and speeds are usual."""

SPEED = 2.5
"""Metres a second beyond which a step is too fast, unless recent ones were about as fast."""
TURN_RATE = math.radians(250.0)
"""The same in radians a second."""
FASTER = 2.0
"""A step is too fast only beyond so many times the fastest recent one."""
FIRST_SPEED = 100.0
"""Metres a second beyond which the first step is too fast: nothing is known of the stamps yet."""
SHORTEST = 0.03
"""Seconds that a step takes at least: stamps of images without a clock may be made up."""

APART_SHIFT = 0.25
"""Frames may be known to share nothing where they are apart by this share of the median depth,"""
APART_TURN = math.radians(20.0)
"""or by this angle."""
ALIKE = 0.35
"""Images are alike whose thumbnails differ by less than this share of what unrelated pixels do.
Consecutive frames give 0.1 to 0.6, frames that share nothing 0.65 and more."""
THUMBNAIL = 8
"""Rows and columns of a thumbnail."""


class JumpDetector:
    """Watches consecutive frames; a frame after the jump confirms it.

    After a jump the new frames agree among themselves; after one bad frame they do not.

    Attributes:
        colours: how well the colours of consecutive frames meet.
    """

    def __init__(self) -> None:
        self.colours = ColourCheck()
        self._steady: deque[float] = deque(maxlen=9)
        self._common: deque[float] = deque(maxlen=9)
        self._speeds: deque[tuple[float, float]] = deque(maxlen=9)
        self._previous: PlacedFrame | None = None
        self._before: PlacedFrame | None = None
        self._contradicted = 0

    @property
    def is_pending(self) -> bool:
        """Whether the last step was contradicted and nothing confirms a jump yet."""
        return self._before is not None

    def add(self, frame: Frame, sample: DepthSample) -> tuple[Frame, DepthSample] | None:
        """Take the next frame.

        Args:
            frame: Later than the one before.
            sample: Of the frame's depth.

        Returns:
            None, or where this frame confirms a jump: the first frame after it, which is the one
            before ``frame``, and its sample.
        """
        previous, self._previous = self._previous, PlacedFrame(frame, sample)
        if previous is None:
            return None
        step = _met(previous, self._previous)
        is_jump_by_colour = self.colours.add(previous, self._previous)
        if self._is_contradicted(previous, self._previous, step):
            self._contradicted += 1
            if self._contradicted == 1:
                self._before = previous
            elif self._contradicted > MOST_PENDING:
                self._before = None
                self._speeds.append(_speeds(previous, self._previous))
            return None
        usual = self._usual
        before = self._forget_pending()
        is_jump = (
            before is not None
            and step.is_known
            and step.share >= (STEADY * usual or AGREEING)
            and self._is_across_jump(before, previous, self._previous)
        )
        self._speeds.append(_speeds(previous, self._previous))
        if step.is_known:
            self._steady.append(step.share)
            self._common.append(_common(step, self._previous))
        return (previous.frame, previous.sample) if is_jump or is_jump_by_colour else None

    def restart(self) -> None:
        """Compare the next frame with none before it, as after a jump of the clock."""
        self._previous = None
        self._forget_pending()
        self.colours.restart()

    def _forget_pending(self) -> PlacedFrame | None:
        before, self._before, self._contradicted = self._before, None, 0
        return before

    @property
    def _usual(self) -> float:
        """Usual agreement of consecutive frames; 0 where it is unknown or poor."""
        if len(self._steady) < FEWEST_STEPS:
            return 0.0
        usual = statistics.median(self._steady)
        return usual if usual >= STEADY else 0.0

    def _is_across_jump(self, before: PlacedFrame, first: PlacedFrame, later: PlacedFrame) -> bool:
        """Whether what came after contradicted steps does not meet what was before them."""
        if not self._is_contradicted(before, first, _met(before, first)):
            return False
        if self._is_too_fast(before, first):
            return True
        across = _met(before, later)
        return not across.is_known or across.share < JUMP * self._usual

    def _is_contradicted(self, earlier: PlacedFrame, later: PlacedFrame, step: Agreement) -> bool:
        is_too_fast = self._is_too_fast(earlier, later)
        if not step.is_known:
            return is_too_fast or (
                self._usual > 0.0 and _are_apart(earlier, later) and _are_alike(earlier, later)
            )
        if not is_too_fast:
            return step.share < JUMP * self._usual
        usual = self._usual or min([STEADY, *self._steady])
        usual_common = statistics.median(self._common) if self._usual else 0.0
        return step.share < FAST_JUMP * usual or _common(step, later) < FAST_COMMON * usual_common

    def _is_too_fast(self, earlier: PlacedFrame, later: PlacedFrame) -> bool:
        speed, turn_rate = _speeds(earlier, later)
        if not self._speeds:
            return not speed <= FIRST_SPEED
        fastest, fastest_turn = (max(recent) for recent in zip(*self._speeds, strict=True))
        return not (
            speed <= max(SPEED, FASTER * fastest)
            and turn_rate <= max(TURN_RATE, FASTER * fastest_turn)
        )


def _met(earlier: PlacedFrame, later: PlacedFrame) -> Agreement:
    return later.sample.meets(earlier.sample, later.in_frame_of(earlier), most=STEP_SAMPLES)


def _common(step: Agreement, later: PlacedFrame) -> float:
    """Share of all compared samples that agree, in sight of both frames or not."""
    size = later.sample.size
    return step.share * step.count * max(size // STEP_SAMPLES, 1) / max(size, 1)


def _speeds(earlier: PlacedFrame, later: PlacedFrame) -> tuple[float, float]:
    """Metres and radians a second between two frames."""
    turn, distance = motion(later.in_frame_of(earlier))
    seconds = max((later.frame.stamp_ns - earlier.frame.stamp_ns) * 1e-9, SHORTEST)
    return distance / seconds, turn / seconds


def _are_apart(earlier: PlacedFrame, later: PlacedFrame) -> bool:
    """Whether the poses can be why the depth maps share nothing, not gaps in the depth."""
    turn, distance = motion(later.in_frame_of(earlier))
    depth = earlier.sample.median_depth
    return depth > 0.0 and (turn > APART_TURN or distance > APART_SHIFT * depth)


def _are_alike(earlier: PlacedFrame, later: PlacedFrame) -> bool:
    """Whether two images nearly show the same."""
    here, there = _thumbnail(earlier), _thumbnail(later)
    if here.shape != there.shape:
        return False
    unrelated = float(np.abs(here[:, None] - there[None]).mean())
    return float(np.abs(here - there).mean()) < ALIKE * unrelated


def _thumbnail(placed: PlacedFrame) -> NDArray[np.float32]:
    """Mean colours of the image's cells, (THUMBNAIL**2, 3)."""
    height, width = (max(size // THUMBNAIL, 1) for size in placed.frame.rgb.shape[:2])
    cells = placed.frame.rgb[: height * THUMBNAIL, : width * THUMBNAIL].astype(np.float32)
    rows = np.add.reduceat(cells, np.arange(0, len(cells), height), axis=0)
    whole = np.add.reduceat(rows, np.arange(0, cells.shape[1], width), axis=1)
    return np.asarray(whole.reshape(-1, 3) / (height * width), np.float32)
