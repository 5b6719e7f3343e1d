# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training lightnet: variations stay true, the loss has known values, a killed run goes on."""

import dataclasses
import inspect
import math

import numpy as np
import pytest
import torch

from reflest_core.models.lightnet import VOXELS
from reflest_core.models.lightnet.features import light_features
from reflest_core.models.lightnet.network import LightNet
from reflest_core.models.registry import network_named
from reflest_core.models.weights import load_weights
from reflest_core.training.light.batches import varied_scans, whole_scans
from reflest_core.training.light.data import LightData
from reflest_core.training.light.scan_file import AXES
from reflest_core.training.light.task import SQUARED_SHARE, LightTask, likelihood_loss
from reflest_core.training.processes import Processes
from reflest_core.training.task import RunFolder
from reflest_core.training.trainer import Trainer
from test.core.surfaces import sphere_surface
from test.core.training.light.scans import SLOTS, TRUE, K, made_scans


def test_every_input_of_the_network_has_its_axes():
    assert list(AXES) == list(inspect.signature(LightNet.forward).parameters)[1:]
    surface = sphere_surface(VOXELS, 30)
    features = light_features(surface, np.arange(VOXELS))
    for name, axes in AXES.items():
        shape = getattr(features, name).shape
        assert len(shape) == len(axes)
        known = {"V": VOXELS, "O": SLOTS, "C": 3, "K": K, "D": 3}
        assert all(known.get(axis, size) == size for axis, size in zip(axes, shape, strict=True))


def test_varied_scans_still_obey_the_physics_of_their_truth():
    scans = made_scans(6, 0)
    rows = np.array([0, 3, 5, 5])
    features, truth = varied_scans(scans, rows, 20, 8, torch.Generator().manual_seed(2))
    assert features["is_seen"].shape == (4, 20, 8)
    expected = (
        truth[:, None, None, :3] + truth[:, None, None, 3:4] * features["lobe"][:, :, :, TRUE]
    )
    seen = features["is_seen"]
    torch.testing.assert_close(features["apparent"][seen], expected[seen], atol=0.02, rtol=5e-3)
    assert not torch.equal(truth[:, :3], torch.from_numpy(scans.ward[rows, :3]))
    torch.testing.assert_close(
        features["normals"].norm(dim=-1), torch.ones(4, 20), atol=2e-3, rtol=0
    )


def test_turning_keeps_the_vertical():
    """Light comes from above: heights of normals are kept, one by one."""
    scans = made_scans(2, 1)
    features, _ = varied_scans(scans, np.arange(2), VOXELS, SLOTS, torch.Generator().manual_seed(0))
    heights = np.sort(features["normals"][..., 2].numpy(), axis=1)
    np.testing.assert_allclose(
        heights, np.sort(scans.arrays["normals"][..., 2].astype(np.float32), axis=1), atol=1e-3
    )


def test_the_loss_is_a_weighted_gaussian_likelihood():
    means, truth = torch.tensor([[1.0]]), torch.tensor([[3.0]])
    log_variance = torch.tensor([[math.log(4.0)]], requires_grad=True)
    loss = likelihood_loss(means, log_variance, truth)
    negative_log = 0.5 * (math.log(4.0) + 4.0 / 4.0)
    assert loss.item() == pytest.approx(2.0 * negative_log + SQUARED_SHARE * 4.0)
    loss.backward()
    assert log_variance.grad.item() == pytest.approx(0.0, abs=1e-6)  # 4 is the variance seen


OURS = network_named("lightnet").recipes["ours"]
RECIPE = dataclasses.replace(OURS, minibatches=6, batch_size=4, warm_up=1)
ALONE = Processes(0, 1, torch.device("cpu"))


def trainer(folder, data, recipe=RECIPE, calibration=None, every=3):
    course = LightTask(recipe, data, ALONE.device, calibration)
    return Trainer(course, RunFolder(folder, "lightnet", every), ALONE)


def test_a_killed_training_goes_on_to_the_same_weights(tmp_path):
    data = LightData(made_scans(12, 0), made_scans(5, 1))
    whole = trainer(tmp_path / "whole", data).run()
    killed = trainer(tmp_path / "killed", data)
    take_step = killed._step

    def killed_at_five(network, batch, minibatch):
        if minibatch == 4:
            raise KeyboardInterrupt
        return take_step(network, batch, minibatch)

    killed._step = killed_at_five
    with pytest.raises(KeyboardInterrupt):
        killed.run()
    again = trainer(tmp_path / "killed", data).run()
    for name, tensor in load_weights(whole)[0].items():
        np.testing.assert_array_equal(load_weights(again)[0][name], tensor)


def test_it_learns_what_the_scans_tell(tmp_path):
    """From exact scans, the truth: far better than the mean after a few hundred minibatches."""
    data = LightData(made_scans(200, 0, noise=0.0), made_scans(50, 1, noise=0.0))
    small = {"minibatches": 150, "batch_size": 16, "voxels": 8, "warm_up": 10, "average": 0.9}
    recipe = dataclasses.replace(RECIPE, **small)
    path = trainer(tmp_path, data, recipe, every=150).run()
    rmse = float((tmp_path / "log.csv").read_text().splitlines()[-1].split(",")[2])
    assert rmse < 0.8
    assert path.stat().st_size < 340_000


def test_padding_is_never_looked_at():
    scans = made_scans(2, 4)
    clean = {n: t.clone() for n, t in whole_scans(scans, np.arange(2)).items()}
    dirty = {n: t.clone() for n, t in clean.items()}
    unseen = ~clean["is_seen"].any(dim=2)
    dirty["voxel_fit"][unseen] = 7.0
    dirty["normals"][unseen] = 5.0
    module = LightNet().eval()
    for one, other in zip(module(**clean), module(**dirty), strict=True):
        torch.testing.assert_close(one, other)


def test_the_update_alone_learns_from_the_posterior_and_keeps_all_else(tmp_path):
    """The posterior's roughness is exact here, and the rest of the network untrained."""
    scans = made_scans(120, 0)
    data = LightData(scans, made_scans(20, 1))
    for some in (data.training, data.validation):
        some.arrays["gloss_answers"][:] = some.ward[:, 3:]
    small = {"minibatches": 60, "batch_size": 16, "voxels": 4, "only": "update"}
    recipe = dataclasses.replace(RECIPE, **small, average=0.0, learning_rate=0.02)
    training = trainer(tmp_path, data, recipe, every=60)
    before = {name: t.clone() for name, t in training.module.state_dict().items()}
    first = training.task.rmse(training.module.eval())
    tensors, card, _ = load_weights(training.run())
    assert float((tmp_path / "log.csv").read_text().splitlines()[-1].split(",")[2]) < first
    for name, tensor in before.items():
        is_kept = bool((tensors[name] == tensor.numpy()).all())
        assert is_kept != name.startswith("update"), name
    assert card.recipe["gloss_posterior"] is True
