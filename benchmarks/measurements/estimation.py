# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimates from one scan by each model: the shipped code, and PyTorch on the same features."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch

from benchmarks.measurements.stages import (
    COMPILED,
    EAGER,
    ESTIMATE,
    ESTIMATION_STAGES,
    FROM_STORE,
    NETWORK,
    SHIPPED_KIND,
    SNAPSHOT,
)
from benchmarks.measuring.resident_memory import forget_peak, peak_mb, resident_mb
from benchmarks.measuring.stage_clock import StageClock
from benchmarks.measuring.timing import Timing
from benchmarks.scene.table_scene import table_settings
from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_core.models.registry import models, network_of_model, shipped_models
from reflest_core.models.weights import load_weights
from reflest_core.surface.voxel_choice import choose_voxels

WARM_UP = 3
"""Estimates before the first that counts."""


def measure(
    capture: str, frames: int, estimates: int, threads: int, is_compiled: bool
) -> dict[str, Any]:
    """Scan the first frames, then time estimates of every model.

    Args:
        capture: Path of the capture.
        frames: Number of frames to scan.
        estimates: Number of estimates of each model.
        threads: Threads of the network.
        is_compiled: Also compare with ``torch.compile``, which takes minutes.
    """
    settings = table_settings()
    pipeline = Pipeline(settings)
    for frame in itertools.islice(open_capture(Path(capture)), frames):
        pipeline.fuse(frame)
    snapshot = pipeline.snapshot()
    models = {}
    for model in shipped_models():
        pipeline.estimator = Estimator(
            dataclasses.replace(settings.estimation, model=model, threads=threads)
        )
        kinds = {SHIPPED_KIND: _shipped(pipeline, estimates)}
        kinds |= _peers(model, snapshot, estimates, is_compiled)
        models[model] = {
            kind: [dataclasses.asdict(one) for one in timings] for kind, timings in kinds.items()
        }
    return {"models": models, "voxels": snapshot.surface.voxel_count, "peak_mb": peak_mb()}


def _shipped(pipeline: Pipeline, count: int) -> list[Timing]:
    """The path of the node, stage by stage."""
    clock = StageClock(ESTIMATION_STAGES)
    for number in range(WARM_UP + count):
        if number == WARM_UP:
            clock.seconds.clear()
        with clock.watching(), clock.timing(FROM_STORE):
            with clock.timing(SNAPSHOT):
                snapshot = pipeline.snapshot()
            with clock.timing(ESTIMATE):
                pipeline.estimate(snapshot)
        clock.lap()
    forget_peak()
    before = resident_mb()
    pipeline.estimate(snapshot)
    return clock.timings({ESTIMATE: max(peak_mb() - before, 0.0)})


def _peers(
    model: str, snapshot: KeyframeSnapshot, count: int, is_compiled: bool
) -> dict[str, list[Timing]]:
    """The network as the module that was trained, run by PyTorch on the same features."""
    network, choice = network_of_model(model), models()[model]
    assert choice.weights is not None, "only shipped models are measured"
    tensors = network.completed(load_weights(choice.weights)[0])
    module = network.module()
    module.load_state_dict({name: torch.from_numpy(values) for name, values in tensors.items()})
    module.eval()
    voxels = choose_voxels(snapshot.surface, choice.voxels)
    features = network.features(snapshot.surface, voxels)
    inputs = tuple(torch.from_numpy(values) for values in features)
    runners: dict[str, Callable[..., torch.Tensor]] = {EAGER: module}
    if is_compiled:
        runners[COMPILED] = torch.compile(module)
    return {name: _run(run, inputs, count) for name, run in runners.items()}


def _run(
    run: Callable[..., torch.Tensor], inputs: tuple[torch.Tensor, ...], count: int
) -> list[Timing]:
    clock = StageClock(())
    with torch.inference_mode():
        for number in range(WARM_UP + count):
            if number == WARM_UP:
                clock.seconds.clear()
            with clock.timing(NETWORK):
                run(*(tensor[None] for tensor in inputs))
            clock.lap()
    return clock.timings()
