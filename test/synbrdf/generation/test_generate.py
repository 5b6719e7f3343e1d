# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The data set on disk: the same bytes from the same seed, however the run went."""

import dataclasses
import json
import resource
import shutil

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.cli.main import main
from reflest_core.synbrdf.generation import data_set as generation
from reflest_core.synbrdf.generation.data_set import Generation, shard_tasks
from reflest_core.synbrdf.generation.generate import generate
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.path_tracing.mitsuba_runtime import RendererMissing
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import (
    SceneFileError,
    load_scenes,
    load_shard,
    sha256,
    shard_bytes,
)
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.whole_file import OutputError, write_whole

SCENES = {"train": 2, "validation": 1, "unseen": 1}
TINY = Generation(seed=5, scenes=SCENES, points=30, views=6, samples=4)


NO_PROCESS = 2**22 + 1
"""Above the largest process id that Linux gives."""


def hashes(folder):
    return {path.name: sha256(path) for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("synbrdf") / "set"
    generate(folder, TINY, process_pool(1))
    return folder


def test_two_processes_write_the_same_bytes(generated, tmp_path):
    generate(tmp_path / "again", TINY, process_pool(2))
    assert hashes(tmp_path / "again") == hashes(generated)


def test_a_killed_run_is_resumed_to_the_same_bytes(generated, tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(generated, folder)
    lost = next(folder.glob("train-*.safetensors"))
    unfinished = folder / f".{lost.name}.{NO_PROCESS}.0a1b2c3d.partial"
    unfinished.write_bytes(lost.read_bytes()[:1000])
    lost.unlink()
    kept = {path.name: path.stat().st_mtime_ns for path in folder.glob("unseen-*")}
    generate(folder, TINY, process_pool(1))
    assert hashes(folder) == hashes(generated)
    assert {path.name: path.stat().st_mtime_ns for path in folder.glob("unseen-*")} == kept


def test_realism_at_generation_is_realism_afterwards(generated, tmp_path):
    """Training degrades clean scenes as it goes; a generated degraded set is the same thing."""
    realism = Realism.only([Effect.EXPOSURE, Effect.SENSOR, Effect.NORMALS])
    scenes = {"train": 1, "validation": 0, "unseen": 1}
    generate(
        tmp_path / "real",
        dataclasses.replace(TINY, scenes=scenes, realism=realism),
        process_pool(1),
    )
    for split in ("train", "unseen"):
        clean, real = (next(load_scenes(f, split)) for f in (generated, tmp_path / "real"))
        expected = degrade(clean, realism, generator(TINY.seed, Split(split), 0, Purpose.REALISM))
        for part in ("surface", "thumbnails"):
            for name, array in vars(getattr(real, part)).items():
                np.testing.assert_array_equal(array, getattr(getattr(expected, part), name))
        assert not np.array_equal(real.surface.normals, clean.surface.normals)


def test_scenes_come_back_whole(generated):
    scenes = list(load_scenes(generated, "train"))
    assert [scene.index for scene in scenes] == [0, 1]
    for scene in scenes:
        surface = scene.surface
        assert scene.split == "train"
        assert surface.positions.shape == (30, 3)
        assert surface.view_centres.shape == (6, 3)
        assert surface.offsets[-1] == len(surface.colours) == len(scene.radiance)
        np.testing.assert_allclose(np.linalg.norm(surface.normals, axis=1), 1.0, atol=1e-5)
        # No kept view is past the grazing limit.
        of_point = np.repeat(np.arange(30), surface.observation_counts)
        cosines = np.einsum("ij,ij->i", surface.view_directions(), surface.normals[of_point])
        assert cosines.min() > 0.25
        assert np.isfinite(surface.view_background).all()
        assert (
            max(scene.materials.dominant.ward.rho_d) + scene.materials.dominant.ward.rho_s
            <= 1 + 1e-9
        )
    one, other = scenes
    assert one.materials.dominant != other.materials.dominant
    unseen = next(load_scenes(generated, "unseen"))
    assert unseen.environment not in {e for s in scenes for e in s.environment.split("+")}


def test_far_light_is_rendered_as_before_there_were_rooms(generated):
    """Figures of the older code; paths of light differ in the last digits between processors."""
    before = {
        "train": (0.238581, 59, 0.658670, 98),
        "validation": (0.622640, 59, 0.322010, 2783),
        "unseen": (0.289354, 59, 0.485373, 472),
    }
    for split, (exposure, observations, radiance, pixels) in before.items():
        scene = next(load_scenes(generated, split))
        assert scene.exposure == pytest.approx(exposure, rel=1e-3)
        assert len(scene.radiance) == pytest.approx(observations, abs=1)
        assert scene.radiance.mean(dtype=float) == pytest.approx(radiance, rel=5e-3)
        assert scene.thumbnails.is_object.sum() == pytest.approx(pixels, abs=2)
        assert scene.thumbnails.depth is None


def test_scenes_in_rooms_are_generated_alike_again(tmp_path):
    """With ``--lighting near`` for all splits, by two processes as by one."""
    arguments = ["--seed", "5", "--train", "1", "--validation", "1", "--unseen", "1"]
    arguments += ["--points", "30", "--views", "6", "--samples", "4", "--lighting", "near"]
    for jobs in ("1", "2"):
        out = ["--out", str(tmp_path / jobs), "--jobs", jobs]
        assert main(["synbrdf", "generate", *out, *arguments]) == 0
    assert hashes(tmp_path / "1") == hashes(tmp_path / "2")
    for split in ("train", "validation", "unseen"):
        scene = next(load_scenes(tmp_path / "1", split))
        assert scene.environment.startswith("room")
        assert scene.thumbnails.depth.shape == (6, 36, 48)
        assert (scene.thumbnails.depth > 0).mean() > 0.3
        assert scene.radiance.max() > 0
        degraded = degrade(scene, Realism(), np.random.default_rng(1))
        np.testing.assert_array_equal(degraded.thumbnails.depth, scene.thumbnails.depth)


def test_thumbnails_show_the_light_behind_the_object(generated):
    """Where F and B come from: the same pixels, exposed, average to the view's B."""
    scene = next(load_scenes(generated, "validation"))
    thumbnails = scene.thumbnails
    assert thumbnails.rgbe.shape == (6, 36, 48, 4)
    assert 0.02 < thumbnails.is_object.mean() < 0.9
    np.testing.assert_array_equal(thumbnails.T_world_camera[:, :3, 3], scene.surface.view_centres)
    images = expose(thumbnails.radiance(), scene.exposure)
    for view in range(6):
        background = images[view][~thumbnails.is_object[view]].mean(axis=0)
        np.testing.assert_allclose(background, scene.surface.view_background[view], atol=2.0)


def test_another_code_is_not_mixed_in(generated, tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(generated, folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps({**manifest, "code": "other"}))
    with pytest.raises(SceneFileError, match="another code"):
        generate(folder, TINY, process_pool(1))


def test_the_manifest_names_every_shard_with_its_hash(generated):
    manifest = json.loads((generated / "manifest.json").read_text())
    assert set(manifest["sha256"]) == {task.file_name for task in shard_tasks(TINY)}
    for name, digest in manifest["sha256"].items():
        assert sha256(generated / name) == digest


def test_another_seed_in_the_same_folder_is_refused(generated, capsys):
    arguments = ["--out", str(generated), "--seed", "6", "--train", "2", "--validation", "1"]
    arguments += ["--unseen", "1", "--points", "30", "--views", "6", "--samples", "4"]
    before = hashes(generated)
    assert main(["synbrdf", "generate", *arguments]) == 2
    printed = capsys.readouterr().err.strip()
    assert printed.startswith("reflest: error:")
    assert "another seed" in printed
    assert len(printed.splitlines()) == 1
    assert hashes(generated) == before


def test_equal_scenes_give_equal_bytes_every_time(generated, tmp_path):
    """The library beneath orders its metadata by chance, so that one repetition shows little."""
    scenes = load_shard(next(generated.glob("train-*.safetensors")))
    for number in range(16):
        (tmp_path / f"{number}.safetensors").write_bytes(shard_bytes(scenes))
    assert len(set(hashes(tmp_path).values())) == 1


@pytest.mark.parametrize(
    "damage", [lambda b: b[: len(b) // 2], lambda b: b"x" * 100, lambda b: b""]
)
def test_a_damaged_shard_is_named(generated, tmp_path, damage):
    whole = next(generated.glob("train-*.safetensors"))
    broken = tmp_path / whole.name
    broken.write_bytes(damage(whole.read_bytes()))
    with pytest.raises(SceneFileError, match=whole.name):
        load_shard(broken)


def test_a_damaged_shard_of_a_finished_set_is_found_and_mended(generated, tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(generated, folder)
    shard = next(folder.glob("train-*.safetensors"))
    data = bytearray(shard.read_bytes())
    data[-1] ^= 1
    shard.write_bytes(data)
    with pytest.raises(SceneFileError, match=rf"{shard.name} is damaged"):
        generate(folder, TINY, process_pool(1))
    shard.unlink()
    generate(folder, TINY, process_pool(1))
    assert hashes(folder) == hashes(generated)


@pytest.mark.parametrize(
    ("option", "value"),
    [("--jobs", "0"), ("--views", "0"), ("--points", "-1"), ("--train", "-3"), ("--seed", "-1")],
)
def test_an_impossible_set_is_refused(option, value, tmp_path, capsys):
    assert main(["synbrdf", "generate", "--out", str(tmp_path / "set"), option, value]) == 2
    assert f"{option} is {value}, but must be" in capsys.readouterr().err
    assert not (tmp_path / "set").exists()


def test_fits_that_are_not_there_are_one_sentence(tmp_path, capsys):
    materials = ["--materials", "measured", "--material-fits", str(tmp_path / "nowhere.csv")]
    assert main(["synbrdf", "generate", "--out", str(tmp_path / "set"), *materials]) == 2
    assert "nowhere.csv cannot be read" in capsys.readouterr().err
    assert not (tmp_path / "set").exists()


@pytest.mark.parametrize("content", ['{"seed":', "[]"])
def test_a_damaged_manifest_is_one_sentence(content, tmp_path, capsys):
    (tmp_path / "manifest.json").write_text(content)
    (tmp_path / "train-00000.safetensors").touch()
    assert main(["synbrdf", "relight", str(tmp_path), "--out", str(tmp_path / "relit")]) == 2
    assert "manifest.json is damaged" in capsys.readouterr().err
    assert main(["synbrdf", "generate", "--out", str(tmp_path), "--train", "1"]) == 2
    assert "manifest.json is damaged" in capsys.readouterr().err


def test_a_missing_library_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(generation, "PACKAGES", ("numpy", "no-such-renderer"))
    with pytest.raises(RendererMissing, match=r"no-such-renderer.*reflest-ros\[synbrdf\]"):
        generate(tmp_path / "set", TINY, process_pool(1))
    assert not (tmp_path / "set").exists()


def test_a_folder_without_a_manifest_is_refused(tmp_path):
    with pytest.raises(SceneFileError, match=r"manifest\.json"):
        next(load_scenes(tmp_path, "train"))


def test_a_full_disk_is_one_sentence_and_leaves_nothing(tmp_path):
    """A limit on file sizes stands in for the disk: the same call fails in the same place."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(OutputError, match=r"cannot write .*train\.safetensors"):
            write_whole(tmp_path / "train.safetensors", b"x" * 2000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []
