# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The estimates behind Table 2, kept so that other parts look at the same ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.contenders import EvaluationError
from reflest_core.evaluation.estimates import SceneEstimates
from reflest_core.evaluation.record_file import read_record
from reflest_core.evaluation.table_2 import Estimates
from reflest_core.training.data.sample import Sample


def as_figures(estimates: Estimates, splits: dict[str, list[Sample]]) -> dict[str, Any]:
    """By split: ``truths``, the scenes' ``indices`` and every network's estimates of them."""
    return {
        split: {
            "truths": [sample.ward.tolist() for sample in samples],
            "indices": [sample.index for sample in samples],
            "networks": {name: _plain(made) for name, made in estimates[split].items()},
        }
        for split, samples in splits.items()
    }


def read_estimates(path: Path) -> Estimates:
    """Those of a record of :func:`as_figures`; :class:`EvaluationError` if there is none."""
    record = read_record(path)
    if record is None:
        raise EvaluationError("there are no estimates yet; run --parts table-2 first")
    return {
        split: {name: _arrays(made) for name, made in of["networks"].items()}
        for split, of in record.items()
        if split != "provenance"
    }


def _plain(made: SceneEstimates) -> dict[str, Any]:
    is_sure = not np.isnan(made.stddev).any()
    return {
        "ward": made.ward.round(6).tolist(),
        "stddev": made.stddev.round(6).tolist() if is_sure else None,
        "statuses": made.statuses,
    }


def _arrays(made: dict[str, Any]) -> SceneEstimates:
    ward = np.array(made["ward"])
    stddev = np.full_like(ward, np.nan) if made["stddev"] is None else np.array(made["stddev"])
    return SceneEstimates(ward, stddev, made["statuses"])
