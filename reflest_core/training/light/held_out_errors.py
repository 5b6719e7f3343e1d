# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How far estimates under lights held out are off, kept beside the weights that made them.

Trainings that hold out different lights can so be calibrated on together: each light is measured by
weights that never saw it.
"""

from __future__ import annotations

import os
import zipfile
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.training.light.measured_looks import MeasuredLooks
from reflest_core.training.sample import TrainingError

FILE = "held_out_errors.npz"


@dataclass(frozen=True)
class HeldOutErrors:
    """``errors`` (L, 5) and ``deviations`` (L, 5) that were stated, of z-scored Ward parameters.

    ``views``: (L,), how many each look had. ``environments``: (L,) names of their lights.
    """

    errors: NDArray[np.float64]
    deviations: NDArray[np.float64]
    views: NDArray[np.int64]
    environments: NDArray[np.str_]

    @staticmethod
    def of(measured: MeasuredLooks) -> HeldOutErrors:
        """Of what was measured, z-scored by its training's statistics."""
        stddev = measured.statistics.stddev
        return HeldOutErrors(
            (measured.estimates - measured.truths) / stddev,
            measured.deviations / stddev,
            measured.views,
            measured.environments,
        )

    @staticmethod
    def joined(some: list[HeldOutErrors]) -> HeldOutErrors:
        """All looks of ``some``."""
        return HeldOutErrors(
            *(
                np.concatenate([getattr(one, field.name) for one in some])
                for field in fields(HeldOutErrors)
            )
        )

    @property
    def lights(self) -> list[str]:
        """Names of the lights, sorted."""
        return sorted({str(name) for name in self.environments})

    def light_weights(self) -> NDArray[np.float64]:
        """(L,) such that every light weighs 1."""
        _, light, counts = np.unique(self.environments, return_inverse=True, return_counts=True)
        return np.asarray(1.0 / counts[light])

    def save(self, folder: Path) -> None:
        """Write :data:`FILE` into the training's ``folder``, atomically."""
        temporary = folder / f"{FILE}.partial"
        with temporary.open("wb") as file:
            np.savez_compressed(
                file, **{field.name: getattr(self, field.name) for field in fields(self)}
            )
        os.replace(temporary, folder / FILE)

    @staticmethod
    def read(folder: Path) -> HeldOutErrors:
        """Those of a training in ``folder``; :class:`TrainingError` where there are none."""
        path = folder / FILE
        if not path.is_file():
            raise TrainingError(
                f"{folder} has no {FILE}; give --calibration the folders of trainings of lightnet "
                "with --hold-out"
            )
        try:
            with np.load(path) as stored:
                return HeldOutErrors(*(stored[field.name] for field in fields(HeldOutErrors)))
        except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
            raise TrainingError(
                f"{path} is damaged ({error}); run that training's command again without its "
                "checkpoint"
            ) from error
