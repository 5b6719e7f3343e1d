# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Finds intrinsics, a mounting or a scale of positions under which views far apart meet.

A wrong value is named where nearly every pair of views meets better under another one, and then as
well as the views of a right capture do.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace

import numpy as np

from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.distant_views import Meeting, Reading, View, ViewPairs
from reflest_core.fusion.poses.stepwise import StepwiseWork

MOST_VIEWS = 24
FEWEST_PAIRS = 6
"""Pairs of views from which on a capture is judged."""
FEWEST_VIEWS = 4
"""Views from which on it is judged."""
RETRY = 2.0
"""It is judged again when there are so many times more views."""
STEPS_OF_FRAME = 16
"""Readings that are compared at each frame, of 0.1 to 0.25 ms each."""
COARSE, COARSE_STEP, MAY_BE_LOWER = 3, 1 / 4, 0.95
"""Whether a near reading may cost less is searched on every so many samples, with such last steps
over the first; all readings are searched where it costs less than such a share."""
CLEAR = 0.04
"""Cost below which nothing is searched: focal lengths off by 5 % cost 0.05 to 0.4."""
POOR = 0.3
"""Cost from which on all readings are searched; else only if one that is near costs less."""
LOWER = 0.9
"""A reading's cost is less than this share of the given one's: right captures give 0.96 to 1."""
NEARLY_EVERY = 0.95
"""Share of pairs that each meet better."""
MEETS = 0.8
"""Median share of samples that meet under the reading: captures with exact poses give 0.78 to 1."""
FAR_MORE, MEETS_COARSELY = 1.8, 0.45
"""Or else so many times more meet than as given, and at least the second share: a tracker's poses
and real depth give 0.48 to 0.72. Of right captures 1.12 times more meet at most."""
AS_WELL = 1.1, 0.01
"""A simpler reading is as good where its cost is less than the best times the first plus the
second."""
FOCALS = (0.5, 0.6, 0.67, 0.75, 0.85, 1.0, 1.15, 1.33, 1.5, 1.7, 2.0)
"""Factors from which the search begins."""
SCALES = (0.5, 0.7, 0.85, 1.0, 1.15, 1.4, 2.0)
STARTS = 2
"""The search goes on from so many of the best of these."""
STEPS = {
    "focal": 0.06,
    "right": 0.01,
    "down": 0.01,
    "scale": 0.06,
    "x": 0.01,
    "y": 0.01,
    "z": 0.01,
}
"""First steps of the search: of factors, relative; of the centre, shares of the focal length; of
the mounting, metres."""
FINEST = 1 / 16
"""The last steps over the first."""
LEAST_FACTOR, LEAST_SHIFT, LEAST_MOVE = 0.02, 0.008, 0.005
"""Smaller deviations are not named: they do not matter beside a sensor's own errors."""
FOCAL, SCALE, CENTRE, MOUNTING = ("focal",), ("scale",), ("right", "down"), ("x", "y", "z")
READINGS: tuple[tuple[str, ...], ...] = (FOCAL, SCALE, CENTRE, MOUNTING, (*FOCAL, *CENTRE))
"""What is searched together, the simplest first."""


class CalibrationCheck:
    """Keeps views of a scan and searches the intrinsics under which they meet.

    Attributes:
        problem: A sentence that names what seems wrong, by how much, and what to change, or "".
    """

    def __init__(self) -> None:
        self.problem = ""
        self._views: deque[View] = deque(maxlen=MOST_VIEWS)
        self._added = self._judged = 0
        self._focals = (0.0, 0.0)
        self._work = StepwiseWork()

    def add(self, sample: DepthSample) -> None:
        """Take a view.

        Args:
            sample: Of a frame from another viewpoint than the last view.
        """
        if sample.size:
            self._views.append(View(sample))
            self._focals = float(sample.pinhole[0]), float(sample.pinhole[1])
            self._added += 1

    def restart(self) -> None:
        """Compare the next view with none before it."""
        self._views.clear()
        self._work.cancel()
        self._added = self._judged = 0

    def advance(self) -> None:
        """Do a frame's share of a judgement, if enough more views were added since the last."""
        if not self._work.is_running and self._added >= RETRY * self._judged:
            self._begin()
        self._work.advance(STEPS_OF_FRAME)

    def judge(self) -> None:
        """Compare all views that were added, at once."""
        self._work.finish()
        if self._added > self._judged:
            self._begin()
            self._work.finish()

    def _begin(self) -> None:
        if len(self._views) >= FEWEST_VIEWS:
            self._judged = self._added
            self._work.start(self._judge(list(self._views)))

    def _judge(self, views: Sequence[View]) -> Iterator[None]:
        pairs = ViewPairs(views)
        yield
        if len(pairs) < FEWEST_PAIRS:
            return
        readings = yield from _best_readings(pairs)
        if readings:
            parts, advice = zip(*(self._described(reading) for reading in readings), strict=True)
            self.problem = (
                f"views far apart meet clearly better under {', or under '.join(parts)}: check "
                f"{'; '.join(advice)}"
            )
        else:
            self.problem = ""

    def _described(self, reading: Reading) -> tuple[str, str]:
        """What a reading changes, and what to check then."""
        parts, advice = [], []
        if reading.focal != 1.0:
            parts.append(f"focal lengths {_factor(reading.focal)}")
            advice.append("that camera_info is of the images' resolution and crop")
        if reading.right or reading.down:
            right, down = reading.right * self._focals[0], reading.down * self._focals[1]
            parts.append(f"a centre moved by {right:+.0f} (cx) and {down:+.0f} (cy) pixels")
            advice.append("cx and cy, and the rotation of capture.pose_to_camera")
        if reading.scale != 1.0:
            parts.append(f"positions {_factor(reading.scale)}")
            advice.append("the tracker's unit and capture.depth_scale")
        if reading.x or reading.y or reading.z:
            place = f"{reading.x:+.3f} (right), {reading.y:+.3f} (down), {reading.z:+.3f} (forward)"
            parts.append(f"a camera moved against its pose by {place} m")
            advice.append("the position in capture.pose_to_camera")
        return " and ".join(parts), " and ".join(advice)


