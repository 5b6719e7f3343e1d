# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""SIGKILL in the middle of a real run: what is left is whole, and the next run completes it."""

import signal
import subprocess
import sys

import pytest

pytest.importorskip("mitsuba")

from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.generation.generate import generate
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.scenes.scene_file import load_shard, sha256

SCENES = {"train": 2, "validation": 2, "unseen": 2}
ATTEMPTS = 10
GENERATION = Generation(seed=9, scenes=SCENES, points=20, views=4, samples=4)


def hashes(folder):
    return {path.name: sha256(path) for path in sorted(folder.iterdir())}


def command(folder):
    options = {
        "out": folder,
        "seed": 9,
        "points": 20,
        "views": 4,
        "samples": 4,
        "jobs": 2,
        **SCENES,
    }
    words = [word for key, value in options.items() for word in (f"--{key}", str(value))]
    return [sys.executable, "-m", "reflest_core.cli.main", "synbrdf", "generate", *words]


def read_until(stream, wanted):
    """Read the progress bar as it is drawn, until it shows ``wanted``."""
    shown = ""
    while wanted not in shown:
        letter = stream.read(1)
        assert letter, f"the run ended before it showed {wanted}: {shown}"
        shown += letter


def killed(folder):
    """Start a run that is killed once its first shard is shown, and return the shards it left."""
    run = subprocess.Popen(command(folder), stderr=subprocess.PIPE, text=True)
    try:
        # The first shard of two scenes is done; others have begun or wait.
        read_until(run.stderr, "2/6")
    finally:
        run.send_signal(signal.SIGKILL)
        run.wait()
    # The workers hold the pipe open: its end shows that none of them outlives the command.
    run.stderr.read()
    run.stderr.close()
    return sorted(folder.glob("*.safetensors"))


def test_a_killed_run_and_its_resumption_give_the_bytes_of_one_run(tmp_path):
    # On a crowded machine a run may have ended before this process comes to kill it.
    runs = (tmp_path / f"killed{number}" for number in range(ATTEMPTS))
    folder, left = next((folder, left) for folder in runs if len(left := killed(folder)) < 3)
    assert left
    assert all(len(load_shard(path)) == 2 for path in left)

    resumed = subprocess.run(command(folder), stderr=subprocess.PIPE, text=True, check=False)
    assert resumed.returncode == 0, resumed.stderr
    generate(tmp_path / "whole", GENERATION, process_pool(2))
    assert hashes(folder) == hashes(tmp_path / "whole")
