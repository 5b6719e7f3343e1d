# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A problem with a scan's poses, as part of its estimates and of the reasons why there are none."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace

from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.fusion.poses.check import PoseReport

LONGEST_TEXT = 512
"""The message's bound on ``status_text``."""


@contextlib.contextmanager
def poses_explain(poses: PoseReport | None) -> Iterator[None]:
    """Put a problem with the poses before the reason why there is no estimate.

    Args:
        poses: What is known of them, if anything.

    Raises:
        NoEstimate: The block did; with the problem, if there is one.
    """
    try:
        yield
    except NoEstimate as reason:
        if poses is None or not poses.problem:
            raise
        raise NoEstimate(f"{poses.problem}; {reason}") from None


def with_poses(estimate: BrdfEstimate, poses: PoseReport | None) -> BrdfEstimate:
    """Add what is known of the poses; a problem with them is the most severe warning.

    Args:
        estimate: Of any of the scan's materials.
        poses: What is known of them, if anything.

    Returns:
        The estimate with the agreement of depth, and the problem before its other warnings.
    """
    if poses is None:
        return estimate
    if not poses.problem:
        return replace(estimate, depth_agreement=poses.agreement)
    sentences = [poses.problem]
    for sentence in filter(None, estimate.status_text.split("; ")):
        if len("; ".join([*sentences, sentence])) > LONGEST_TEXT:
            break
        sentences.append(sentence)
    return replace(
        estimate,
        depth_agreement=poses.agreement,
        status=EstimateStatus.INCONSISTENT_POSES,
        status_text="; ".join(sentences)[:LONGEST_TEXT],
    )
