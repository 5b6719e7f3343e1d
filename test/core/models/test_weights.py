# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Weight files: round trip, the 8-bit form's error and size, every kind of damage."""

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.numpy import save_file

from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.card import ParameterStatistics
from reflest_core.models.grouplet.network import Grouplet
from reflest_core.models.hemicnn.network import HemiCNN
from reflest_core.models.predictor import Predictor
from reflest_core.models.registry import models, network_named, shipped_models
from reflest_core.models.weights import (
    WeightsCard,
    WeightsError,
    dequantise,
    load_weights,
    quantise,
    save_weights,
)


def card(network="hemicnn"):
    known = ParameterStatistics(np.array([0.2, 0.2, 0.2, 0.1, 0.1]), np.full(5, 0.3))
    statistics = {"ward": known, "labcd": known}
    return WeightsCard(network, "ward", WardVariant.WARD_1992, statistics, {"seed": 1})


def test_round_trip_of_tensors_and_card(tmp_path):
    tensors = HemiCNN().state_dict()
    save_weights(tmp_path / "w.safetensors", tensors, card(), eight_bit=False)
    loaded, read, digest = load_weights(tmp_path / "w.safetensors")
    assert loaded.keys() == tensors.keys()
    for name, tensor in tensors.items():
        np.testing.assert_array_equal(loaded[name], tensor.numpy())
    assert (read.network, read.parameters, read.variant) == (
        "hemicnn",
        "ward",
        WardVariant.WARD_1992,
    )
    np.testing.assert_array_equal(read.output_statistics.mean, card().output_statistics.mean)
    assert read.recipe == {"seed": 1}
    assert len(digest) == 64


def test_eight_bit_weights_are_within_half_a_step_of_their_row():
    tensors = {name: tensor.numpy() for name, tensor in Grouplet().state_dict().items()}
    restored = dequantise(quantise(tensors))
    for name, tensor in tensors.items():
        error = np.abs(restored[name] - tensor)
        if tensor.ndim < 2:
            assert not error.any()
        else:
            assert (error <= np.abs(tensor).max(axis=1, keepdims=True) / 254 * 1.001).all()


def test_file_sizes_meet_the_papers(tmp_path):
    save_weights(tmp_path / "h.safetensors", HemiCNN().state_dict(), card(), eight_bit=False)
    save_weights(tmp_path / "g.safetensors", Grouplet().state_dict(), card(), eight_bit=True)
    assert (tmp_path / "h.safetensors").stat().st_size <= 60_000
    assert (tmp_path / "g.safetensors").stat().st_size <= 340_000


@pytest.mark.parametrize("file", sorted({models()[model].weights for model in shipped_models()}))
def test_shipped_weights_are_whole_and_small(file):
    tensors, shipped, _ = load_weights(file)
    limit = {"hemicnn": 60_000, "grouplet": 340_000, "lightnet": 340_000}[shipped.network]
    assert file.stat().st_size <= limit
    network = network_named(shipped.network)
    tensors = network.completed(tensors)
    assert {name: tensor.shape for name, tensor in tensors.items()} == network.shapes()
    assert shipped.variant is WardVariant.WARD_1992
    assert shipped.recipe["minibatches"] > 0
    assert (shipped.output_statistics.stddev > 0).all()


def test_grouplet_fast_and_slow_are_one_set_of_weights():
    fast, slow = Predictor("grouplet-fast"), Predictor("grouplet-slow")
    assert fast.model_id.split("/")[1] == slow.model_id.split("/")[1]
    assert (fast.voxels, slow.voxels) == (20, 354)


def test_a_path_that_is_too_long_ends_with_one_sentence(tmp_path):
    with pytest.raises(WeightsError, match="there is no weight file"):
        load_weights(tmp_path / ("a" * 5000))


def test_a_changed_weight_is_noticed(tmp_path):
    path = tmp_path / "w.safetensors"
    save_weights(path, HemiCNN().state_dict(), card(), eight_bit=False)
    with safe_open(path, framework="np") as file:
        metadata = file.metadata()
        tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    tensors["fc3.bias"][0] += 1e-3
    save_file(tensors, path, metadata)
    with pytest.raises(WeightsError, match="hash"):
        load_weights(path)


@pytest.mark.parametrize("damage", ["missing", "truncated", "garbage", "foreign"])
def test_damage_ends_with_one_sentence_that_names_the_file(tmp_path, damage):
    path = tmp_path / "w.safetensors"
    save_weights(path, HemiCNN().state_dict(), card(), eight_bit=False)
    if damage == "missing":
        path.unlink()
    elif damage == "truncated":
        path.write_bytes(path.read_bytes()[:30_000])
    elif damage == "garbage":
        path.write_bytes(b"\xff" * 1000)
    else:
        save_file({"a": np.zeros(3, np.float32)}, path)
    with pytest.raises(WeightsError, match=r"w\.safetensors") as caught:
        load_weights(path)
    assert "\n" not in str(caught.value)


def test_weights_of_another_network_are_refused_by_name(tmp_path):
    path = tmp_path / "h.safetensors"
    save_weights(path, HemiCNN().state_dict(), card(), eight_bit=False)
    with pytest.raises(WeightsError, match=r"hemicnn network.*grouplet-fast"):
        Predictor("grouplet-fast", path)


@pytest.mark.parametrize("damage", ["shape", "missing", "foreign"])
def test_tensors_of_another_shape_are_refused_by_name(tmp_path, damage):
    path, tensors = tmp_path / "h.safetensors", HemiCNN().state_dict()
    if damage == "shape":
        tensors["fc2.weight"] = tensors["fc2.weight"][:, 1:]
    elif damage == "missing":
        del tensors["fc2.weight"]
    else:
        tensors["fc4.weight"] = tensors["fc2.weight"]
    save_weights(path, tensors, card(), eight_bit=False)
    with pytest.raises(WeightsError, match=r"h\.safetensors does not fit.*fc[24]\.weight"):
        Predictor("hemicnn", path)
