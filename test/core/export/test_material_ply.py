# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A material map as PLY: what other readers find in it."""

import dataclasses

import numpy as np
import pytest
import trimesh
from plyfile import PlyData

from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.export.errors import ExportError
from reflest_core.export.material_ply import VERTEX, export_materials
from reflest_core.surface.partition import Partition
from test.core.lit_surfaces import lit
from test.core.surfaces import sphere_surface


@pytest.fixture(scope="module")
def materials():
    """A ball of two materials, some of whose voxels nothing observed."""
    surface = lit(sphere_surface(voxels=600))
    seen = surface.offsets[501]
    surface = dataclasses.replace(
        surface,
        offsets=np.minimum(surface.offsets, seen),
        colours=surface.colours[:seen],
        view_indices=surface.view_indices[:seen],
    )
    ids = np.where(surface.positions[:, 2] > 0.0, 3, 8)
    ids[::11] = 0
    partition = Partition.of(surface, ids)
    found = Estimator(EstimationSettings()).materials(surface, partition, 5, "camera")
    return dataclasses.replace(found, world_frame_id="map")


def test_it_is_binary_little_endian_with_the_properties_of_the_specification(materials, tmp_path):
    path = tmp_path / "materials.ply"
    export_materials(materials, path)
    header = path.read_bytes().split(b"end_header")[0].decode().splitlines()
    assert header[:2] == ["ply", "format binary_little_endian 1.0"]
    assert "comment frame map" in header
    properties = [line.split()[1:] for line in header if line.startswith("property")]
    albedo = ["rho_d_r", "rho_d_g", "rho_d_b"]
    floats = ["x", "y", "z", "nx", "ny", "nz", *albedo, "rho_s", "alpha"]
    deviations = [*(f"{name}_stddev" for name in albedo), "rho_s_stddev", "alpha_stddev"]
    expected = [["float", name] for name in (*floats, *deviations)]
    last = [["ushort", "views"], ["uint", "material_id"], ["float", "normal_stddev"]]
    assert properties == [*expected, *last]


def test_every_observed_voxel_has_its_material_s_values(materials, tmp_path):
    path = tmp_path / "materials.ply"
    export_materials(materials, path)
    vertices = PlyData.read(path)["vertex"].data
    surface = materials.surface
    observed = surface.observation_counts > 0
    assert len(vertices) == observed.sum() == 501
    position = np.stack([vertices[axis] for axis in "xyz"], axis=1)
    np.testing.assert_array_equal(position, surface.positions[observed])
    np.testing.assert_array_equal(vertices["views"], surface.observation_counts[observed])
    assert set(vertices["material_id"]) == {0, 3, 8}
    for material in materials.materials:
        rows = vertices[vertices["material_id"] == material.id]
        assert len(rows) > 100
        assert set(rows["alpha"]) == {np.float32(material.estimate.alpha)}
        assert set(rows["rho_s_stddev"]) == {np.float32(material.estimate.rho_s_stddev)}
    unassigned = vertices[vertices["material_id"] == 0]
    assert np.isnan(unassigned["alpha"]).all()
    assert np.isnan(unassigned["rho_d_r"]).all()


def test_normals_that_disagree_with_their_neighbours_deviate_more(materials, tmp_path):
    """Of a small ball with noisy normals in one half, that half has the larger deviations."""
    surface = materials.surface
    noise = np.random.default_rng(2).normal(0.0, 0.2, surface.normals.shape)
    is_noisy = surface.positions[:, 0] > 0.0
    normals = surface.normals + np.where(is_noisy[:, None], noise, 0.0).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    small = dataclasses.replace(surface, normals=normals, positions=0.4 * surface.positions)
    path = tmp_path / "materials.ply"
    export_materials(dataclasses.replace(materials, surface=small), path)
    vertices = PlyData.read(path)["vertex"].data
    noisy = vertices["x"] > 0.0
    noisy_stddev, stddev = (np.median(vertices["normal_stddev"][of]) for of in (noisy, ~noisy))
    assert 0.0 < stddev < 0.6 * noisy_stddev


def test_other_readers_open_it(materials, tmp_path):
    path = tmp_path / "materials.ply"
    export_materials(materials, path)
    cloud = trimesh.load(path)
    observed = materials.surface.observation_counts > 0
    np.testing.assert_array_equal(cloud.vertices, materials.surface.positions[observed])


def test_another_suffix_is_refused(materials, tmp_path):
    with pytest.raises(ExportError, match=r"must end in \.ply"):
        export_materials(materials, tmp_path / "materials.obj")
    assert not list(tmp_path.iterdir())


def test_a_vertex_takes_as_few_bytes_as_its_properties():
    assert VERTEX.itemsize == 17 * 4 + 2 + 4
