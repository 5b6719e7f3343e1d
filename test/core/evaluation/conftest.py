# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A tiny data set, three variants trained on it for a moment, and an untrained lightnet."""

import pytest
import torch

from reflest_core.cli.main import main
from test.core.training.scenes import write_synbrdf
from test.core.weight_files import untrained_lightnet

TRAINED = ("grouplet-rmse1", "hemicnn-rmse1", "hemicnn-rmse2")


@pytest.fixture(autouse=True, scope="session")
def _one_thread():
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)


@pytest.fixture(scope="session")
def data(tmp_path_factory):
    return write_synbrdf(tmp_path_factory.mktemp("data"), train=12, validation=6, unseen=4)


def train(data, folder, name, *how):
    """A variant into ``folder/name``, eight minibatches long."""
    brief = ["--minibatches", "8", "--batch-size", "4", "--voxels", "8", "--threads", "1"]
    out = ["--variant", name, "--out", str(folder / name), "--device", "cpu"]
    assert main(["train", str(data), *out, *brief, *how]) == 0


@pytest.fixture(scope="session")
def unhardened(data, tmp_path_factory):
    folder = tmp_path_factory.mktemp("unhardened")
    train(data, folder, "hemicnn-rmse1")
    return folder


@pytest.fixture(scope="session")
def runs(data, tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    for name in TRAINED:
        train(data, folder, name, *(["--realism"] if name == "hemicnn-rmse1" else []))
    (folder / "lightnet").mkdir()
    untrained_lightnet(folder).rename(folder / "lightnet" / "lightnet.safetensors")
    return folder
