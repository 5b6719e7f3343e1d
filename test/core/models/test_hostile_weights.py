# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Weight files made to mislead: each ends in one sentence, before anything large is read."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from safetensors import safe_open
from safetensors.numpy import save_file

from reflest_core.models.definition import Scores
from reflest_core.models.predictor import Predictor
from reflest_core.models.registry import models
from reflest_core.models.weights import FORMAT, WeightsError, content_hash
from test.core.surfaces import sphere_surface

SHIPPED = models()["lightnet"].weights


def shipped():
    with safe_open(SHIPPED, framework="np") as file:
        return {name: file.get_tensor(name) for name in file.keys()}, file.metadata()["card"]  # noqa: SIM118


def written(path, tensors=None, card=None, **metadata):
    """A file with a hash that is right, whatever it holds."""
    own_tensors, own_card = shipped()
    tensors = own_tensors if tensors is None else tensors
    card = own_card if card is None else card
    about = {"format": FORMAT, "card": card, "sha256": content_hash(tensors, card)} | metadata
    save_file(tensors, path, about)
    return path


def changed_card(**fields):
    return json.dumps(json.loads(shipped()[1]) | fields)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "w.safetensors"


def test_the_unchanged_file_is_loaded(path):
    Predictor("lightnet", written(path))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_weights_that_are_not_finite(path, value):
    tensors, _ = shipped()
    name = sorted(tensors)[0]
    tensors[name] = np.full_like(tensors[name], value)
    with pytest.raises(WeightsError, match=f"{name} holds numbers that are not finite"):
        Predictor("lightnet", written(path, tensors))


STATISTICS = json.loads(shipped()[1])["statistics"]
CARDS = {
    "no JSON": "hello",
    "empty": "{}",
    "a list": "[]",
    "nested without end": "[" * 100_000,
    "another variant": changed_card(variant="evil"),
    "another meaning": changed_card(parameters="zzz"),
    "recipe is a number": changed_card(recipe=7),
    "no statistics": changed_card(statistics={}),
    "statistics of words": changed_card(
        statistics=STATISTICS | {"ward": {"mean": "x", "stddev": "y"}}
    ),
    "statistics too short": changed_card(
        statistics=STATISTICS | {"ward": {"mean": [0], "stddev": [1]}}
    ),
    "no spread": changed_card(
        statistics=STATISTICS | {"labcd": {"mean": [0] * 5, "stddev": [0] * 5}}
    ),
    "mean is NaN": changed_card(
        statistics=STATISTICS | {"labcd": {"mean": [float("nan")] * 5, "stddev": [1] * 5}}
    ),
    "negative factors": changed_card(stddev_factors=[-1] * 5),
    "factors are NaN": changed_card(stddev_factors=[float("nan")] * 5),
    "powers of 0": changed_card(stddev_powers=[0] * 5),
    "correlation too small": changed_card(error_correlation=[[1]]),
    "correlation above 1": changed_card(error_correlation=[[9] * 5] * 5),
    "ragged correlation": changed_card(error_correlation=[[1], [1, 2]]),
}


@pytest.mark.parametrize("card", CARDS.values(), ids=CARDS)
def test_cards_that_describe_no_network(path, card):
    with pytest.raises(WeightsError, match="describes no network that can be used") as refused:
        Predictor("lightnet", written(path, card=card))
    assert len(str(refused.value)) < 500


@pytest.mark.parametrize("dtype", [np.float64, np.int32, np.float16])
def test_tensors_of_another_type(path, dtype):
    tensors = {name: tensor.astype(dtype) for name, tensor in shipped()[0].items()}
    with pytest.raises(WeightsError, match=r"is of type .*, not F32 or I8"):
        Predictor("lightnet", written(path, tensors))


def test_eight_bit_tensors_without_their_scales(path):
    tensors = shipped()[0]
    name = next(name for name in tensors if tensors[name].ndim == 2)
    tensors[name] = tensors[name].astype(np.int8)
    with pytest.raises(WeightsError, match=f"{name} has no scale"):
        Predictor("lightnet", written(path, tensors))


def test_metadata_without_card_and_hash(path):
    save_file(shipped()[0], path, {"format": FORMAT})
    with pytest.raises(WeightsError, match="does not match its own hash"):
        Predictor("lightnet", path)


def header(described, data=b"", length=None):
    return struct.pack("<Q", len(described) if length is None else length) + described + data


def one_tensor(dtype, size, shape=(1,)):
    tensor = {"dtype": dtype, "shape": list(shape), "data_offsets": [0, size]}
    return json.dumps({"x": tensor, "__metadata__": {"format": FORMAT}}).encode()


FILES = {
    "empty": b"",
    "1 GB of header declared": header(b"{}", length=1 << 30),
    "2^64 of header declared": header(b"{}", length=2**64 - 1),
    "a header nested without end": header(b'{"a":' * 50_000),
    "4 TB of data declared": header(one_tensor("F32", 4 * 10**12, (10**12,))),
    "bfloat16": header(one_tensor("BF16", 2), b"\0" * 2),
    "8-bit floats": header(one_tensor("F8_E4M3", 1), b"\0"),
}


@pytest.mark.parametrize("content", FILES.values(), ids=FILES)
def test_files_that_are_none(path, content):
    path.write_bytes(content)
    with pytest.raises(WeightsError):
        Predictor("lightnet", path)


def test_a_file_of_any_size_is_refused_unread(path):
    with path.open("wb") as file:
        file.truncate(600 * 10**6)
    with pytest.raises(WeightsError, match="600 MB, more than the 512 MB"):
        Predictor("lightnet", path)


class Overflowing:
    """A network whose finite weights give outputs that are not."""

    def scores(self, surface, choices, found=None):
        return [Scores(np.full(5, np.inf, np.float32), np.zeros(5, np.float32)) for _ in choices]


def test_outputs_that_are_not_finite_are_no_estimate():
    predictor = Predictor("lightnet")
    predictor.network = Overflowing()
    with pytest.raises(WeightsError, match="gives numbers that are not finite"):
        predictor.predict(sphere_surface(voxels=60, views=10))
