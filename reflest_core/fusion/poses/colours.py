# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Watches a scan's colours: whether they meet from frame to frame, and whether a step breaks them.

Two faults that depth cannot show: colours that belong to other frames, and a jump of the tracker
along a plane, which meets itself wherever it is moved. A surface without texture shows neither.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.agreement import DepthSample, motion
from reflest_core.fusion.poses.colour_agreement import (
    FEWEST,
    ColourAgreement,
    ReducedImage,
    colours_meet,
)

SAMPLES = 300
"""Samples of a frame that are compared with the frame before it."""

NEAR_TURN, NEAR_SHIFT = math.radians(12.5), 0.25
"""Colours are judged on steps of at most this rotation, and this share of the median depth: what a
mirror shows has changed beyond them."""
FEWEST_STEPS = 10
"""Steps from which on the colours of a scan are judged."""
MOST_STEPS = 64
UNRELATED = 0.12
"""Median correlation of detail below which colours do not meet. Right captures give 0.28 (a mirror)
to 0.93, and colours of other frames -0.05 to 0.05."""
OUT_OF_ORDER = 0.8
"""Difference of consecutive images over that of any two, from which on their order means nothing.
Right captures give 0.2 to 0.7 for such steps, shuffled ones 0.8 to 1.1."""
MOST_THUMBNAILS = 24
"""Earlier images that each is compared with."""

FIRST_STEPS, EVERY = 10, 8
"""So many steps at the beginning of a scan are compared, then every so many: for the time it takes.
Steps that may be a jump always are."""

SUDDEN_TURN, SUDDEN_SHIFT = math.radians(3.0), 0.06
"""Change from one step's motion to the next, as a rotation and along an axis as a share of the
median depth, from which on it may be a jump."""
EVEN = 1.6
"""Such a step must not have lasted longer than so many times the one before."""
USUAL_STEPS, FEWEST_USUAL = 6, 4
"""Latest compared steps that say how well colours usually meet, and how many there must be."""
CLEAR = 0.6
"""Only where colours met so well in each of these does a break stand out."""
BREAK = 0.75
"""A jump cuts the correlation to less than this share of the least usual one."""
STRAIGHT, STRAIGHT_SHARE = 0.25, 0.7
"""Colours meet better by so much, and to this share of the least usual correlation, if the camera
went on as in the step before."""
RESTORED = 0.8
"""Share of the least usual correlation that the step after a jump reaches again."""


@dataclass(frozen=True)
class PlacedFrame:
    """A frame with what is compared of it."""

    frame: Frame
    sample: DepthSample

    @cached_property
    def image(self) -> ReducedImage:
        """The frame's colours, reduced."""
        return ReducedImage.of(self.frame.rgb)

    def in_frame_of(self, other: PlacedFrame) -> NDArray[np.float64]:
        """Return this camera's pose in another frame's camera.

        Args:
            other: The other frame.

        Returns:
            (4, 4) float64.
        """
        return np.asarray(other.sample.T_camera_world @ self.sample.pose, np.float64)

    def colours_meet(
        self, earlier: PlacedFrame, T_earlier_self: NDArray[np.float64] | None = None
    ) -> ColourAgreement:
        """Compare this frame's colours with an earlier frame's.

        Args:
            earlier: The other frame.
            T_earlier_self: (4, 4) a pose to try in place of the given one.
        """
        transform = self.in_frame_of(earlier) if T_earlier_self is None else T_earlier_self
        of_earlier = earlier.sample, earlier.image
        return colours_meet((self.sample, self.image), of_earlier, transform, SAMPLES)


@dataclass(frozen=True)
class _Step:
    """From one frame to the next: the later camera's pose in the earlier one, and nanoseconds."""

    moved: NDArray[np.float64]
    lasted: int

    def is_sudden(self, later: _Step, depth: float) -> bool:
        """Whether the next step cannot be this motion going on."""
        if later.lasted > EVEN * self.lasted:
            return False
        here, there = self.moved, later.moved
        if float(np.abs(there[:3, 3] - here[:3, 3]).max()) > SUDDEN_SHIFT * depth:
            return True
        cosine = (float((here[:3, :3] * there[:3, :3]).sum()) - 1.0) / 2.0
        return cosine < math.cos(SUDDEN_TURN)


