# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which scans of which scenes are simulated, and by which code."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from reflest_core.models.lightnet import VOXELS
from reflest_core.source_fingerprint import source_fingerprint
from reflest_core.training.light.scan_file import AXES
from reflest_core.training.light.simulated_scan import ScanDraw, training_draw

MEASURED_VIEWS = (100, 30, 10)
"""A scene that is measured is scanned with so many of its views, as they are."""
SOURCES = (
    "reflest_core.training.light.scan_plan",
    "reflest_core.training.light.simulated_scan",
    "reflest_core.training.light.scan_file",
)
"""Modules that, with all that they import, decide what a simulated scan holds."""
SCAN_PARTS = ("completion", "visibility")
"""Parts of ``lightnet`` that its features have: to do without them needs scans of their own."""


@dataclass(frozen=True)
class ScanPlan:
    """Scans of the scenes of a split.

    Attributes:
        split: ``train`` or ``validation``.
        varied: How many scans of each scene, with views, exposure and faults as drawn by
            :func:`training_draw`; 0: one for each of :data:`MEASURED_VIEWS`.
        only: Environments; scans are of scenes under one of them, unmixed. Empty: of all scenes.
        without: Parts of the features that are left out, of :data:`SCAN_PARTS`.
    """

    split: str
    varied: int = 0
    only: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the folder that its scans are in."""
        kind = f"{self.varied}-scans" if self.varied else "measured"
        kind += "".join(f"-without-{part}" for part in self.without)
        if not self.only:
            return f"{self.split}-{kind}"
        names = hashlib.sha256(" ".join(self.only).encode()).hexdigest()
        return f"{self.split}-{kind}-only-{names[:8]}"

    def takes(self, environment: str) -> bool:
        """Whether scenes under ``environment`` are scanned.

        Args:
            environment: Name of a light.
        """
        return not self.only or environment in self.only

    def draws(self, index: int) -> Iterator[tuple[ScanDraw, np.random.Generator]]:
        """Draw the scans of scene ``index``, always the same, each with its generator.

        Args:
            index: Of a scene in its split.
        """
        for number in range(self.varied or len(MEASURED_VIEWS)):
            rng = np.random.default_rng([index, number])
            yield training_draw(rng) if self.varied else ScanDraw(MEASURED_VIEWS[number]), rng

    def fingerprint(self, scenes: str) -> str:
        """Hash (hex) of the plan, of the code that follows it and of the ``scenes``' cards.

        Args:
            scenes: The scenes' cards, as stored.
        """
        decided = f"{self} {VOXELS} {sorted(AXES)} {source_fingerprint(*SOURCES)} {scenes}"
        return hashlib.sha256(decided.encode()).hexdigest()