def _factor(factor: float) -> str:
    longer = factor > 1.0
    return f"{factor if longer else 1.0 / factor:.3g} times {'longer' if longer else 'shorter'}"


def _best_readings(pairs: ViewPairs) -> Generator[None, None, list[Reading]]:
    """Find the simplest reading under which the views meet as those of a right capture.

    Yields:
        Nothing, after each comparison of all pairs.

    Returns:
        One; two where a wrong centre and a wrong mounting explain the views as well; or none.
    """
    given = pairs.meet(Reading())
    if given.cost < CLEAR:
        return []
    if given.cost < POOR:
        least = given.cost
        for names in READINGS[-2:]:
            reading = yield from _searched(pairs, names, (Reading(),), COARSE, COARSE_STEP)
            least = min(least, pairs.meet(reading).cost)
        if least >= MAY_BE_LOWER * given.cost:
            return []
    found = []
    for names in READINGS:
        starts = [Reading()]
        if "focal" in names:
            starts = [Reading(focal=factor) for factor in FOCALS]
        elif "scale" in names:
            starts = [Reading(scale=factor) for factor in SCALES]
        reading = yield from _searched(pairs, names, starts)
        found.append((pairs.meet(reading).cost, reading))
    limit = AS_WELL[0] * min(cost for cost, _ in found) + AS_WELL[1]
    as_good = {
        names: _without_trifles(reading)
        for names, (cost, reading) in zip(READINGS, found, strict=True)
        if cost <= limit
    }
    names, reading = next(iter(as_good.items()))
    if reading == Reading() or not _is_clear(given, pairs.meet(reading)):
        return []
    if names == FOCAL and SCALE in as_good:
        return []
    if float(np.median(pairs.meet(reading).shares)) < MEETS and any(
        other not in (names, names[:1], names[1:]) and _is_clear(given, pairs.meet(one))
        for other, (_, one) in zip(READINGS[:-1], found, strict=False)
    ):
        return []  # coarse poses: a wrong one may fit better than the right one
    return [reading, as_good[MOUNTING]] if names == CENTRE and MOUNTING in as_good else [reading]


def _is_clear(given: Meeting, found: Meeting) -> bool:
    before, after = float(np.median(given.shares)), float(np.median(found.shares))
    if found.cost > LOWER * given.cost:
        return False
    if after < MEETS and after < max(MEETS_COARSELY, FAR_MORE * before):
        return False
    return float((found.costs < given.costs).mean()) >= NEARLY_EVERY


def _without_trifles(reading: Reading) -> Reading:
    """Take deviations that do not matter as none."""
    found = reading
    if abs(math.log(reading.focal)) < LEAST_FACTOR:
        found = replace(found, focal=1.0)
    if abs(math.log(reading.scale)) < LEAST_FACTOR:
        found = replace(found, scale=1.0)
    if math.hypot(reading.right, reading.down) < LEAST_SHIFT:
        found = replace(found, right=0.0, down=0.0)
    if math.hypot(reading.x, reading.y, reading.z) < LEAST_MOVE:
        found = replace(found, x=0.0, y=0.0, z=0.0)
    return found


def _searched(
    pairs: ViewPairs,
    names: Sequence[str],
    starts: Sequence[Reading],
    stride: int = 1,
    finest: float = FINEST,
) -> Generator[None, None, Reading]:
    """Descend along one parameter after the other, by steps that halve."""
    costs = []
    for number, start in enumerate(starts):
        costs.append((pairs.meet(start, stride).cost, number))
        yield
    best, best_cost = Reading(), math.inf
    for cost, number in sorted(costs)[:STARTS]:
        reading, size = starts[number], 1.0
        while size >= finest:
            nearer = [_stepped(reading, name, sign * size) for name in names for sign in (1, -1)]
            tried = []
            for place, one in enumerate(nearer):
                tried.append((pairs.meet(one, stride).cost, place))
                yield
            least, place = min(tried)
            if least < cost - 1e-6:
                cost, reading = least, nearer[place]
            else:
                size /= 2.0
        if cost < best_cost:
            best, best_cost = reading, cost
    return best


def _stepped(reading: Reading, name: str, size: float) -> Reading:
    value, step = getattr(reading, name), STEPS[name] * size
    is_factor = name in ("focal", "scale")
    return replace(reading, **{name: value * math.exp(step) if is_factor else value + step})
