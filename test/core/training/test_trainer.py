# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training learns, resumes to the same weights, and refuses what does not belong together."""

import csv
import dataclasses
import sys

import numpy as np
import pytest
import torch

from reflest_core.models.predictor import Predictor
from reflest_core.models.recipe import WEIGHT_DECAY, Augmentation
from reflest_core.models.registry import network_named
from reflest_core.models.weights import load_weights
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.data.sample_sets import TrainingData
from reflest_core.training.processes import Processes
from reflest_core.training.surface.task import SurfaceTask
from reflest_core.training.task import RunFolder
from reflest_core.training.trainer import Trainer
from reflest_core.training.weight_average import WeightAverage
from reflest_core.whole_file import OutputError
from test.core.training.scenes import learnable_samples

DATA = TrainingData(learnable_samples(40, 0), learnable_samples(10, 1), {"train": 40})
SMALL = Augmentation(views=(10, 30), candidates=30)
ALONE = Processes(0, 1, torch.device("cpu"))


def recipe(network="hemicnn", **changes):
    small = {
        "minibatches": 20,
        "batch_size": 4,
        "voxels": 8,
        "validation_voxels": 8,
        "augmentation": SMALL,
    }
    return dataclasses.replace(network_named(network).recipes["paper"], **{**small, **changes})


def train(folder, validate_every=1000, tensorboard=False, **changes):
    place = RunFolder(folder, "weights", validate_every, tensorboard)
    course = SurfaceTask(recipe(**changes), DATA, ALONE.device)
    return Trainer(course, place, ALONE).run()


def read_log(folder):
    with (folder / "log.csv").open() as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("loss", ["rmse1", "rmse2", "cuberoot"])
def test_every_loss_learns_what_is_plain_to_see(tmp_path, loss):
    path = train(
        tmp_path,
        loss=loss,
        optimiser="adam",
        minibatches=150,
        learning_rate=4e-3,
        colour_constancy=0.001,
        average=0.9,
        hold=0.5,
        warm_up=10,
    )
    predictor = Predictor("hemicnn", path)
    estimates = np.stack([predictor.predict(sample.surface).ward for sample in DATA.validation])
    truths = np.stack([sample.ward for sample in DATA.validation])
    errors = np.abs(estimates - truths)[:, :3].mean()
    guess = np.stack([sample.ward for sample in DATA.training]).mean(axis=0)
    guessing = np.abs(truths - guess)[:, :3].mean()
    assert errors < 0.6 * guessing


@pytest.mark.parametrize(
    ("network", "precision"),
    [("hemicnn", "float32"), ("grouplet", "float32"), ("grouplet", "bfloat16")],
)
def test_a_killed_training_resumes_to_the_same_weights(tmp_path, network, precision, monkeypatch):
    how = {
        "network": network,
        "precision": precision,
        "average": 0.9,
        "optimiser": "adam",
        "validate_every": 5,
    }
    expected, _, _ = load_weights(train(tmp_path / "whole", **how))

    class Killed(Exception):
        pass

    step = Trainer._step

    def step_until_killed(self, network, batch, minibatch):
        if minibatch == 13:
            raise Killed
        return step(self, network, batch, minibatch)

    monkeypatch.setattr(Trainer, "_step", step_until_killed)
    with pytest.raises(Killed):
        train(tmp_path / "killed", **how)
    monkeypatch.setattr(Trainer, "_step", step)
    resumed, _, _ = load_weights(train(tmp_path / "killed", **how))
    for name, tensor in expected.items():
        np.testing.assert_array_equal(resumed[name], tensor)


def test_a_finished_training_is_not_trained_again(tmp_path, monkeypatch):
    _, _, digest = load_weights(train(tmp_path))
    monkeypatch.setattr(Trainer, "_step", None)
    _, _, again = load_weights(train(tmp_path))
    assert again == digest


def test_the_log_follows_the_training(tmp_path):
    train(tmp_path, validate_every=8, learning_rate=2e-3, hold=0.0)
    lines = read_log(tmp_path)
    assert [line["minibatch"] for line in lines] == ["8", "16", "20"]
    assert float(lines[0]["learning_rate"]) > float(lines[2]["learning_rate"])
    assert all(float(line["validation_rmse"]) > 0 for line in lines)


