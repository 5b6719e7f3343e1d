# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Watches a scan's frames: whether depth and colours meet under their poses and intrinsics."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.agreement import DepthSample, motion
from reflest_core.fusion.poses.calibration import CalibrationCheck
from reflest_core.fusion.poses.conventions import Explanation, Pair, explanation_of
from reflest_core.fusion.poses.frozen_colours import FrozenColours
from reflest_core.fusion.poses.jumps import JumpDetector
from reflest_core.fusion.poses.registration import RegistrationCheck

LEAST_SHARE, FEW_PAIRS = 0.6, 0.4
"""Pairs do not meet where their median share is below the first less the second over the number of
pairs. Right poses give .7 to 1, wrong conventions 0 to .7; three pairs of a right capture .5."""
TRIED_SHARE = 0.9
"""Below this the usual conventions are tried: another may fit far better."""
FEWEST_PAIRS = 3
"""Pairs from which on a scan is judged."""
TURN = math.radians(10.0)
"""Least rotation between the frames of a pair, or else:"""
SHIFT = 0.15
"""their distance over the median depth."""
MOST_TURN = math.radians(40.0)
"""Frames further apart share little more than rims, which do not meet well."""
KEPT_PAIRS = 4
"""Pairs of frames that are kept for trying conventions."""
MOST_SHARES = 256
RETRY = 1.5
"""Conventions are tried again when there are so many times more pairs."""
RAY_PAIRS = 16
"""Pairs that are compared with depth read as a ray's length: it is the same in all of a scan."""
RAY_COST = 0.7
"""Depth is a ray's length where reading it so cuts the cost to less than this share."""

MIXED = (
    "surfaces from before and after are mixed: reset the scan, or set fusion.on_jump to new_scan "
    "or drop"
)


@dataclass(frozen=True)
class PoseReport:
    """What is known of a scan's poses.

    Attributes:
        pairs: Pairs of frames that were compared.
        agreement: Median share of depth that meets, in [0, 1]; NaN without pairs.
        worst: The least share of a pair; NaN without pairs.
        colour_agreement: Median correlation of colour detail from frame to frame, in [-1, 1], where
            their depth meets; NaN where nothing has texture.
        jumps: Jumps of the tracker since the scan began.
        problem: A sentence that says what is wrong and what to change, or "".
        warning: A sentence that says what may be wrong and what to check, or "".
        edge_agreement: Mean correlation of the edges of colours with those of depth; NaN where
            there are none.
    """

    pairs: int
    agreement: float
    worst: float
    colour_agreement: float
    jumps: int
    problem: str
    warning: str = ""
    edge_agreement: float = math.nan

    def to_json(self) -> dict[str, Any]:
        """Return the fields by name; null for NaN, no problem and no warning."""
        return {
            "pairs": self.pairs,
            "agreement": None if math.isnan(self.agreement) else self.agreement,
            "worst": None if math.isnan(self.worst) else self.worst,
            "colour_agreement": (
                None if math.isnan(self.colour_agreement) else self.colour_agreement
            ),
            "edge_agreement": None if math.isnan(self.edge_agreement) else self.edge_agreement,
            "jumps": self.jumps,
            "problem": self.problem or None,
            "warning": self.warning or None,
        }


