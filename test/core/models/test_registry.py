# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Networks are found by name, those of other packages too; names are never taken twice."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from reflest_core.models import registry
from reflest_core.models.registry import (
    GROUP,
    RegistryError,
    models,
    network_named,
    network_of_model,
    networks,
    shipped_models,
)
from reflest_core.training.method import TrainingMethod, training_method
from test.core.training.scenes import write_synbrdf

OUTSIDE = Path(__file__).parent / "outside"
ROOT = Path(__file__).parents[3]


def test_every_model_belongs_to_one_network_and_lightnet_is_the_first():
    assert list(networks()) == ["lightnet", "hemicnn", "grouplet"]
    assert list(models()) == ["lightnet", "hemicnn", "grouplet-fast", "grouplet-slow"]
    for name in models():
        assert network_of_model(name).model_named(name).name == name
    assert set(shipped_models()) == set(models())


@pytest.mark.parametrize("name", ["lightnet", "hemicnn", "grouplet"])
def test_every_network_says_how_it_is_trained(name):
    network = network_named(name)
    assert network.recipes["ours"].network == name
    assert isinstance(training_method(network.training), TrainingMethod)


def test_an_unknown_name_is_refused_with_the_known_ones():
    with pytest.raises(RegistryError, match="no network 'resnet'; choose one of lightnet, hemicnn"):
        network_named("resnet")
    with pytest.raises(RegistryError, match="no model 'resnet'; choose one of lightnet, hemicnn"):
        network_of_model("resnet")


def test_a_registered_network_imports_nothing_that_computes():
    script = (
        "import sys\n"
        "from reflest_core.models.registry import models\n"
        "models()\n"
        "print(sorted({'torch', 'numba', 'scipy', 'cv2'} & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


@pytest.fixture
def registered(tmp_path):
    """Registers an import path as a package's entry point; returns the environment to run in."""

    def register(value):
        site = tmp_path / "site"
        info = site / "toy_network-1.0.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-network\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[{GROUP}]\ntoy = {value}\n")
        paths = [str(ROOT), str(OUTSIDE), str(site)]
        return {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}

    return register


def reflest(environment, *arguments):
    command = [sys.executable, "-m", "reflest_core.cli.main", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=environment, cwd=ROOT)


def test_a_network_from_outside_is_trained_evaluated_and_replays_a_capture(registered, tmp_path):
    environment = registered("toy_network:ToyDefinition")
    data = write_synbrdf(tmp_path / "data", train=8, validation=3, unseen=2)
    runs = tmp_path / "runs"
    trained = reflest(
        environment, "train", data, "--model", "toy", "--out", runs / "toy", "--threads", 1
    )
    assert trained.returncode == 0, trained.stderr
    weights = runs / "toy" / "toy.safetensors"
    assert f"weights: {weights}" in trained.stdout

    out = tmp_path / "results"
    evaluated = reflest(
        environment, "evaluate", data, "--out", out, "--runs", runs, "--parts", "table-2"
    )
    assert evaluated.returncode == 0, evaluated.stderr
    rows = json.loads((out / "table-2.json").read_text())
    assert "toy" in json.dumps(rows)

    capture = ROOT / "captures" / "glossy-red"
    replayed = reflest(
        environment,
        *("replay", capture, "--model", "toy", "--weights", weights),
        *("--json", tmp_path / "out.json"),
    )
    assert replayed.returncode == 0, replayed.stderr
    final = json.loads((tmp_path / "out.json").read_text())["final"]
    assert final["model_id"].startswith("toy/")
    assert final["voxel_count"] > 100


def test_a_network_without_shipped_weights_asks_for_a_file(registered, tmp_path):
    environment = registered("toy_network:ToyDefinition")
    done = reflest(environment, "replay", ROOT / "captures" / "glossy-red", "--model", "toy")
    assert done.returncode == 2
    assert "toy comes without weights; set estimation.weights" in done.stderr


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("toy_network:Missing", "toy = toy_network:Missing cannot be loaded (AttributeError"),
        ("json:JSONDecoder", "entry point toy = json:JSONDecoder is no NetworkDefinition"),
        (registry.BUILT_IN[1], "the network hemicnn of another package has a name"),
    ],
)
def test_a_broken_entry_point_is_left_out_with_one_sentence(registered, value, message):
    done = reflest(registered(value), "train", "data", "--model", "toy", "--out", "out")
    assert done.returncode == 2
    assert message in done.stderr
    assert "no network 'toy'; choose one of lightnet, hemicnn, grouplet" in done.stderr
    assert "Traceback" not in done.stderr
