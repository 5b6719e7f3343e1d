# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes relit by Eq. 1, against Mitsuba; and the data set that is made of them."""

import json

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.brdf.parameters import WardParameters
from reflest_core.cli.main import main
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.generation.generate import generate
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.lights.environments import load_environment, rotated
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky
from reflest_core.synbrdf.relit.relighting import Relighting, RelightingRefused, relight
from reflest_core.synbrdf.relit.relit_scene import is_relightable, randomly_relit, relit
from reflest_core.synbrdf.relit.scene_light import backgrounds
from reflest_core.synbrdf.scenes.scene_file import MANIFEST, SceneFileError, load_scenes, sha256
from reflest_core.synbrdf.scenes.splits import Split


@pytest.fixture(scope="module")
def generation():
    scenes = {"train": 6, "validation": 3, "unseen": 1}
    return Generation(7, scenes, points=150, views=12, samples=256)


@pytest.fixture(scope="module")
def data(tmp_path_factory, generation):
    folder = tmp_path_factory.mktemp("set") / "data"
    generate(folder, generation, process_pool(1))
    return folder


@pytest.fixture(scope="module")
def convex(data):
    """Scenes under one light as it is, of shapes that hide nothing."""
    scenes = [scene for scene in load_scenes(data, "validation") if is_relightable(scene)]
    assert scenes
    return scenes


def own_light(generation, scene):
    lights = {light.name: light for light in generation.sources(Split.VALIDATION).environments}
    return rotated(load_environment(lights[scene.environment]), scene.environment_rotation)


def test_by_its_own_light_and_material_a_scene_is_what_mitsuba_rendered(generation, convex):
    medians = []
    for scene in convex:
        again = relit(
            scene,
            scene.materials.dominant.ward,
            own_light(generation, scene),
            np.random.default_rng(0),
        )
        exposed = scene.radiance.astype(np.float32) * scene.exposure
        by_eq_1 = again.radiance.astype(np.float32) * again.exposure
        bright = exposed.min(axis=1) > 0.02
        medians.append(np.median(np.abs(np.log(by_eq_1[bright] / exposed[bright]))))
        for view in ("view_foreground", "view_background"):
            np.testing.assert_allclose(
                np.nanmean(getattr(again.surface, view), axis=0),
                np.nanmean(getattr(scene.surface, view), axis=0),
                rtol=0.1,
            )
    # One stands under a small sun, of which Mitsuba's samples and the map's texels differ.
    assert max(medians) < 0.1
    assert np.median(medians) < 0.02


def test_a_matte_surface_in_even_light_is_its_albedo(convex):
    albedo = (0.3, 0.2, 0.1)
    white = np.full((16, 32, 3), 7.0, np.float32)
    again = relit(convex[0], WardParameters(albedo, 0.0, 0.1), white, np.random.default_rng(0))
    radiance = again.radiance.astype(np.float32)
    np.testing.assert_allclose(radiance, np.tile(albedo, (len(radiance), 1)), rtol=2e-3)
    for _, colours in backgrounds(again, np.arange(3)):
        assert (colours == colours[0]).all()


def test_the_background_is_the_light_where_it_is(convex):
    """One red lamp: the directions whose background is red are those towards it."""
    towards = octahedral_directions(96).reshape(-1, 3)
    lamp = towards[1234]
    height = 64
    from reflest_core.light.equirectangular import equirectangular_directions

    cosine = equirectangular_directions(height) @ lamp
    light = np.full((height, 2 * height, 3), 0.1, np.float32)
    light[cosine > 0.8] = (1.0, 0.1, 0.1)
    again = relit(convex[0], convex[0].materials.dominant.ward, light, np.random.default_rng(0))
    shown = 0
    for directions, colours in backgrounds(again, np.arange(12)):
        unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        is_red = colours[:, 0] > colours[:, 1] + 60
        assert ((unit @ lamp)[is_red] > 0.75).all()
        assert ((unit @ lamp)[~is_red] < 0.85).all()
        shown += int(is_red.sum())
    assert shown > 0


def test_natural_light_is_one_environment_as_it_is(convex):
    """An even one stays even, but for its tint; diverse light has lamps, skies or others in it."""
    even = {"even": np.ones((16, 32, 3), np.float32)}

    def is_even(share, seed):
        drawn = randomly_relit(convex[0], even, np.random.default_rng(seed), share)
        return all((colours == colours[0]).all() for _, colours in backgrounds(drawn, np.arange(3)))

    assert all(is_even(1.0, seed) for seed in range(5))
    assert not all(is_even(0.0, seed) for seed in range(5))


@pytest.mark.parametrize("seed", range(6))
def test_a_relit_scene_names_its_light(convex, seed):
    """The environments without which it would not look the same."""
    lights = {name: procedural_sky(k, 16) for k, name in enumerate(("dawn", "noon", "dusk"))}
    drawn = randomly_relit(convex[0], lights, np.random.default_rng(seed), 0.5)
    kind, *natural = drawn.environment.split("+")
    assert kind == "relit"
    for name in lights:
        others = {**lights, name: lights[name][:, ::-1] ** 2}
        again = randomly_relit(convex[0], others, np.random.default_rng(seed), 0.5)
        assert (name in natural) == (again.radiance != drawn.radiance).any()


def relit_set(data, out, copies=2):
    relight(out, Relighting(data, copies), process_pool(1))
    return {path.name: sha256(path) for path in sorted(out.glob("*.safetensors"))}


def test_a_lost_shard_is_made_again_as_it_was(data, tmp_path):
    written = relit_set(data, tmp_path / "relit")
    assert len(written) == 2
    (tmp_path / "relit" / min(written)).unlink()
    assert relit_set(data, tmp_path / "relit") == written
    scenes = list(load_scenes(tmp_path / "relit", "train"))
    truths = {scene.materials.dominant.ward for scene in scenes}
    assert len(truths) == len(scenes) > 1
    assert not truths & {scene.materials.dominant.ward for scene in load_scenes(data, "train")}


def test_no_unseen_light_takes_part(data, generation, tmp_path):
    relit_set(data, tmp_path / "relit", copies=1)
    lights = json.loads((tmp_path / "relit" / MANIFEST).read_text())["lights"]
    unseen = {light.name for light in generation.sources(Split.UNSEEN).environments}
    assert lights
    assert not unseen & set(lights)


def test_other_environments_than_the_sources_are_refused(data, tmp_path):
    np.savez(tmp_path / "other.npz", a=np.ones((8, 16, 3)), b=np.ones((8, 16, 3)))
    relighting = Relighting(data, 1, environments=tmp_path / "other.npz")
    with pytest.raises(RelightingRefused, match="unseen lights could not be told"):
        relight(tmp_path / "relit", relighting, process_pool(1))


def test_what_was_begun_otherwise_is_refused(data, tmp_path):
    relit_set(data, tmp_path / "relit", copies=1)
    with pytest.raises(SceneFileError, match="begun with another"):
        relit_set(data, tmp_path / "relit", copies=2)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--copies", "0"], "--copies is 0"),
        (["--natural", "1.5"], "--natural is 1.5"),
        ([], "no training scenes"),
    ],
)
def test_the_command_names_what_is_wrong(data, tmp_path, capsys, arguments, reason):
    source = data if arguments else tmp_path
    out = str(tmp_path / "relit")
    assert main(["synbrdf", "relight", str(source), "--out", out, *arguments]) == 2
    assert reason in capsys.readouterr().err
