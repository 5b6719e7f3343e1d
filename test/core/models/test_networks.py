# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The two networks: the paper's sizes, and what their outputs may and may not depend on."""

import torch

from reflest_core.models.grouplet.network import Grouplet
from reflest_core.models.hemicnn.network import HemiCNN


def bytes_in_float32(module):
    return 4 * sum(parameter.numel() for parameter in module.parameters())


def test_hemicnn_has_the_papers_56_kb():
    assert bytes_in_float32(HemiCNN()) == 57_172


def test_grouplet_has_265_989_weights_and_643_node_inputs():
    grouplet = Grouplet()
    assert sum(parameter.numel() for parameter in grouplet.parameters()) == 265_989
    assert grouplet.node[0].in_features == 643
    assert grouplet.regressor[0].in_features == 256


def test_hemicnn_ignores_the_order_and_the_repetition_of_voxels():
    torch.manual_seed(0)
    network, images = HemiCNN(), torch.rand(1, 25, 3, 10, 10)
    expected = network(images)
    shuffled = images[:, torch.randperm(25)]
    torch.testing.assert_close(network(shuffled), expected)
    torch.testing.assert_close(network(torch.cat([images, images[:, :5]], dim=1)), expected)
    assert not torch.allclose(network(images * 0.5), expected)


def test_grouplet_takes_any_number_of_nodes_in_any_order():
    torch.manual_seed(0)
    network = Grouplet()
    branches, normals = torch.rand(2, 200, 5, 12), torch.rand(2, 200, 3)
    expected = network(branches, normals)
    assert expected.shape == (2, 5)
    order = torch.randperm(200)
    torch.testing.assert_close(network(branches[:, order], normals[:, order]), expected)
    twice = network(torch.cat([branches] * 2, dim=1), torch.cat([normals] * 2, dim=1))
    torch.testing.assert_close(twice, expected)
    assert not torch.allclose(network(branches, -normals), expected)


def test_grouplet_depends_on_the_order_of_branches_within_a_node():
    torch.manual_seed(0)
    network = Grouplet()
    branches, normals = torch.rand(1, 50, 5, 12), torch.rand(1, 50, 3)
    assert not torch.allclose(network(branches.flip(2), normals), network(branches, normals))
