# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest evaluate --quick``: one row of Table 2 again, from what is shipped."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from reflest_core.evaluation.contenders import Contender, EvaluationError, find_contenders, named
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.quick_set import EXPECTED, QUICK_SET, VARIANT
from reflest_core.evaluation.statistics.accuracy import Accuracy, accuracy
from reflest_core.training.data.sample_file import read_samples

TOLERANCE = 1e-3
"""Other processors round sums in another order."""


@dataclass(frozen=True)
class QuickRow:
    """``recorded``: the RMSE in Table 2."""

    title: str
    accuracy: Accuracy
    recorded: float


def reproduce_row(quick_set: Path = QUICK_SET, expected: Path = EXPECTED) -> QuickRow:
    """Evaluate; :class:`EvaluationError` if the row is not the one in Table 2."""
    contender = named(find_contenders(None), VARIANT)
    if contender is None:
        raise EvaluationError(f"the weights of {VARIANT} are not installed; install reflest again")
    try:
        record = json.loads(expected.read_text())
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{expected} is unreadable ({error}); install again") from error
    measured, model_id = measure_row(contender, quick_set)
    if record["model_id"] != model_id:
        raise EvaluationError(
            f"Table 2 was measured with {record['model_id']}, but {model_id} is shipped; write it "
            "again with 'reflest evaluate DATA --out docs/results'"
        )
    overall = measured.ward.overall
    if abs(overall - record["rmse"]) > TOLERANCE:
        raise EvaluationError(
            f"{VARIANT} reaches {overall:.4f} here, but {record['rmse']:.4f} in Table 2: "
            "this installation does not estimate as it did"
        )
    return QuickRow(contender.title, measured, record["rmse"])


def measure_row(contender: Contender, quick_set: Path = QUICK_SET) -> tuple[Accuracy, str]:
    """Accuracy of ``contender`` on the quick set, and which weights it was."""
    samples = read_samples(quick_set)
    estimator = contender.estimator()
    made = estimate_all(estimator, samples, contender.name)
    used = estimator.predictor
    return accuracy(made.ward, samples, used.card.statistics), used.model_id


def write_expected(contender: Contender, quick_set: Path = QUICK_SET) -> dict[str, object]:
    """Record beside the quick set what it must give, and return that."""
    measured, model_id = measure_row(contender, quick_set)
    record: dict[str, object] = {
        "variant": contender.name,
        "model_id": model_id,
        "rmse": measured.ward.overall,
        "scenes": measured.scenes,
        "bytes": quick_set.stat().st_size,
    }
    quick_set.with_name(EXPECTED.name).write_text(json.dumps(record, indent=1) + "\n")
    return record