class PoseCheck:
    """Compares every fused frame with the one before, and with one from another viewpoint."""

    def __init__(self) -> None:
        self._shares: deque[float] = deque(maxlen=MOST_SHARES)
        self._costs: list[tuple[float, float]] = []
        self._apart: deque[Pair] = deque(maxlen=KEPT_PAIRS)
        self._out_of_sight = 0
        self._reference: DepthSample | None = None
        self._detector = JumpDetector()
        self._frozen = FrozenColours()
        self._registration = RegistrationCheck()
        self._calibration = CalibrationCheck()
        self._jumps: list[int] = []
        self._dropped = MIXED
        self._judged: tuple[int, Explanation] = (0, Explanation())

    def add(self, frame: Frame, is_fused: bool = True) -> Frame | None:
        """Take the next frame.

        Args:
            frame: Later than the one before.
            is_fused: False where the scan refused the frame for its pose: it may show a jump, and
                is compared with the frame before alone.

        Returns:
            None, or where this frame confirms that the tracker jumped: the first frame after the
            jump, which is the one before ``frame``.
        """
        sample = DepthSample(frame)
        self._frozen.add(frame, sample)
        self._registration.add(frame)
        jump = self._detector.add(frame, sample)
        if jump is not None:
            self._jumps.append(frame.stamp_ns)
            self._dropped = MIXED
            self._refer_to(jump[1], is_after_jump=True)
        if is_fused:
            self._judge_pair(sample)
        self._registration.advance()
        self._calibration.advance()
        return None if jump is None else jump[0]

    def drop_before_jump(self, is_all: bool) -> None:
        """Note what becomes of the surface from before the last jump.

        Args:
            is_all: all of it was dropped; else what later frames contradict is.
        """
        self._dropped = (
            "what was scanned before the last was dropped"
            if is_all
            else "what later frames contradict of the surface from before is dropped"
        )

    def restart(self) -> None:
        """Compare the next frame with none before it, as after a jump of the clock."""
        self._reference = None
        self._detector.restart()
        self._frozen.restart()
        self._registration.restart()
        self._calibration.restart()

    @property
    def agreement(self) -> float:
        """Median share of depth that meets, in [0, 1]; NaN without pairs. For any thread."""
        shares = sorted(self._shares)
        return shares[len(shares) // 2] if shares else math.nan

    @property
    def colour_agreement(self) -> float:
        """Median correlation of colour detail from frame to frame; NaN where nothing has texture.

        For any thread.
        """
        return self._detector.colours.agreement

    @property
    def edge_agreement(self) -> float:
        """Mean correlation of the edges of colours and depth; NaN while unknown. For any thread."""
        return self._registration.fit

    @property
    def warning(self) -> str:
        """A sentence that says what may be wrong with the colours, or "". For any thread."""
        return self._registration.warning

    @property
    def jumps(self) -> int:
        """Jumps of the tracker since the scan began. For any thread."""
        return len(self._jumps)

    @property
    def report(self) -> PoseReport:
        """What all frames by now say, which may take a while to find out.

        For the thread that calls :meth:`add`.
        """
        self._registration.judge()
        self._calibration.judge()
        return self.latest_report

    @property
    def latest_report(self) -> PoseReport:
        """What has been found out by now, while frames come.

        Where pairs do not meet, the usual conventions are tried. For the thread that calls
        :meth:`add`.
        """
        middle = self.agreement
        return PoseReport(
            len(self._shares),
            middle,
            min(self._shares, default=math.nan),
            self.colour_agreement,
            len(self._jumps),
            self._problem(middle),
            self.warning,
            self.edge_agreement,
        )

    def _refer_to(self, sample: DepthSample, is_after_jump: bool = False) -> None:
        """Compare the next frames with this one."""
        self._reference = sample
        if is_after_jump:
            self._calibration.restart()
        self._calibration.add(sample)

    def _judge_pair(self, sample: DepthSample) -> None:
        """Compare with the reference once the camera has moved, then refer to this frame."""
        reference = self._reference
        if reference is None:
            self._refer_to(sample)
            return
        relative = reference.T_camera_world @ sample.pose
        turn, distance = motion(relative)
        shift = distance / max(reference.median_depth, 1e-6)
        if self._detector.is_pending or not (turn > TURN or shift > SHIFT):
            return
        self._refer_to(sample)
        if turn > MOST_TURN:
            return
        agreement = sample.meets(reference, relative)
        if not agreement.is_known:
            self._out_of_sight += 1
            self._apart.append((reference, sample))
            return
        self._apart.append((reference, sample))
        self._shares.append(agreement.share)
        if len(self._costs) < RAY_PAIRS:
            as_ray = sample.meets(reference, relative, is_ray=True)
            self._costs.append((agreement.cost, as_ray.cost))

    def _problem(self, middle: float) -> str:
        sentences = [
            self._convention(middle),
            self._ray_length(),
            self._frozen.problem,
            self._detector.colours.problem,
            self._registration.problem,
            self._jump(),
        ]
        return "; ".join(sentence for sentence in sentences if sentence)

    def _convention(self, middle: float) -> str:
        """What the usual mistakes say, and else what other intrinsics or another scale say."""
        measured = self._calibration.problem
        pairs = len(self._shares) + self._out_of_sight
        if pairs < FEWEST_PAIRS:
            return ""
        is_unseen = self._out_of_sight > len(self._shares)
        if not is_unseen and middle >= TRIED_SHARE:
            return measured
        if pairs >= RETRY * self._judged[0]:
            given = 0.0 if is_unseen else middle
            self._judged = pairs, explanation_of(list(self._apart), given)
        likely = self._judged[1].sentence or measured
        if self._registration.is_turned:  # which looks like a mirrored world
            likely = "of colours and depth, it is the depth images that seem to be turned"
        if is_unseen:
            return f"frames show nothing in common under their poses: {likely}" if likely else ""
        is_far_better = self._judged[1].is_found or bool(measured)
        if not is_far_better and middle >= LEAST_SHARE - FEW_PAIRS / len(self._shares):
            return ""
        advice = likely or (
            "check the frame whose pose is given, the unit of depth, the intrinsics and the stamps"
        )
        return f"only {middle:.0%} of the depth of frames meets under their poses: {advice}"

    def _ray_length(self) -> str:
        if len(self._costs) < FEWEST_PAIRS:
            return ""
        given, as_ray = (float(np.median(costs)) for costs in zip(*self._costs, strict=True))
        if as_ray > RAY_COST * given or given < 0.1:
            return ""
        return (
            "depth seems to be the distance along each pixel's ray, as some simulators give it: "
            "set capture.depth_kind to ray"
        )

    def _jump(self) -> str:
        if not self._jumps:
            return ""
        times = "once" if len(self._jumps) == 1 else f"{len(self._jumps)} times"
        return (
            f"the tracker jumped {times}, last at {self._jumps[-1] / 1e9:.3f} s (a loop closure or "
            f"a relocalisation?): {self._dropped}"
        )
