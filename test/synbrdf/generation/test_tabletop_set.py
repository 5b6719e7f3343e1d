# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sets of tabletops (SynBRDF-SV), and voxels that come out of fusion."""

import json

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.synbrdf.generation.data_set import Generation, GenerationRefused, Product
from reflest_core.synbrdf.generation.generate import generate
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.path_tracing.mitsuba_xml import MaterialsNotWritten, write_scene
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.material_sources import Materials, MaterialSource
from reflest_core.synbrdf.scenes.measured_materials import FAMILIES
from reflest_core.synbrdf.scenes.scene import Lighting
from reflest_core.synbrdf.scenes.scene_file import (
    SV_FORMAT,
    SceneFileError,
    load_scenes,
    shard_bytes,
)
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.synbrdf.scenes.surface_points import SurfaceKind
from reflest_core.synbrdf.scenes.views import depth_camera
from reflest_core.training.data.sample import load_samples

FITS = (
    "material,rho_d_r,rho_d_g,rho_d_b,rho_s_r,rho_s_g,rho_s_b,alpha\n"
    "red,.5,.1,.05,.02,.02,.02,.02\nblack,.01,.01,.01,.04,.04,.04,.05\n"
)
POINTS, VIEWS = 120, 8


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sv")
    (folder / "fits.csv").write_text(FITS)
    materials = Materials(MaterialSource.MEASURED, folder / "fits.csv")
    scenes = {"train": 1, "validation": 1, "unseen": 1}
    generation = Generation(
        2, scenes, POINTS, VIEWS, 4, product=Product.TABLETOP, materials=materials
    )
    generate(folder / "set", generation, process_pool(1))
    before = {path.name: path.read_bytes() for path in (folder / "set").iterdir()}
    (folder / "set" / "train-00000.safetensors").unlink()
    generate(folder / "set", generation, process_pool(1))
    assert {path.name: path.read_bytes() for path in (folder / "set").iterdir()} == before
    return folder / "set"


def test_every_voxel_has_a_material_and_an_albedo(data):
    for split in ("train", "validation", "unseen"):
        (scene,) = load_scenes(data, split)
        truth = scene.materials
        assert len(truth.ids) == len(truth.rho_d) == scene.surface.voxel_count
        assert scene.surface.observation_counts.min() >= 1
        on_object = [truth.materials[k].part.startswith("object") for k in truth.ids]
        assert 0.3 < np.mean(on_object) < 0.9
        for number, material in enumerate(truth.materials):
            if material.texture == "plain":
                own = truth.rho_d[truth.ids == number]
                expected = np.tile(np.float32(material.ward.rho_d), (len(own), 1))
                np.testing.assert_array_equal(own, expected)


def test_the_unseen_split_alone_has_the_fitted_materials(data):
    names = {
        split: {m.name for scene in load_scenes(data, split) for m in scene.materials.materials}
        for split in ("train", "validation", "unseen")
    }
    assert names["unseen"] <= {"red", "black"}
    assert names["train"] | names["validation"] <= set(FAMILIES)
    manifest = json.loads((data / "manifest.json").read_text())
    assert (manifest["format"], manifest["product"]) == (SV_FORMAT, "tabletop")
    assert manifest["materials"]["source"] == "measured"


def test_the_materials_part_a_scene(data):
    (scene,) = load_scenes(data, "train")
    parts = [scene.of_material(k) for k in range(len(scene.materials.materials))]
    assert sum(part.surface.voxel_count for part in parts) == scene.surface.voxel_count
    assert sum(len(part.radiance) for part in parts) == len(scene.radiance)
    for number, part in enumerate(parts):
        assert part.materials.dominant.ward == scene.materials.materials[number].ward
        chosen = scene.materials.ids == number
        np.testing.assert_array_equal(part.surface.positions, scene.surface.positions[chosen])
        counts = part.surface.observation_counts
        np.testing.assert_array_equal(counts, scene.surface.observation_counts[chosen])
        assert part.surface.offsets[-1] == len(part.surface.colours)
    assert b"voxel_rho_d" not in shard_bytes(parts)
    with pytest.raises(SceneFileError, match="no material 99"):
        scene.of_material(99)


def test_the_dominant_material_is_that_of_the_largest_area(data):
    (scene,) = load_scenes(data, "train")
    assert scene.materials.dominant.part == "table"
    assert scene.materials.dominant == scene.materials.materials[scene.materials.dominant_id]


def test_training_gets_a_sample_of_each_material(data):
    (scene,) = load_scenes(data, "train")
    samples = load_samples(data, "train")
    wards = {tuple(sample.ward) for sample in samples}
    assert wards <= {
        (*material.ward.rho_d, material.ward.rho_s, material.ward.alpha)
        for material in scene.materials.materials
    }
    assert len(wards) == len(samples) > 1
    assert sum(s.surface.voxel_count for s in samples) <= scene.surface.voxel_count


def test_fused_voxels_lie_near_the_surface_with_the_errors_of_fusion():
    realism = Realism.only([Effect.DEPTH, Effect.POSE])
    settings = SparseSettings(80, 24, 4, 4, SurfaceKind.FUSED, realism)
    generation = Generation(3, {"train": 1}, views=24)
    drawn = generation.scene(Split.TRAIN, 4)
    scene = SparseRenderer(settings).render(drawn, 3)
    surface = scene.surface
    assert 40 < surface.voxel_count <= 80
    corners = drawn.mesh.vertices[drawn.mesh.faces]
    middles = corners.mean(axis=1)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    apart = np.linalg.norm(surface.positions[:, None] - middles[None], axis=2)
    nearest = apart.argmin(axis=1)
    normals = across[nearest] / np.linalg.norm(across[nearest], axis=1, keepdims=True)
    offsets = np.einsum("ij,ij->i", surface.positions - middles[nearest], normals)
    assert 0 < np.median(np.abs(offsets)) < 0.005
    cosines = np.einsum("ij,ij->i", surface.normals, normals)
    tilt = np.rad2deg(np.arccos(np.clip(cosines, -1, 1)))
    assert 0.5 < np.median(tilt) < 15
    assert surface.observation_counts.min() >= 1
    assert len(surface.colours) == surface.offsets[-1]


@pytest.mark.parametrize("options", [{"lighting": Lighting.DIVERSE}])
def test_what_tabletops_do_not_have_is_refused(options):
    with pytest.raises(GenerationRefused, match="--product tabletop goes with"):
        Generation(1, {"train": 1}, product=Product.TABLETOP, **options)


def test_mitsuba_files_hold_no_several_materials(tmp_path):
    generation = Generation(2, {"train": 1}, views=2, product=Product.TABLETOP)
    scene = generation.scene(Split.TRAIN, 0)
    with pytest.raises(MaterialsNotWritten, match="--product object"):
        write_scene(tmp_path / "xml", scene, depth_camera(64, 48), [0], 4)
    assert list(tmp_path.iterdir()) == []
