# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Size of each weight file and time of an estimate, features and all; and what 8 bits cost."""

from __future__ import annotations

import dataclasses
import platform
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.contenders import Contender
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.paper_figures import LATENCY_MS, SIZE_BYTES
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.models.predictor import Predictor
from reflest_core.models.weights import load_weights, save_weights
from reflest_core.training.data.sample import Sample

TIMED_SCENES = 40
WARM_UP = 3


def measure_latency(contenders: list[Contender], samples: list[Sample]) -> dict[str, Any]:
    """Milliseconds of an estimate of a SynBRDF scene with all its views, on one CPU thread."""
    rows = []
    seen: set[str] = set()
    for contender in contenders:
        is_grouplet = contender.network == "grouplet"
        forms = [contender.as_fast(), contender] if is_grouplet else [contender]
        for form in forms:
            if form.model in seen:
                continue
            seen.add(form.model)
            rows.append(
                {
                    "model": form.model,
                    "weights": form.name,
                    "bytes": form.weights.stat().st_size,
                    "paper_bytes": SIZE_BYTES.get(form.network),
                    "paper_ms": LATENCY_MS.get(form.model),
                    **time_estimates(form.predictor(), samples),
                }
            )
    return {"machine": f"{platform.machine()}, one thread", "rows": rows}


def time_estimates(predictor: Predictor, samples: list[Sample]) -> dict[str, float]:
    """Median and 95th percentile, in milliseconds, over the first samples."""
    for sample in samples[:WARM_UP]:
        predictor.predict(sample.surface)
    times = []
    for sample in samples[:TIMED_SCENES]:
        started = time.perf_counter()
        predictor.predict(sample.surface)
        times.append(1e3 * (time.perf_counter() - started))
    return {"median_ms": float(np.median(times)), "p95_ms": float(np.percentile(times, 95))}


def measure_eight_bit(contenders: list[Contender], samples: list[Sample]) -> dict[str, Any]:
    """RMSE of each variant with float32 and with 8-bit weights, on the same scenes.

    A variant whose float32 weights were not kept has no such row.
    """
    rows = []
    for contender in contenders:
        tensors, card, _ = load_weights(contender.exact or contender.weights)
        if contender.exact is None and contender.network == "grouplet":
            continue
        with tempfile.TemporaryDirectory() as folder:
            errors, sizes = {}, {}
            for bits, is_reduced in ((32, False), (8, True)):
                path = Path(folder) / f"{bits}.safetensors"
                save_weights(path, tensors, card, is_reduced)
                stored = dataclasses.replace(contender, weights=path)
                made = estimate_all(stored.estimator(), samples, f"{contender.name}, {bits} bits")
                errors[bits] = accuracy(made.ward, samples, card.statistics).ward.overall
                sizes[bits] = path.stat().st_size
        rows.append(
            {
                "variant": contender.name,
                "title": contender.title,
                "float32": errors[32],
                "eight_bit": errors[8],
                "float32_bytes": sizes[32],
                "eight_bit_bytes": sizes[8],
            }
        )
    return {"scenes": len(samples), "rows": rows}
