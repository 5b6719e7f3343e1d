# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest evaluate --quick``: one row of Table 2, measured again from a shipped file.

The quick set holds all validation scenes at the 25 voxels that HemiCNN uses. Voxel choice on a
surface of these voxels alone returns all of them, so that estimates from this file equal those
from the whole data set bit for bit.
"""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path

from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.networks import (
    EvaluatedNetwork,
    EvaluationError,
    find_networks,
    network_named,
)
from reflest_core.evaluation.statistics.accuracy import Accuracy, accuracy
from reflest_core.models.registry import models
from reflest_core.surface.selection import keep_voxels
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.training.data.sample import Sample
from reflest_core.training.data.sample_file import (
    read_samples,
    save_samples,
)

QUICK_SET = Path(__file__).parent / "quick" / "validation.safetensors"
EXPECTED = QUICK_SET.with_name("expected.json")
VARIANT = "hemicnn-rmse1"


def save_quick_set(path: Path, samples: list[Sample]) -> None:
    """Write the scenes at HemiCNN's voxels.

    Args:
        path: The ``.safetensors`` file to write.
        samples: The validation scenes.
    """
    count = models()["hemicnn"].voxels
    save_samples(
        path,
        [
            dataclasses.replace(
                sample, surface=keep_voxels(sample.surface, choose_voxels(sample.surface, count))
            )
            for sample in samples
        ],
    )


TOLERANCE = 1e-3
"""Other processors round sums in another order."""


@dataclass(frozen=True)
class QuickRow:
    """The row that was reproduced.

    Attributes:
        title: The network's name in tables.
        accuracy: What was measured now.
        recorded: The RMSE in Table 2.
    """

    title: str
    accuracy: Accuracy
    recorded: float


def reproduce_row(quick_set: Path = QUICK_SET, expected: Path = EXPECTED) -> QuickRow:
    """Evaluate the shipped HemiCNN on the quick set.

    Args:
        quick_set: The scenes.
        expected: The JSON file with the RMSE of Table 2.

    Raises:
        EvaluationError: a file is missing, or the RMSE is not the one in Table 2.
    """
    network = network_named(find_networks(None), VARIANT)
    if network is None:
        raise EvaluationError(f"the weights of {VARIANT} are not installed; install reflest again")
    try:
        record = json.loads(expected.read_text())
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{expected} is unreadable ({error}); install again") from error
    measured, model_id = measure_row(network, quick_set)
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
    return QuickRow(network.title, measured, record["rmse"])


def measure_row(network: EvaluatedNetwork, quick_set: Path = QUICK_SET) -> tuple[Accuracy, str]:
    """Accuracy of a network on the quick set.

    Args:
        network: The network to evaluate.
        quick_set: The scenes.

    Returns:
        The accuracy, and the ``model_id`` of the weights.
    """
    samples = read_samples(quick_set)
    estimator = network.estimator()
    made = estimate_all(estimator, samples, network.name)
    used = estimator.predictor
    return accuracy(made.ward, samples, used.card.statistics), used.model_id


def write_expected(network: EvaluatedNetwork, quick_set: Path = QUICK_SET) -> dict[str, object]:
    """Write the RMSE that the quick set must give into a file beside it.

    Args:
        network: The network to evaluate.
        quick_set: The scenes.

    Returns:
        The record that was written.
    """
    measured, model_id = measure_row(network, quick_set)
    record: dict[str, object] = {
        "variant": network.name,
        "model_id": model_id,
        "rmse": measured.ward.overall,
        "scenes": measured.scenes,
        "bytes": quick_set.stat().st_size,
    }
    quick_set.with_name(EXPECTED.name).write_text(json.dumps(record, indent=1) + "\n")
    return record