class ColourCheck:
    """Compares the colours of consecutive frames."""

    def __init__(self) -> None:
        self._correlations: deque[float] = deque(maxlen=MOST_STEPS)
        self._differences: deque[tuple[float, float]] = deque(maxlen=MOST_STEPS)
        self._thumbnails: deque[NDArray[np.float32]] = deque(maxlen=MOST_THUMBNAILS)
        self._usual: deque[float] = deque(maxlen=USUAL_STEPS)
        self._last: _Step | None = None
        self._steps = 0
        self._broken: tuple[PlacedFrame, NDArray[np.float64], float] | None = None

    @property
    def agreement(self) -> float:
        """Median correlation of detail, in [-1, 1]; NaN without steps. For any thread."""
        found = sorted(self._correlations)
        return found[len(found) // 2] if found else math.nan

    @property
    def problem(self) -> str:
        """A sentence where the colours do not belong to their frames, or ""."""
        if len(self._correlations) < FEWEST_STEPS or self.agreement >= UNRELATED:
            return ""
        near, any_two = np.array(self._differences).mean(axis=0)
        if near < OUT_OF_ORDER * any_two:
            return ""
        return (
            "the colours of consecutive frames do not meet where their depth does, and come in no "
            "order: each colour image seems to belong to another frame's depth and pose; check "
            "the images' stamps"
        )

    def restart(self) -> None:
        """Compare the next frame with none before it."""
        self._last = self._broken = None
        self._usual.clear()

    def add(self, earlier: PlacedFrame, later: PlacedFrame) -> bool:
        """Take the next step.

        Args:
            earlier: The frame before.
            later: The frame.

        Returns:
            Whether it confirms that the step before was a jump of the tracker.
        """
        moved = later.in_frame_of(earlier)
        before, self._broken = self._broken, None
        last, self._last = self._last, _Step(moved, later.frame.stamp_ns - earlier.frame.stamp_ns)
        is_sudden = last is not None and last.is_sudden(self._last, earlier.sample.median_depth)
        number, self._steps = self._steps, self._steps + 1
        if number >= FIRST_STEPS and number % EVERY and not is_sudden and before is None:
            return False
        step = later.colours_meet(earlier, moved)
        self._note(earlier, later, step, moved)
        if before is not None:
            return self._is_across(before, step, later, moved)
        if last is not None and is_sudden and self._is_broken(step, earlier, later, last.moved):
            self._broken = earlier, last.moved, min(self._usual)
        elif step.is_known:
            self._usual.append(step.correlation)
        return False

    def _note(
        self,
        earlier: PlacedFrame,
        later: PlacedFrame,
        step: ColourAgreement,
        moved: NDArray[np.float64],
    ) -> None:
        """Keep the correlation of a step, and how different its images are, beside any two."""
        turn, distance = motion(moved)
        is_near = turn <= NEAR_TURN and distance <= NEAR_SHIFT * earlier.sample.median_depth
        here = later.image.thumbnail
        others = [one for one in self._thumbnails if one.shape == here.shape]
        if step.is_known and is_near:
            self._correlations.append(step.correlation)
            if others and earlier.image.thumbnail.shape == here.shape:
                any_two = float(np.abs(np.stack(others) - here).mean())
                near = float(np.abs(earlier.image.thumbnail - here).mean())
                self._differences.append((near, any_two))
        self._thumbnails.append(earlier.image.thumbnail)

    def _is_broken(
        self,
        step: ColourAgreement,
        earlier: PlacedFrame,
        later: PlacedFrame,
        last: NDArray[np.float64],
    ) -> bool:
        """Whether colours stop meeting, and would meet if the camera had gone on as before."""
        least = min(self._usual, default=0.0)
        if len(self._usual) < FEWEST_USUAL or least < CLEAR:
            return False
        return _is_worse(step, BREAK * least) and _is_better(later, earlier, last, step, least)

    def _is_across(
        self,
        before: tuple[PlacedFrame, NDArray[np.float64], float],
        step: ColourAgreement,
        later: PlacedFrame,
        moved: NDArray[np.float64],
    ) -> bool:
        """Whether colours meet again after a broken step, but not those from before it."""
        frame, last, least = before
        self._usual.clear()
        if not step.is_known or step.correlation < RESTORED * least:
            return False
        across = later.colours_meet(frame)
        return _is_worse(across, BREAK * least) and _is_better(
            later, frame, last @ moved, across, least
        )


def _is_worse(found: ColourAgreement, limit: float) -> bool:
    return found.count >= FEWEST and found.correlation < limit


def _is_better(
    later: PlacedFrame,
    earlier: PlacedFrame,
    straight: NDArray[np.float64],
    found: ColourAgreement,
    least: float,
) -> bool:
    """Whether colours meet clearly better if the camera moved straight on."""
    tried = later.colours_meet(earlier, straight)
    limit = max(found.correlation + STRAIGHT, STRAIGHT_SHARE * least)
    return tried.is_known and tried.correlation > limit
