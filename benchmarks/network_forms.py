# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Times each network's two forms on one thread: the PyTorch module, and the form used live."""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.inference.light import seen_light
from reflest_core.inference.material import explain
from reflest_core.models.definition import LiveNetwork
from reflest_core.models.linear_algebra import one_blas_thread
from reflest_core.models.registry import models, network_of_model
from reflest_core.models.torch_network import TorchNetwork
from reflest_core.models.weights import load_weights
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_choice import choose_voxels

CAPTURE = Path(__file__).parents[1] / "captures" / "glossy-red"
REGION = RegionSettings("sphere", (0.0, 0.0, 0.0), (0.6, 0.6, 0.6))


def main() -> None:
    """Print features and forward pass of each shipped model, by both forms, in milliseconds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=30, help="of each form, by turns")
    runs = parser.parse_args().runs
    torch.set_num_threads(1)
    scan = Scan(FusionSettings(), REGION)
    for frame in open_capture(CAPTURE):
        scan.fuse(frame)
    surface = scan.snapshot()
    print("| model | PyTorch module, ms | live form, ms |\n|---|---|---|")
    for name, model in models().items():
        if model.weights is None:
            continue
        definition = network_of_model(name)
        tensors = definition.completed(load_weights(model.weights)[0])
        forms = [TorchNetwork(definition, tensors, "cpu"), definition.live(tensors, threads=1)]
        module, live = _times(forms, surface, choose_voxels(surface, model.voxels), runs)
        print(f"| {name} | {module:.2f} | {live:.2f} |", flush=True)


def _times(
    forms: list[LiveNetwork], surface: ObservedSurface, voxels: NDArray[np.int64], runs: int
) -> list[float]:
    """Median processor time of each form, milliseconds; the light is inferred beforehand."""
    found = explain(surface, seen_light(surface))
    times: list[list[float]] = [[] for _ in forms]
    with one_blas_thread():
        for form in forms:
            form.scores(surface, [voxels], found)
        for _ in range(runs):
            for form, taken in zip(forms, times, strict=True):
                start = time.process_time()
                form.scores(surface, [voxels], found)
                taken.append(1e3 * (time.process_time() - start))
    return [statistics.median(taken) for taken in times]


if __name__ == "__main__":
    main()
