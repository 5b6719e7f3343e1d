# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A tiny data set, briefly trained variants, an untrained lightnet, and an evaluation of them."""

import numpy as np
import pytest
import torch
from matplotlib.figure import Figure

from reflest_core.cli.main import main
from reflest_core.evaluation import parts
from reflest_core.evaluation.pictures import swatches
from reflest_core.evaluation.studies import single_image, view_study
from test.core.evaluation.results import FIGURES
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


@pytest.fixture(scope="session")
def out(data, runs, unhardened, tmp_path_factory):
    """Folder with the records and the page of one evaluation of most parts."""
    folder = tmp_path_factory.mktemp("results")
    save = Figure.savefig

    def save_and_keep(figure, path, **options):
        FIGURES[str(path.relative_to(folder).with_suffix(""))] = figure
        save(figure, path, **options)

    effort = single_image.Effort(steps=3, starts=(0.1,))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(single_image, "Effort", lambda: effort)
        patch.setattr(Figure, "savefig", save_and_keep)
        patch.setattr(swatches, "ALPHAS", np.geomspace(0.001, 0.5, 3))
        patch.setattr(swatches, "STRATA", 2)
        patch.setattr(parts, "RENDERED", 3)
        patch.setattr(parts, "FEW_SCENES", 3)
        patch.setattr(view_study, "VIEW_COUNTS", (5, 20, 30))
        elsewhere = (
            "materials",
            "quick",
            "ablation",
            "look-around",
            "held-out-lights",
            "stability",
        )
        wanted = [part for part in parts.PARTS if part not in elsewhere]
        options = ["--out", str(folder), "--runs", str(runs), "--unhardened", str(unhardened)]
        options += ["--optimised", "2"]
        assert main(["evaluate", str(data), *options, "--parts", *wanted]) == 0
    return folder
