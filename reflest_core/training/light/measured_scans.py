# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of estimates of simulated scans, and whether the intervals that they state hold.

Kept beside the weights that made them, trainings that hold out different lights are measured and
calibrated together: each light by weights that never saw it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.array_file import read_member
from reflest_core.models.card import Calibration
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.metrics import NormalisedRmse
from reflest_core.whole_file import whole_file

HELD_SHARE = 0.9
HALF_WIDTH = NormalDist().inv_cdf(0.5 + HELD_SHARE / 2)
"""Of the interval that holds so much of a normal distribution, in standard deviations."""
HELD_OUT = "held_out.npz"
"""File of a training's errors under the lights that it held out."""


@dataclass(frozen=True)
class MeasuredScans:
    """Errors of L estimates.

    Attributes:
        errors: (L, 5), of z-scored Ward parameters.
        deviations: (L, 5), as stated, of the same.
        views: (L,), how many each scan has.
        environments: (L,), names of their lights.
    """

    errors: NDArray[np.float64]
    deviations: NDArray[np.float64]
    views: NDArray[np.int64]
    environments: NDArray[np.str_]

    @staticmethod
    def joined(some: list[MeasuredScans]) -> MeasuredScans:
        """Join several.

        Args:
            some: What is joined.
        """
        return MeasuredScans(
            *(
                np.concatenate([getattr(one, field.name) for one in some])
                for field in fields(MeasuredScans)
            )
        )

    def where(self, is_wanted: NDArray[np.bool_]) -> MeasuredScans:
        """Select by a mask (L,).

        Args:
            is_wanted: (L,) mask.
        """
        return MeasuredScans(*(getattr(self, field.name)[is_wanted] for field in fields(self)))

    @property
    def view_counts(self) -> list[int]:
        """The numbers of views, most first."""
        return sorted({int(count) for count in self.views}, reverse=True)

    @property
    def lights(self) -> list[str]:
        """Names of the lights, sorted."""
        return sorted({str(name) for name in self.environments})

    def light_weights(self) -> NDArray[np.float64]:
        """Return weights (L,) such that every light weighs 1."""
        _, light, counts = np.unique(self.environments, return_inverse=True, return_counts=True)
        return np.asarray(1.0 / counts[light])

    @property
    def criterion(self) -> float:
        """The mean, over numbers of views, of the normalised RMSE.

        So scans with many views, whose errors are small, count as much as those with few.
        """
        by_views = [self.where(self.views == count) for count in self.view_counts]
        return float(np.mean([NormalisedRmse.of(some.errors).overall for some in by_views]))

    def figures(self, calibration: Calibration) -> dict[str, Any]:
        """Return JSON values for each number of views, with calibrated intervals.

        Args:
            calibration: Of the intervals.
        """
        return {
            str(count): self.where(self.views == count)._figures(calibration)
            for count in self.view_counts
        }

    def _figures(self, calibration: Calibration) -> dict[str, Any]:
        rmse = NormalisedRmse.of(self.errors)
        held = np.abs(self.errors) <= HALF_WIDTH * calibration.calibrated(self.deviations)
        return {
            "looks": len(self.errors),
            "rmse": rmse.overall,
            "rmse_per_parameter": rmse.per_parameter.tolist(),
            "mean_rmse_of_parameters": float(rmse.per_parameter.mean()),
            "scene_median": rmse.scene_median,
            "scene_p95": rmse.scene_p95,
            "held_by_90_percent_intervals": held.mean(axis=0).tolist(),
            "rmse_by_light": self.rmse_by_light(),
        }

    def rmse_by_light(self) -> dict[str, float]:
        """Return the normalised RMSE under each light, the smallest first."""
        found = {
            light: NormalisedRmse.of(self.errors[self.environments == light]).overall
            for light in self.lights
        }
        return dict(sorted(found.items(), key=lambda pair: pair[1]))

    def save(self, folder: Path) -> None:
        """Write :data:`HELD_OUT` into a training's folder, whole or not at all.

        Args:
            folder: The training's.
        """
        with whole_file(folder / HELD_OUT) as file:
            np.savez_compressed(
                file, **{field.name: getattr(self, field.name) for field in fields(self)}
            )

    @staticmethod
    def read(folder: Path) -> MeasuredScans:
        """Read those of a training.

        Args:
            folder: The training's.

        Raises:
            TrainingError: The folder has none, or they are damaged.
        """
        path = folder / HELD_OUT
        if not path.is_file():
            raise TrainingError(
                f"{folder} has no {HELD_OUT}: it is no finished training of lightnet with "
                "--hold-out; give folders of such trainings"
            )
        try:
            return MeasuredScans(
                *(read_member(path, field.name) for field in fields(MeasuredScans))
            )
        except (OSError, ValueError) as error:
            raise TrainingError(
                f"{path} is damaged ({error}); run that training's command again, which writes it "
                "again"
            ) from error
