# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Threads of an estimate: bounded, and nobody's limit is lifted by another's end."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from reflest_core.models.grouplet import live as live_grouplet
from reflest_core.models.hemicnn import live as live_hemicnn
from reflest_core.models.lightnet import live as live_lightnet
from reflest_core.models.linear_algebra import _blas_libraries, one_blas_thread, run_in_threads
from reflest_core.models.predictor import Predictor
from test.core.surfaces import sphere_surface
from test.core.weight_files import untrained_lightnet


@pytest.fixture(autouse=True)
def _libraries_of_now():
    """Other tests may have loaded a BLAS after the libraries were looked for."""
    _blas_libraries.cache_clear()


def blas_threads():
    return {
        library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"
    }


def test_products_stay_in_one_thread_until_the_last_has_left():
    with threadpool_limits(2, user_api="blas"):
        before = blas_threads()
        first, second = one_blas_thread(), one_blas_thread()
        first.__enter__()
        assert blas_threads() == {1}
        second.__enter__()
        first.__exit__(None, None, None)
        assert blas_threads() == {1}
        second.__exit__(None, None, None)
        assert blas_threads() == before
        with pytest.raises(KeyError), one_blas_thread():
            raise KeyError
        assert blas_threads() == before


@pytest.mark.parametrize("threads", [1, 3])
def test_every_share_of_the_work_is_done(threads):
    done = []
    run_in_threads(done.append, threads)
    assert sorted(done) == list(range(threads))


def test_a_thread_that_fails_is_heard_of():
    def work(worker):
        if worker == 1:
            raise ValueError("worker 1")

    with pytest.raises(ValueError, match="worker 1"):
        run_in_threads(work, 2)


@pytest.mark.parametrize(
    ("model", "network", "features"),
    [
        ("lightnet", live_lightnet, "features_of_choices"),
        ("grouplet-fast", live_grouplet, "draw_grouplets"),
        ("hemicnn", live_hemicnn, "hemisphere_images"),
    ],
)
def test_features_are_built_on_one_thread_too(model, network, features, monkeypatch, tmp_path):
    threads = []
    build = getattr(network, features)

    def built(*arguments):
        threads.append(blas_threads())
        return build(*arguments)

    monkeypatch.setattr(network, features, built)
    predictor = Predictor(model, untrained_lightnet(tmp_path) if model == "lightnet" else None)
    surface = sphere_surface(voxels=600, views=20)
    predictor.predict(surface)
    _blas_libraries.cache_clear()  # kernels and other tests have loaded another BLAS meanwhile
    with threadpool_limits(2, user_api="blas"):
        predictor.predict(surface)
    assert threads[1] == {1}
