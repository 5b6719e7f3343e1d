# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Tabletops before they are rendered: painting, ground, placing, what seeds and users decide."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from reflest_core.brdf.parameters import WardParameters
from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.scenes.material_sources import Materials, MaterialSource, NamedMaterial
from reflest_core.synbrdf.scenes.painted_mesh import joined
from reflest_core.synbrdf.scenes.splits import Sources
from reflest_core.synbrdf.shapes.mesh_file import find_meshes
from reflest_core.synbrdf.tabletop.ground import Setting, draw_ground
from reflest_core.synbrdf.tabletop.objects import COUNTS, DIAMETERS, SINK, draw_objects
from reflest_core.synbrdf.tabletop.tabletop_scene import (
    TabletopChoices,
    TabletopLight,
    draw_tabletop,
)
from reflest_core.synbrdf.tabletop.texture import Texture, one_material, two_materials
from test.synbrdf.spheres import icosphere, write_obj

MEASURED = Materials(MaterialSource.MEASURED)
RED = NamedMaterial(WardParameters((0.5, 0.1, 0.1), 0.1, 0.1), MaterialSource.MEASURED, "red")
BLUE = NamedMaterial(WardParameters((0.1, 0.1, 0.5), 0.02, 0.2), MaterialSource.MEASURED, "blue")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    write_obj(folder / "ball.obj", icosphere(2))
    return Sources(procedural_skies(2), find_meshes(folder))


def scene_of(sources, seed=1, **choices):
    rng = np.random.default_rng(seed)
    return draw_tabletop(
        rng, sources, MEASURED, 6, TabletopChoices(environment_height=16, **choices)
    )


def test_a_checker_alternates_in_albedo_alone():
    texture = Texture("checker", np.eye(3), 0.5, np.array([0.1, 0.1, 0.5]), np.zeros(8))
    points = np.array([[0.1, 0.1, 0.1], [0.6, 0.1, 0.1], [0.6, 0.6, 0.1], [-0.1, 0.1, 0.1]])
    assert texture.share(points).tolist() == [0, 1, 0, 1]
    painted = one_material(icosphere(3), RED, "ball", texture)
    np.testing.assert_allclose(np.unique(painted.rho_d, axis=0), [[0.1, 0.1, 0.5], [0.5, 0.1, 0.1]])
    assert set(painted.rho_s.tolist()) == {np.float32(0.1)}
    assert len(painted.materials) == 1


@pytest.mark.parametrize("kind", ["stripes", "spots", "grain"])
def test_every_pattern_mixes_its_two_colours(kind):
    texture = Texture(kind, np.eye(3), 0.3, np.array([0.1, 0.1, 0.5]), np.full(8, 0.3))
    share = texture.share(np.random.default_rng(1).uniform(-1, 1, (5000, 3)))
    assert 0 <= share.min() < 0.05 < 0.95 < share.max() <= 1
    assert 0.2 < share.mean() < 0.8


def test_a_plane_parts_two_materials():
    painted = two_materials(icosphere(3), RED, BLUE, "ball", np.array([0, 0, 1.0, 0.2]))
    heights = painted.mesh.vertices[painted.mesh.faces].mean(axis=1)[:, 2]
    np.testing.assert_array_equal(painted.material_of_face, heights > 0.2)
    np.testing.assert_array_equal(painted.alpha, np.where(heights > 0.2, 0.2, 0.1).astype("f4"))


def test_joined_parts_keep_their_materials():
    first = one_material(icosphere(1), RED, "one").shifted(np.array([1.0, 0, 0]))
    second = two_materials(icosphere(1), BLUE, RED, "two", np.array([0, 0, 1.0, 0.0]))
    whole = joined([first, second])
    assert [material.part for material in whole.materials] == ["one", "two", "two"]
    count = len(first.mesh.faces)
    assert set(whole.material_of_face[:count]) == {0}
    assert set(whole.material_of_face[count:]) == {1, 2}
    middles = whole.mesh.vertices[whole.mesh.faces].mean(axis=1)
    assert middles[:count, 0].mean() == pytest.approx(1.0)
    np.testing.assert_array_equal(whole.rho_d[count:], second.rho_d)


