# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training that begins with other weights: what is kept, what begins at random, what it says."""

import numpy as np
import pytest
import torch

from reflest_core.cli.main import main
from reflest_core.models.registry import network_named
from reflest_core.models.weights import load_weights
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.starting_weights import StartingWeights
from reflest_core.training.variants import variant_named
from test.core.training.scenes import write_synbrdf

QUICK = [
    "--device",
    "cpu",
    "--threads",
    "1",
    "--minibatches",
    "1",
    "--batch-size",
    "2",
    "--voxels",
    "4",
    "--nodes-per-voxel",
    "2",
]


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    return write_synbrdf(tmp_path_factory.mktemp("data"), train=8, validation=3)


@pytest.fixture(scope="module", params=["hemicnn", "grouplet"])
def first(request, data, tmp_path_factory):
    """Weights of a network that says Ward's parameters."""
    out = tmp_path_factory.mktemp(request.param)
    assert main(["train", str(data), "--model", request.param, "--out", str(out), *QUICK]) == 0
    return out / f"{request.param}-float32.safetensors"


@pytest.mark.parametrize(("loss", "is_last_kept"), [("rmse1", True), ("rmse2", False)])
def test_all_but_a_last_layer_of_other_parameters_is_kept(first, loss, is_last_kept):
    given, card, _ = load_weights(first)
    recipe = variant_named(f"{card.network}-{loss}").recipe()
    torch.manual_seed(5)
    module = network_named(card.network).module()
    before = {name: tensor.clone() for name, tensor in module.state_dict().items()}
    StartingWeights.read(first, recipe).put_into(module, recipe)
    last = {"hemicnn": "fc3.", "grouplet": "regressor.4."}[card.network]
    for name, tensor in module.state_dict().items():
        is_kept = is_last_kept or not name.startswith(last)
        expected = given[name] if is_kept else before[name].numpy()
        np.testing.assert_array_equal(tensor.numpy(), expected)


def test_training_begins_there_and_says_so(data, first, tmp_path):
    given, card, digest = load_weights(first)
    variant = variant_named(f"{card.network}-rmse1")
    still = ["--variant", variant.name, "--from", str(first), "--learning-rate", "0"]
    assert main(["train", str(data), *still, "--out", str(tmp_path), *QUICK]) == 0
    trained, card, _ = load_weights(tmp_path / f"{variant.name}-float32.safetensors")
    for name, tensor in given.items():
        np.testing.assert_array_equal(trained[name], tensor)
    assert card.recipe["start"] == f"{first.stem} {digest}"


def test_a_checkpoint_of_another_start_is_refused(data, first, tmp_path, capsys):
    _, card, _ = load_weights(first)
    command = ["train", str(data), "--model", card.network, "--out", str(tmp_path), *QUICK]
    assert main(command) == 0
    assert main([*command, "--from", str(first)]) == 2
    assert "belongs to another recipe" in capsys.readouterr().err


def test_weights_of_the_other_network_and_two_networks_are_refused(data, first, tmp_path, capsys):
    _, card, _ = load_weights(first)
    other = {"hemicnn": "grouplet", "grouplet": "hemicnn"}[card.network]
    with pytest.raises(TrainingError, match=f"weights of {card.network}, from which {other}"):
        StartingWeights.read(first, network_named(other).recipes["paper"])
    everything = ["train", str(data), "--all", "--from", str(first), "--out", str(tmp_path)]
    assert main(everything) == 2
    assert "--from goes with one variant" in capsys.readouterr().err


def test_tensors_added_since_a_file_was_written_keep_their_own_first_values():
    network = network_named("lightnet")
    recipe = network.recipes["ours"]
    start = StartingWeights.read(network.models[0].weights, recipe)
    earlier = {name: t for name, t in start.tensors.items() if not name.startswith("update")}
    module = network.module()
    first = {name: tensor.clone() for name, tensor in module.state_dict().items()}
    StartingWeights(earlier, start.parameters, start.name).put_into(module, recipe)
    for name, tensor in module.state_dict().items():
        expected = earlier.get(name, first[name].numpy())
        np.testing.assert_array_equal(tensor.numpy(), expected)
    assert module.update.weight.abs().max() > 0
