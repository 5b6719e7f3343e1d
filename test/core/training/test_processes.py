# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Processes that torchrun starts share each minibatch and end with one process' weights."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch

from reflest_core.cli.main import main
from reflest_core.models.weights import load_weights
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.processes import Processes, joined_processes
from test.core.training.scenes import write_synbrdf

ROOT = Path(__file__).parents[3]
TORCHRUN = ["-m", "torch.distributed.run", "--standalone", "--nproc-per-node", "2"]


def options(data, out):
    """A rule that keeps differences in rounding small."""
    return [
        "train",
        str(data),
        "--model",
        "grouplet",
        "--out",
        str(out),
        "--device",
        "cpu",
        "--threads",
        "1",
        "--recipe",
        "paper",
        "--minibatches",
        "6",
        "--batch-size",
        "4",
        "--voxels",
        "8",
        "--parts",
        "2",
        "--validate-every",
        "3",
    ]


def weights_in(folder):
    tensors, _, _ = load_weights(folder / "grouplet-float32.safetensors")
    return tensors


def test_two_processes_train_as_one_with_the_double_batch(tmp_path):
    data = write_synbrdf(tmp_path / "data", train=20, validation=4)
    loopback = {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", "GLOO_SOCKET_IFNAME": "lo"}
    subprocess.run(
        [sys.executable, *TORCHRUN, "-m", "reflest_core.cli.main", *options(data, tmp_path / "2")],
        check=True,
        cwd=ROOT,
        env={**os.environ, **loopback},
        timeout=1100,
    )
    assert main(options(data, tmp_path / "1")) == 0
    together, alone = weights_in(tmp_path / "2"), weights_in(tmp_path / "1")
    for name, tensor in alone.items():
        np.testing.assert_allclose(together[name], tensor, rtol=1e-4, atol=1e-6)


def test_parts_are_shared_without_rest():
    device = torch.device("cpu")
    assert list(Processes(1, 2, device).parts(4)) == [1, 3]
    with pytest.raises(TrainingError, match="give --parts a multiple of 2"):
        Processes(0, 2, device).parts(3)


def test_half_a_set_of_torchruns_variables_is_refused(monkeypatch):
    monkeypatch.setenv("RANK", "0")
    monkeypatch.delenv("WORLD_SIZE", raising=False)
    with pytest.raises(TrainingError, match="WORLD_SIZE"), joined_processes("cpu"):
        pass


@pytest.mark.skipif(torch.cuda.is_available(), reason="needs a machine without CUDA")
def test_a_missing_gpu_is_named_and_auto_does_without():
    with (
        pytest.raises(TrainingError, match="no CUDA device for --device cuda:1"),
        joined_processes("cuda:1"),
    ):
        pass
    with joined_processes("auto") as processes:
        assert processes.device.type == "cpu"
