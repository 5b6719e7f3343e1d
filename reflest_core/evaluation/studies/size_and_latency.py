# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Size of each weight file, time of an estimate, and errors with 8-bit weights or fewer voxels."""

from __future__ import annotations

import dataclasses
import platform
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.networks import EvaluatedNetwork
from reflest_core.evaluation.paper_figures import LATENCY_MS, SIZE_BYTES
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.models.predictor import Predictor
from reflest_core.models.weights import load_weights, save_weights
from reflest_core.training.data.sample import Sample

TIMED_SCENES = 40
WARM_UP = 3


def measure_latency(networks: list[EvaluatedNetwork], samples: list[Sample]) -> dict[str, Any]:
    """Milliseconds of an estimate of a SynBRDF scene with all its views, on one CPU thread.

    Args:
        networks: The networks to compare.
        samples: The scenes to time.

    Returns:
        The record of the part ``latency``.
    """
    rows = []
    seen: set[str] = set()
    for network in networks:
        is_grouplet = network.architecture == "grouplet"
        forms = [network.as_fast(), network] if is_grouplet else [network]
        for form in forms:
            if form.model in seen:
                continue
            seen.add(form.model)
            rows.append(
                {
                    "model": form.model,
                    "weights": form.name,
                    "bytes": form.weights.stat().st_size,
                    "paper_bytes": SIZE_BYTES.get(form.architecture),
                    "paper_ms": LATENCY_MS.get(form.model),
                    **time_estimates(form.predictor(), samples),
                }
            )
    return {"machine": f"{platform.machine()}, one thread", "rows": rows}


def time_estimates(predictor: Predictor, samples: list[Sample]) -> dict[str, float]:
    """Time estimates of the first samples.

    Args:
        predictor: The network, features included.
        samples: The scenes to time.

    Returns:
        ``median_ms`` and ``p95_ms``.
    """
    for sample in samples[:WARM_UP]:
        predictor.predict(sample.surface)
    times = []
    for sample in samples[:TIMED_SCENES]:
        started = time.perf_counter()
        predictor.predict(sample.surface)
        times.append(1e3 * (time.perf_counter() - started))
    return {"median_ms": float(np.median(times)), "p95_ms": float(np.percentile(times, 95))}


def measure_eight_bit(networks: list[EvaluatedNetwork], samples: list[Sample]) -> dict[str, Any]:
    """RMSE of each network with float32 and with 8-bit weights, on the same scenes.

    A network whose float32 weights were not kept has no row.

    Args:
        networks: The networks to compare.
        samples: The scenes.

    Returns:
        The record of the part ``eight-bit``.
    """
    rows = []
    for network in networks:
        tensors, card, _ = load_weights(network.exact or network.weights)
        if network.exact is None and network.architecture == "grouplet":
            continue
        with tempfile.TemporaryDirectory() as folder:
            errors, sizes = {}, {}
            for bits, is_reduced in ((32, False), (8, True)):
                path = Path(folder) / f"{bits}.safetensors"
                save_weights(path, tensors, card, is_reduced)
                stored = dataclasses.replace(network, weights=path)
                made = estimate_all(stored.estimator(), samples, f"{network.name}, {bits} bits")
                errors[bits] = accuracy(made.ward, samples, card.statistics).ward.overall
                sizes[bits] = path.stat().st_size
        rows.append(
            {
                "variant": network.name,
                "title": network.title,
                "float32": errors[32],
                "eight_bit": errors[8],
                "float32_bytes": sizes[32],
                "eight_bit_bytes": sizes[8],
            }
        )
    return {"scenes": len(samples), "rows": rows}