@pytest.mark.parametrize("seed", range(4))
def test_the_ground_is_level_and_faces_up_and_walls_face_in(seed):
    for setting in Setting:
        ground = draw_ground(np.random.default_rng(seed), setting, MEASURED)
        mesh = ground.mesh
        corners = mesh.vertices[mesh.faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        shading = mesh.normals[mesh.faces].mean(axis=1)
        area = np.linalg.norm(across, axis=1)
        solid = area > 1e-12
        cosines = np.einsum("ij,ij->i", across, shading)[solid] / area[solid]
        np.testing.assert_allclose(cosines, 1.0, atol=1e-6)
        top = np.abs(corners[:, :, 2]).max(axis=1) < 1e-9
        assert 0.25 < mesh.face_areas[top].sum() < 0.85
        if setting is Setting.CORNER:
            middles, upright = corners.mean(axis=1)[~top], shading[~top]
            assert (np.einsum("ij,ij->i", middles[:, :2], upright[:, :2]) < 0).all()


@pytest.mark.parametrize("seed", range(3))
def test_objects_stand_on_the_ground_and_apart(sources, seed):
    objects, names = draw_objects(np.random.default_rng(seed), sources.meshes, MEASURED)
    assert COUNTS[0] <= len(objects) == len(names) <= COUNTS[1]
    trees = []
    for painted in objects:
        vertices = painted.mesh.vertices
        assert vertices[:, 2].min() == pytest.approx(-SINK)
        assert np.ptp(vertices, axis=0).max() <= DIAMETERS[1] + 1e-9
        for tree in trees:
            assert tree.query(vertices[:, :2])[0].min() > 0.005
        trees.append(cKDTree(vertices[:, :2]))


def test_choices_leave_the_rest_of_the_scene(sources):
    drawn = scene_of(sources)
    rng = np.random.default_rng(1)
    choices = TabletopChoices(drawn.setting, TabletopLight.NEAR, 16)
    near = draw_tabletop(rng, sources, MEASURED, 6, choices)
    np.testing.assert_array_equal(near.painted.rho_d, drawn.painted.rho_d)
    np.testing.assert_array_equal(near.poses, drawn.poses)
    assert near.room is not None
    assert near.light.name.startswith("room")


def test_seeds_give_both_settings_and_lights_and_textures(sources):
    scenes = [scene_of(sources, seed) for seed in range(14, 26)]
    assert {scene.setting for scene in scenes} == set(Setting)
    assert {scene.room is None for scene in scenes} == {True, False}
    materials = [material for scene in scenes for material in scene.painted.materials]
    assert {material.texture for material in materials} > {"plain", "checker", "grain"}
    for scene in scenes:
        high = scene.poses[:, 2, 3]
        assert high.min() > 0.1
        energy = scene.painted.rho_d.max(axis=1) + scene.painted.rho_s
        assert energy.max() <= 1 + 1e-6


def test_diverse_light_is_named_by_what_is_mixed_and_decided_by_the_seed(sources):
    drawn = [scene_of(sources, seed, light=TabletopLight.DIVERSE) for seed in (1, 1, 2)]
    names = {source.name for source in sources.environments}
    for scene in drawn:
        kind, *natural = scene.light.name.split("+")
        assert kind == "diverse"
        assert set(natural) <= names
        assert scene.room is None
        assert np.isfinite(scene.light.radiance).all()
    np.testing.assert_array_equal(drawn[0].light.radiance, drawn[1].light.radiance)
    assert drawn[2].light.radiance.shape == drawn[0].light.radiance.shape
    assert np.abs(drawn[2].light.radiance - drawn[0].light.radiance).max() > 0.0
