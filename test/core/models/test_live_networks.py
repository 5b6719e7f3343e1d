# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The networks as they run while scanning: PyTorch's results, repeatable, nothing done twice."""

import subprocess
import sys

import numpy as np
import pytest
import torch

from reflest_core.models.grouplet import live as live_grouplet
from reflest_core.models.grouplet.grouplets import NODES_PER_VOXEL, draw_grouplets
from reflest_core.models.grouplet.live import LiveGrouplet, observations_by_place
from reflest_core.models.grouplet.network import Grouplet
from reflest_core.models.hemicnn import live as live_hemicnn
from reflest_core.models.hemicnn.hemisphere_images import hemisphere_images
from reflest_core.models.hemicnn.live import LiveHemiCNN
from reflest_core.models.hemicnn.network import HemiCNN
from reflest_core.models.lightnet import shapes as lightnet_shapes
from reflest_core.models.lightnet.network import LightNet
from reflest_core.models.predictor import Predictor
from reflest_core.models.registry import models, network_of_model, shipped_models
from reflest_core.models.torch_network import DeviceError, TorchNetwork
from reflest_core.models.weights import load_weights
from reflest_core.surface.voxel_choice import choose_voxels
from test.core.lit_surfaces import lit
from test.core.surfaces import sphere_surface
from test.core.weight_files import untrained_lightnet

SURFACE = sphere_surface(voxels=600, views=60)


def random_weights(module):
    torch.manual_seed(1)
    for parameter in module.parameters():
        torch.nn.init.normal_(parameter, std=parameter.shape[-1] ** -0.5)
    return module, {name: tensor.numpy() for name, tensor in module.state_dict().items()}


@pytest.mark.parametrize(
    ("make", "shapes"),
    [
        (HemiCNN, live_hemicnn.SHAPES),
        (Grouplet, live_grouplet.SHAPES),
        (LightNet, lightnet_shapes.SHAPES),
    ],
)
def test_shapes_are_those_of_the_module(make, shapes):
    assert {name: tuple(t.shape) for name, t in make().state_dict().items()} == shapes


@pytest.mark.parametrize("voxels", [1, 25, 60])
def test_hemicnn_is_pytorchs(voxels):
    module, tensors = random_weights(HemiCNN())
    images = hemisphere_images(SURFACE, choose_voxels(SURFACE, voxels))
    with torch.inference_mode():
        expected = module(torch.from_numpy(images)[None])[0].numpy()
    np.testing.assert_allclose(LiveHemiCNN(tensors).evaluate(images), expected, atol=1e-5)


@pytest.mark.parametrize("voxels", [1, 20, 354])
@pytest.mark.parametrize("nodes", [1, 3, NODES_PER_VOXEL])
def test_grouplet_is_pytorchs(voxels, nodes):
    module, tensors = random_weights(Grouplet())
    drawn = draw_grouplets(SURFACE, choose_voxels(SURFACE, voxels), 3, nodes)
    with torch.inference_mode():
        inputs = torch.from_numpy(drawn.branches), torch.from_numpy(drawn.normals)
        expected = module(*(values[None] for values in inputs))[0].numpy()
    np.testing.assert_allclose(LiveGrouplet(tensors, 1).evaluate(drawn), expected, atol=1e-5)


@pytest.fixture(params=[*shipped_models(), "lightnet, untrained"])
def weights(request, tmp_path):
    """A model and a weight file for it."""
    if request.param == "lightnet, untrained":
        return "lightnet", untrained_lightnet(tmp_path)
    return request.param, models()[request.param].weights


def test_weights_predict_what_pytorch_predicts(weights):
    model, path = weights
    choice = network_of_model(model)
    surface = lit(SURFACE, seen=0.6, lamp=True)
    voxels = choose_voxels(surface, models()[model].voxels)
    (live,) = Predictor(model, path).network.scores(surface, [voxels])
    (expected,) = TorchNetwork(choice, choice.completed(load_weights(path)[0]), "cpu").scores(
        surface, [voxels]
    )
    np.testing.assert_allclose(live.means, expected.means, atol=2e-5)
    assert (live.log_variances is not None) == choice.sees_light
    if choice.sees_light:
        np.testing.assert_allclose(live.log_variances, expected.log_variances, atol=2e-5)


@pytest.mark.skipif(not torch.cuda.is_available(), reason="PyTorch finds no CUDA device here")
def test_cuda_predicts_what_the_cpu_predicts(weights):
    cpu, cuda = Predictor(*weights), Predictor(*weights, device="cuda")
    surface = lit(SURFACE, seen=0.6, lamp=True)
    expected, found, again = (one.predict(surface) for one in (cpu, cuda, cuda))
    np.testing.assert_allclose(found.ward, expected.ward, rtol=1e-4, atol=1e-5)
    np.testing.assert_array_equal(found.ward, again.ward)
    if network_of_model(weights[0]).sees_light:
        np.testing.assert_allclose(found.stddev, expected.stddev, rtol=1e-4)
        np.testing.assert_array_equal(found.stddev, again.stddev)


@pytest.mark.skipif(torch.cuda.is_available(), reason="PyTorch finds a CUDA device here")
def test_cuda_where_there_is_none_is_refused_with_the_knob():
    with pytest.raises(DeviceError, match=r"estimation\.device is cuda.*no CUDA device.*cpu"):
        Predictor("hemicnn", device="cuda")


def test_cuda_without_pytorch_is_refused_with_the_knob(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(DeviceError, match=r"estimation\.device cuda needs PyTorch.*training"):
        Predictor("hemicnn", device="cuda")


def test_the_number_of_threads_changes_no_bit():
    drawn = draw_grouplets(SURFACE, choose_voxels(SURFACE, 354), 0)
    tensors, _, _ = load_weights(models()["grouplet-slow"].weights)
    one, many = (LiveGrouplet(tensors, threads) for threads in (1, 3))
    expected = one.evaluate(drawn)
    for network in (one, many, many):
        np.testing.assert_array_equal(network.evaluate(drawn), expected)


def test_pairs_of_observation_and_place_are_distinct_and_rebuild_the_nodes():
    members = np.random.default_rng(0).integers(100, 107, (40, 5)).astype(np.int32)
    first, last, rows, ends, summands = observations_by_place(members)
    assert (first, last) == (100, 107)
    np.testing.assert_array_equal(first + rows[summands], members)
    for place in range(5):
        part = rows[ends[place] : ends[place + 1]]
        assert (first + part).tolist() == sorted(set(members[:, place].tolist()))
        assert (summands[:, place] >= ends[place]).all()
        assert (summands[:, place] < ends[place + 1]).all()


def test_estimating_imports_neither_pytorch_nor_what_trains():
    script = (
        "import sys\n"
        "from reflest_core.cli.replay.runner import replay\n"
        "from reflest_core.models.lightnet.live import LiveLightNet\n"
        "from reflest_core.models.predictor import Predictor\n"
        "from reflest_core.models.registry import shipped_models\n"
        "for model in shipped_models(): Predictor(model)\n"
        "heavy = {'torch', 'mitsuba', 'dask', 'matplotlib', 'onnxruntime'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
