# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet while scanning: PyTorch's results, whatever the padding."""

import dataclasses

import numpy as np
import pytest
import torch

from reflest_core.inference.material import explain
from reflest_core.light.light_map import LightMap
from reflest_core.models.lightnet import VOXELS
from reflest_core.models.lightnet.features import LightFeatures, features_of
from reflest_core.models.lightnet.gloss_evidence import GLOSS_EVIDENCE
from reflest_core.models.lightnet.live import LiveLightNet
from reflest_core.models.lightnet.network import LightNet
from reflest_core.models.lightnet.shapes import ADDED, UPDATE_HEADS
from reflest_core.models.registry import models, network_named
from reflest_core.models.weights import load_weights
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.training.light.scan_file import AXES
from test.core.surfaces import sphere_surface


@pytest.fixture(scope="module")
def network():
    torch.manual_seed(1)
    module = LightNet().eval()
    return module, LiveLightNet({name: t.numpy() for name, t in module.state_dict().items()})


def look_at(voxels, seed=0):
    rng = np.random.default_rng(seed)
    light = LightMap()
    directions = rng.normal(size=(4000, 3)).astype(np.float32)
    light.add(
        directions[directions[:, 2] < 0.5],
        rng.integers(0, 256, (int((directions[:, 2] < 0.5).sum()), 3)).astype(np.uint8),
    )
    surface = sphere_surface(voxels=300, views=40)
    return features_of(explain(surface, light.observed()), choose_voxels(surface, voxels))


def batched(look, padding):
    arrays = {}
    for field in dataclasses.fields(LightFeatures):
        array = getattr(look, field.name)
        if AXES[field.name].startswith("V"):
            array = np.pad(array, [(0, padding)] + [(0, 0)] * (array.ndim - 1))
        arrays[field.name] = torch.from_numpy(array)[None]
    return arrays


@pytest.mark.parametrize("voxels", [1, 7, VOXELS])
def test_it_is_pytorchs_with_any_padding(network, voxels):
    module, live = network
    look = look_at(voxels)
    means, log_variances = live.evaluate(look)
    for padding in (0, 5):
        with torch.inference_mode():
            expected = module(**batched(look, padding))
        np.testing.assert_allclose(means, expected[0][0].numpy(), atol=2e-5)
        np.testing.assert_allclose(log_variances, expected[1][0].numpy(), atol=2e-5)


def test_pytorch_can_compile_the_module(network):
    module, _ = network
    inputs = batched(look_at(7), 0)
    torch.compiler.reset()
    with torch.inference_mode():
        means, _ = torch.compile(module, backend="eager", fullgraph=True)(**inputs)
        torch.testing.assert_close(means, module(**inputs)[0])


def test_what_the_physics_found_can_be_believed(network):
    """With all belief in one answer of each kind, the estimate is that answer, scaled."""
    module, _ = network
    tensors = {name: t.numpy().copy() for name, t in module.state_dict().items()}
    for head, believed in (("diffuse_head", 1), ("strength_head", 0), ("roughness_head", 1)):
        tensors[f"{head}.weight"][:] = 0.0
        tensors[f"{head}.bias"][:] = 0.0
        tensors[f"{head}.bias"][2 + believed] = 50.0
    look = look_at(20)
    means, log_variances = LiveLightNet(tensors).evaluate(look)
    expected = [*look.found_albedo[:, 1], look.found_gloss[0], look.found_gloss[2]]
    scale = tensors["found_scale"][[0, 0, 0, 1, 2]]
    np.testing.assert_allclose(means, scale * expected, rtol=1e-5)
    np.testing.assert_array_equal(log_variances, 0.0)


def test_colour_channels_are_alike(network):
    """Red light and red material swapped with blue swaps the estimate, and nothing else."""
    _, live = network
    look = look_at(20)
    swap = [2, 1, 0]
    swapped = dataclasses.replace(
        look,
        apparent=look.apparent[..., swap],
        clipped=look.clipped[..., swap],
        lobe=look.lobe[..., swap],
        diffuse_light=look.diffuse_light[:, swap],
        voxel_fit=look.voxel_fit[:, swap],
        scene_fit=look.scene_fit[swap],
        zones=look.zones[:, [*swap, 3, 4]],
        channel_statistics=look.channel_statistics[swap],
        found_albedo=look.found_albedo[swap],
    )
    for found, expected in zip(live.evaluate(swapped), live.evaluate(look), strict=True):
        np.testing.assert_allclose(found, expected[[*swap, 3, 4]], atol=1e-5)


def with_evidence(features):
    """The same surface with what some observations say about roughness."""
    rng = np.random.default_rng(5)
    return dataclasses.replace(
        features,
        gloss_evidence=rng.normal(size=GLOSS_EVIDENCE).astype(np.float32),
        gloss_answers=np.array([0.03, 0.05], np.float32),
    )


def test_weights_from_before_the_update_give_the_same_bits_whatever_the_posterior():
    tensors = load_weights(models()["lightnet"].weights)[0]
    earlier = {name: t for name, t in tensors.items() if not name.startswith(ADDED)}
    shipped = LiveLightNet(network_named("lightnet").completed(earlier))
    features = look_at(20)
    for found, expected in zip(
        shipped.evaluate(with_evidence(features)), shipped.evaluate(features), strict=True
    ):
        np.testing.assert_array_equal(found, expected)


def test_a_trained_update_is_pytorchs_and_moves_the_estimate():
    torch.manual_seed(3)
    module = LightNet().eval()
    features = with_evidence(look_at(20))
    with torch.inference_mode():
        before = module(**batched(features, 0))
        for name in UPDATE_HEADS:
            torch.nn.init.normal_(getattr(module, name).weight, std=0.3)
        expected = module(**batched(features, 0))
    tensors = {name: t.numpy() for name, t in module.state_dict().items()}
    found = LiveLightNet(tensors).evaluate(features)
    for one, other, unchanged in zip(found, expected, before, strict=True):
        np.testing.assert_allclose(one, other[0].numpy(), atol=2e-5)
        assert np.abs(one - unchanged[0].numpy()).min() > 1e-4


def test_with_all_weight_the_posteriors_answer_is_the_estimate():
    module = LightNet()
    tensors = {name: t.numpy().copy() for name, t in module.state_dict().items()}
    tensors["update_gloss.bias"][:2] = 1.0
    features = with_evidence(look_at(20))
    means, _ = LiveLightNet(tensors).evaluate(features)
    expected = features.gloss_answers * tensors["found_scale"][1:]
    np.testing.assert_allclose(means[3:], expected, atol=1e-5)
