# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The data set from a Dask cluster: two workers on this machine, the same bytes."""

import os

import pytest

pytest.importorskip("mitsuba")
pytest.importorskip("distributed")

import dask.config
import distributed

from reflest_core.cli.main import main
from reflest_core.synbrdf.generation.dask_cluster import ClusterError, dask_cluster
from reflest_core.synbrdf.generation.data_set import Generation, ShardTask
from reflest_core.synbrdf.generation.generate import generate, render_agreed
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.generation.shard_workers import WorkerError
from reflest_core.synbrdf.relit.relighting import Relighting, RelitShard, relight, relit_agreed
from reflest_core.synbrdf.scenes.scene_file import sha256
from reflest_core.synbrdf.scenes.splits import Split

GENERATION = Generation(
    seed=11,
    scenes={"train": 1, "validation": 1, "unseen": 1},
    points=20,
    views=4,
    samples=4,
)
OPTIONS = ["--seed", "11", "--train", "1", "--validation", "1", "--unseen", "1"]
OPTIONS += ["--points", "20", "--views", "4", "--samples", "4"]


def hashes(folder):
    return {path.name: sha256(path) for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def cluster():
    # Two threads each, which the lock about the renderer must put up with.
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=2,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        memory_limit=None,
    ) as running:
        yield running


def test_two_workers_write_the_bytes_of_the_process_pool(cluster, tmp_path):
    address = cluster.scheduler_address
    folder = str(tmp_path / "dask")
    assert main(["synbrdf", "generate", "--out", folder, "--scheduler", address, *OPTIONS]) == 0
    generate(tmp_path / "pool", GENERATION, process_pool(1))
    expected = hashes(tmp_path / "pool")
    assert len(expected) == 4
    assert hashes(tmp_path / "dask") == expected
    # It resumes as any run does.
    (tmp_path / "dask" / "train-00000.safetensors").unlink()
    generate(tmp_path / "dask", GENERATION, dask_cluster(address))
    assert hashes(tmp_path / "dask") == expected


def test_two_workers_relight_as_the_process_pool_does(cluster, tmp_path):
    data = tmp_path / "data"
    generate(data, GENERATION, process_pool(1))
    words = ["--out", str(tmp_path / "dask"), "--scheduler", cluster.scheduler_address]
    assert main(["synbrdf", "relight", str(data), *words, "--copies", "2"]) == 0
    relight(tmp_path / "pool", Relighting(data, 2), process_pool(1))
    expected = hashes(tmp_path / "pool")
    assert set(expected) == {
        "manifest.json",
        "train-00000-0.safetensors",
        "train-00000-1.safetensors",
    }
    assert hashes(tmp_path / "dask") == expected


def test_a_relighting_worker_with_other_code_is_refused(tmp_path):
    with pytest.raises(WorkerError, match="a worker has another code"):
        relit_agreed([], "other", 0.5, RelitShard(tmp_path / "train-00000.safetensors", 0))


def test_a_worker_with_other_code_is_refused(cluster, tmp_path):
    other = {**GENERATION.manifest(), "code": "other"}
    task = ShardTask(Split.TRAIN, 0, 1)
    with (
        dask_cluster(cluster.scheduler_address) as executor,
        pytest.raises(WorkerError, match="a worker has another code"),
    ):
        executor.submit(render_agreed, GENERATION, other, task).result()


def test_a_scheduler_that_is_not_there_is_one_sentence(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("reflest_core.synbrdf.generation.dask_cluster.CONNECT_SECONDS", 0.5)
    nowhere = ["--scheduler", "tcp://127.0.0.1:1"]
    assert main(["synbrdf", "generate", "--out", str(tmp_path / "set"), *nowhere, *OPTIONS]) == 2
    printed = capsys.readouterr().err
    assert "no Dask scheduler answers at tcp://127.0.0.1:1" in printed
    assert "Traceback" not in printed


def test_a_scheduler_without_workers_is_refused(tmp_path, capsys):
    with distributed.LocalCluster(
        n_workers=0, host="127.0.0.1", dashboard_address="127.0.0.1:0"
    ) as empty:
        words = ["--out", str(tmp_path / "set"), "--scheduler", empty.scheduler_address, *OPTIONS]
        assert main(["synbrdf", "generate", *words]) == 2
    assert "has no workers" in capsys.readouterr().err


def test_a_worker_that_is_killed_is_one_sentence():
    no_second_try = {"distributed.scheduler.allowed-failures": 0}
    with (
        dask.config.set(no_second_try),
        distributed.LocalCluster(
            n_workers=1, host="127.0.0.1", dashboard_address="127.0.0.1:0"
        ) as cluster,
        pytest.raises(ClusterError, match="lost its workers"),
        dask_cluster(cluster.scheduler_address) as executor,
    ):
        executor.submit(os._exit, 1).result()