def test_tensorboard_gets_what_the_csv_gets(tmp_path):
    accumulators = pytest.importorskip("tensorboard.backend.event_processing.event_accumulator")
    train(tmp_path, validate_every=10, tensorboard=True)
    events = accumulators.EventAccumulator(str(tmp_path / "tensorboard"))
    events.Reload()
    scalars = events.Scalars("validation_rmse")
    logged = read_log(tmp_path)
    assert [scalar.step for scalar in scalars] == [10, 20]
    for scalar, line in zip(scalars, logged, strict=True):
        assert scalar.value == pytest.approx(float(line["validation_rmse"]), rel=1e-5)


def test_without_tensorboard_its_log_is_refused_by_name(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch.utils.tensorboard", None)
    with pytest.raises(TrainingError, match="TensorBoard is not installed: pip install"):
        train(tmp_path, tensorboard=True)


def test_a_checkpoint_of_another_recipe_is_refused_by_name(tmp_path):
    train(tmp_path)
    with pytest.raises(TrainingError, match=r"checkpoint\.pt belongs to another recipe"):
        train(tmp_path, seed=2)


def test_a_damaged_checkpoint_is_named(tmp_path):
    train(tmp_path)
    (tmp_path / "checkpoint.pt").write_bytes(b"not a checkpoint")
    with pytest.raises(TrainingError, match=r"checkpoint\.pt is damaged"):
        train(tmp_path)


def test_a_checkpoint_that_cannot_be_written_is_named(tmp_path, monkeypatch):
    def full(_file):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OutputError, match=r"cannot write .*checkpoint\.pt: .*make room"):
        train(tmp_path)


def test_eight_bit_and_exact_weights_stand_side_by_side(tmp_path):
    path = train(tmp_path, network="grouplet")
    exact = tmp_path / "weights-float32.safetensors"
    assert path.stat().st_size < 340_000 < exact.stat().st_size
    quantised, card, _ = load_weights(path)
    tensors, _, _ = load_weights(exact)
    assert card.recipe["data"] == {"train": 40}
    difference = np.abs(quantised["branch.0.weight"] - tensors["branch.0.weight"]).max()
    assert 0 < difference < 0.01


def test_the_learning_rate_rises_holds_and_falls_to_nothing():
    schedule = recipe(minibatches=100, learning_rate=1e-3, warm_up=9, hold=0.5)
    assert schedule.learning_rate_at(0) == pytest.approx(1e-4)
    assert schedule.learning_rate_at(4) == pytest.approx(5e-4)
    assert schedule.learning_rate_at(9) == pytest.approx(1e-3)
    assert schedule.learning_rate_at(50) == pytest.approx(1e-3)
    assert schedule.learning_rate_at(75) == pytest.approx(5e-4)
    assert schedule.learning_rate_at(100) == pytest.approx(0, abs=1e-9)


def test_adamw_draws_weights_to_zero_where_nothing_else_moves_them():
    module = torch.nn.Linear(3, 2)
    before = module.weight.detach().clone()
    optimiser = recipe(optimiser="adamw", learning_rate=0.5).make_optimiser(module)
    for weight in module.parameters():
        weight.grad = torch.zeros_like(weight)
    optimiser.step()
    torch.testing.assert_close(module.weight.detach(), before * (1 - 0.5 * WEIGHT_DECAY))


def test_the_papers_rate_never_changes():
    assert recipe(minibatches=100).learning_rate_at(99) == 1e-4


def test_the_weights_mean_begins_quickly_and_then_moves_by_its_decay():
    average = WeightAverage({"w": torch.zeros(1)}, 0.9)
    average.update({"w": torch.ones(1)}, 1)
    assert average.mean["w"].item() == pytest.approx(10 / 11)
    average.update({"w": torch.zeros(1)}, 1000)
    assert average.mean["w"].item() == pytest.approx(0.9 * 10 / 11)
    follows = WeightAverage({"w": torch.zeros(1)}, 0.0)
    follows.update({"w": torch.full((1,), 3.0)}, 5)
    assert follows.mean["w"].item() == 3.0
