# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What an estimate costs, counted in work, for seconds say little on a busy machine."""

from collections import Counter

import numpy as np
import pytest

from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.evidence import SAMPLED
from reflest_core.models import linear_algebra
from reflest_core.models.grouplet import live as live_grouplet
from reflest_core.models.predictor import CHOICES
from reflest_core.models.registry import models, network_of_model
from reflest_core.surface import voxel_choice
from reflest_core.surface.voxel_choice import MOST_CANDIDATES
from test.core.lit_surfaces import lit
from test.core.surfaces import sphere_surface
from test.core.weight_files import untrained_lightnet

BRANCH, NODE_PLACE, NODE_REST = 12 * 128 + 128 * 128, 128 * 256, 256 * 128
REGRESSOR = 256 * 128 + 128 * 128 + 128 * 5


@pytest.fixture
def work(monkeypatch):
    """Counts multiplications and distances while an estimate is made."""
    done = Counter()
    product, cluster = linear_algebra.product, voxel_choice._k_centre_clusters
    draw = live_grouplet.draw_grouplets

    def counted_product(left, right, out=None):
        done["multiplications"] += left.size * right.shape[-1]
        return product(left, right, out)

    def counted_cluster(points, count):
        done["distances"] += points.shape[1] * count
        return cluster(points, count)

    def counted_draw(*arguments):
        drawn = draw(*arguments)
        done["nodes"] += len(drawn.members)
        done["observations"] += len(drawn.observations)
        places = [np.unique(drawn.members[:, place]) for place in range(5)]
        done["pairs"] += sum(map(len, places))
        return drawn

    monkeypatch.setattr(linear_algebra, "product", counted_product)
    monkeypatch.setattr(voxel_choice, "_k_centre_clusters", counted_cluster)
    monkeypatch.setattr(live_grouplet, "draw_grouplets", counted_draw)
    return done


def work_on(surface, model, work, weights=""):
    work.clear()
    Estimator(EstimationSettings(model=model, weights=weights)).estimate(surface, 0, "")
    return dict(work)


@pytest.mark.parametrize("model", models())
def test_a_tenfold_scan_costs_no_more(model, work, tmp_path):
    weights = str(untrained_lightnet(tmp_path)) if model == "lightnet" else ""
    small, large = (
        work_on(lit(sphere_surface(voxels=voxels, views=60)), model, work, weights)
        for voxels in (5_000, 50_000)
    )
    for kind, cost in large.items():
        # Of more voxels better observed ones are chosen, whose observations repeat less often.
        assert cost <= 1.2 * small[kind], kind
    # lightnet's physics fits gloss to voxels of its own choice.
    chosen = models()[model].voxels
    if network_of_model(model).sees_light:
        chosen = CHOICES * chosen + SAMPLED
    assert large["distances"] <= MOST_CANDIDATES * chosen


@pytest.mark.parametrize("model", ["grouplet-fast", "grouplet-slow"])
def test_grouplet_multiplies_no_observation_twice(model, work):
    done = work_on(sphere_surface(voxels=2_000, views=60), model, work)
    nodes, observations, pairs = (done[name] for name in ("nodes", "observations", "pairs"))
    assert nodes == 10 * models()[model].voxels
    assert observations < 0.7 * 5 * nodes
    assert pairs < 0.9 * 5 * nodes
    assert done["multiplications"] == (
        observations * BRANCH + pairs * NODE_PLACE + nodes * NODE_REST + REGRESSOR
    )


def test_hemicnn_multiplies_once_for_each_voxel(work):
    done = work_on(sphere_surface(voxels=2_000, views=60), "hemicnn", work)
    each = 64 * 27 * 16 + 36 * 144 * 16 + 144 * 64
    assert done["multiplications"] == 25 * each + 64 * 32 + 32 * 5
