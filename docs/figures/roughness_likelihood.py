# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The picture in docs/explanation/roughness.md: the likelihood of roughness by evidence.

python docs/figures/roughness_likelihood.py captures/glossy-red docs/images/roughness-likelihood.png
"""

import argparse
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.inference.gloss.posterior import gloss_posterior
from reflest_core.inference.light import seen_light
from reflest_core.light.completion import complete

FRAMES = (20, 30, 60)


def main() -> None:
    """Draw the picture, and print what each number of frames says."""
    parser = argparse.ArgumentParser(description="The likelihood of roughness, as a picture.")
    parser.add_argument("capture", type=Path, help="a capture with its truth.json")
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    truth = json.loads((arguments.capture / "truth.json").read_text())
    pipeline = Pipeline(ReflestSettings())
    figure, axis = plt.subplots(figsize=(7, 4), layout="constrained")
    for number, frame in enumerate(open_capture(arguments.capture), start=1):
        pipeline.fuse(frame)
        if number in FRAMES:
            surface = pipeline.snapshot().surface
            light = complete(seen_light(surface))
            found = gloss_posterior(surface, light, [np.arange(surface.voxel_count)])
            label = f"{number} frames" + ("" if found.is_identifiable else ", cannot be determined")
            axis.plot(found.alphas, found.log_likelihood, "o-", label=label)
            print(label, f"alpha {found.alpha:.3f} +- {found.alpha_stddev:.3f}", found.reason)
    axis.axvspan(found.alpha - found.alpha_stddev, found.alpha + found.alpha_stddev, color="0.9")
    axis.axvline(truth["alpha"], color="0.3", linestyle="--")
    axis.set(xscale="log", xlabel="roughness alpha", ylabel="log-likelihood below its maximum")
    axis.set_yscale("symlog", linthresh=10.0)
    axis.set_ylim(top=2.0)
    axis.set_xticks(
        [0.01, 0.02, 0.05, 0.1, 0.2, 0.35], labels=map(str, [0.01, 0.02, 0.05, 0.1, 0.2, 0.35])
    )
    axis.legend()
    figure.savefig(arguments.out, dpi=110)


if __name__ == "__main__":
    main()
