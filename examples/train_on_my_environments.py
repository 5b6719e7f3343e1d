# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Train a network for the light of your own rooms: a data set, a training, a replay.

    python examples/train_on_my_environments.py ENVIRONMENTS OUT [--scenes 400] [--minibatches 4000]

ENVIRONMENTS is a folder of .hdr or .exr panoramas. Needs the extras 'synbrdf' and 'training'. The
default takes about ten minutes on two cores and shows the steps; the shipped networks come from
5,000 scenes. Both steps go on where they were stopped when the same command runs again.
"""

import argparse
from pathlib import Path

from reflest_core.cli.main import main as reflest


def main() -> int:
    """Run the three commands; the exit code of the first that fails, or 0."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("environments", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--scenes", type=int, default=400)
    parser.add_argument("--views", type=int, default=50)
    parser.add_argument("--minibatches", type=int, default=4000)
    parser.add_argument("--capture", default="captures/glossy-red")
    options = parser.parse_args()
    data, run = options.out / "data", options.out / "run"
    validation = max(options.scenes // 10, 2)
    scenes = {"--train": options.scenes, "--validation": validation, "--unseen": 0}
    counts = [text for name, count in scenes.items() for text in (name, str(count))]
    sources = ["--environments", str(options.environments)]
    generate = ["synbrdf", "generate", "--out", str(data), "--views", str(options.views)]
    train = ["train", str(data), "--model", "hemicnn", "--out", str(run)]
    limits = ["--minibatches", str(options.minibatches), "--warm-up", "0"]
    validate = ["--validate-every", str(max(options.minibatches // 10, 1))]
    commands = [[*generate, *counts, *sources], [*train, *limits, *validate]]
    for command in commands:
        print("reflest", *command, flush=True)
        if code := reflest(command):
            return code
    weights = str(run / "hemicnn.safetensors")
    return reflest(["replay", options.capture, "--model", "hemicnn", "--weights", weights])


if __name__ == "__main__":
    raise SystemExit(main())
