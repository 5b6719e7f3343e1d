"""Training learns, resumes to the same weights, and refuses what does not belong together."""

import dataclasses

import numpy as np
import pytest
import torch

from reflest_core.models.predictor import Predictor
from reflest_core.models.weights import load_weights
from reflest_core.training import trainer as trainer_module
from reflest_core.training.augmentation import Augmentation
from reflest_core.training.recipe import PAPER_RECIPES
from reflest_core.training.sample import TrainingError
from reflest_core.training.trainer import Trainer
from test.core.training.scenes import learnable_samples

TRAINING, VALIDATION = learnable_samples(40, 0), learnable_samples(10, 1)
SMALL = Augmentation(views=(10, 30), voxels=30)


def recipe(network="hemicnn", **changes):
    small = {"minibatches": 20, "batch_size": 4, "voxels": 8, "augmentation": SMALL}
    return dataclasses.replace(PAPER_RECIPES[network], **{**small, **changes})


def train(folder, **changes):
    return Trainer(recipe(**changes), TRAINING, VALIDATION, folder, {"train": 40}).run()


@pytest.mark.parametrize("loss", ["rmse1", "rmse2", "cuberoot"])
def test_every_loss_learns_what_is_plain_to_see(tmp_path, loss):
    run = Trainer(
        recipe(loss=loss, minibatches=400, learning_rate=2e-3, colour_constancy=0.001),
        TRAINING, VALIDATION, tmp_path, {},
    )  # fmt: skip
    path = run.run()
    predictor = Predictor("hemicnn", path)
    estimates = np.stack([predictor.predict(sample.surface).ward for sample in VALIDATION])
    truths = np.stack([sample.ward for sample in VALIDATION])
    errors = np.abs(estimates - truths)[:, :3].mean()
    guessing = np.abs(truths - np.stack([s.ward for s in TRAINING]).mean(axis=0))[:, :3].mean()
    assert errors < 0.6 * guessing
    assert (tmp_path / "log.csv").read_text().startswith("minibatch,training_loss")


@pytest.mark.parametrize("network", ["hemicnn", "grouplet"])
def test_a_killed_training_resumes_to_the_same_weights(tmp_path, network, monkeypatch):
    monkeypatch.setattr(trainer_module, "VALIDATE_EVERY", 5)
    expected, _, _ = load_weights(train(tmp_path / "whole", network=network))

    class Killed(Exception):
        pass

    step = Trainer._step

    def step_until_killed(self, batch, minibatch):
        if minibatch == 13:
            raise Killed
        return step(self, batch, minibatch)

    monkeypatch.setattr(Trainer, "_step", step_until_killed)
    with pytest.raises(Killed):
        train(tmp_path / "killed", network=network)
    monkeypatch.setattr(Trainer, "_step", step)
    resumed, _, _ = load_weights(train(tmp_path / "killed", network=network))
    for name, tensor in expected.items():
        torch.testing.assert_close(resumed[name], tensor, rtol=0, atol=0)


def test_a_checkpoint_of_another_recipe_is_refused_by_name(tmp_path):
    train(tmp_path)
    with pytest.raises(TrainingError, match=r"checkpoint\.pt belongs to another recipe"):
        train(tmp_path, seed=2)


def test_a_damaged_checkpoint_is_named(tmp_path):
    train(tmp_path)
    (tmp_path / "checkpoint.pt").write_bytes(b"not a checkpoint")
    with pytest.raises(TrainingError, match=r"checkpoint\.pt is damaged"):
        train(tmp_path)


def test_eight_bit_and_exact_weights_stand_side_by_side(tmp_path):
    path = train(tmp_path, network="grouplet")
    exact = tmp_path / "grouplet-float32.safetensors"
    assert path.stat().st_size < 340_000 < exact.stat().st_size
    quantised, card, _ = load_weights(path)
    tensors, _, _ = load_weights(exact)
    assert card.recipe["data"] == {"train": 40}
    difference = (quantised["branch.0.weight"] - tensors["branch.0.weight"]).abs().max()
    assert 0 < difference < 0.01


def test_the_learning_rate_holds_then_falls_to_nothing():
    schedule = recipe(minibatches=100)
    assert schedule.learning_rate_at(0) == pytest.approx(1e-4)
    assert schedule.learning_rate_at(50) == pytest.approx(1e-4)
    assert schedule.learning_rate_at(75) == pytest.approx(0.5e-4)
    assert schedule.learning_rate_at(100) == pytest.approx(0, abs=1e-9)
