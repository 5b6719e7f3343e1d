# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the node shows besides the estimate itself."""

from __future__ import annotations

from typing import Protocol

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.scanner import KeyframeSnapshot


class EstimateView(Protocol):
    """A publisher of something to look at; made at configure, destroyed at cleanup.

    No two methods run at once. What they raise ends the node: nothing may go wrong in them.
    """

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Publish the state at a keyframe, in the estimation thread.

        ``estimate`` is None where the keyframe shows too little for one.
        """

    def clear(self) -> None:
        """Forget what was shown: the scan was emptied or replaced."""

    def destroy(self) -> None:
        """Give the publishers back."""
