# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pixar's own library reads what was written; MaterialX knows the nodes."""

import MaterialX
import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdShade

from reflest_core.export.exporter import export_asset, export_estimate
from reflest_core.export.formats.usd import index_of_refraction
from reflest_core.export.scan_asset import AssetSettings, scan_asset
from test.core.export.complaints import complaints
from test.core.export.estimates import GLOSSY_RED, glossy_red
from test.core.export.scanned_ball import RED_ID, scanned_ball


@pytest.fixture(scope="module")
def ball():
    return scan_asset(*scanned_ball(), "ball", AssetSettings(faces=1000))


@pytest.fixture
def open_stage(tmp_path):
    def opened(estimate):
        path = tmp_path / "material.usda"
        export_estimate(estimate, "usd", path)
        return Usd.Stage.Open(str(path))

    return opened


def bound_materials(stage):
    """By name: the material of each subset of the surface, and the subset's faces."""
    mesh = UsdGeom.Mesh(next(p for p in stage.Traverse() if p.IsA(UsdGeom.Mesh)))
    found = {}
    for subset in UsdGeom.Subset.GetAllGeomSubsets(mesh):
        material, _ = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()
        found[material.GetPrim().GetName()] = (material, list(subset.GetIndicesAttr().Get()))
    return found


def test_the_sphere_is_bound_to_the_preview_surface(open_stage):
    stage = open_stage(GLOSSY_RED)
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    ((material, _),) = bound_materials(stage).values()
    shader, _, _ = material.ComputeSurfaceSource()
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    values = {one.GetBaseName(): one.Get() for one in shader.GetInputs()}
    f0 = 0.2 * 0.6595
    assert values["metallic"] == 0
    assert tuple(values["diffuseColor"]) == pytest.approx(
        (0.4 / (1 - f0), 0.08 / (1 - f0), 0.04 / (1 - f0))
    )
    assert "specularColor" not in values
    assert ((values["ior"] - 1) / (values["ior"] + 1)) ** 2 == pytest.approx(f0, rel=1e-5)
    assert values["roughness"] == pytest.approx((0.7 * 0.09243) ** 0.5, abs=1e-4)


def test_no_validator_of_usd_objects(open_stage, ball, tmp_path):
    assert complaints(open_stage(GLOSSY_RED)) == []
    export_asset(ball, tmp_path / "ball.usda")
    assert complaints(Usd.Stage.Open(str(tmp_path / "ball.usda"))) == []


@pytest.mark.parametrize("suffix", ["usda", "usdc", "usdz"])
def test_every_suffix_opens_without_a_complaint(ball, suffix, tmp_path):
    path = tmp_path / f"ball.{suffix}"
    export_asset(ball, path)
    stage = Usd.Stage.Open(str(path))
    assert complaints(stage) == []
    assert stage.GetDefaultPrim().GetName() == "ball"
    names = {one.name for one in tmp_path.iterdir()}
    beside = {path.name, "ball_base_colour.png", "ball_environment.exr"}
    assert names == ({path.name} if suffix == "usdz" else beside)


def test_the_surface_is_the_assets_with_a_material_for_each_part(ball, tmp_path):
    export_asset(ball, tmp_path / "ball.usdc")
    stage = Usd.Stage.Open(str(tmp_path / "ball.usdc"))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/ball/surface"))
    np.testing.assert_allclose(mesh.GetPointsAttr().Get(), ball.mesh.vertices)
    uv = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st").Get()
    np.testing.assert_allclose(uv, ball.mesh.uv)
    parts = bound_materials(stage)
    assert list(parts) == ["ball_material_7", "ball_material_3"]
    for index, (_, faces) in enumerate(parts.values()):
        np.testing.assert_array_equal(faces, np.flatnonzero(ball.mesh.face_materials == index))
    ids = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("reflest:material_id").Get()
    np.testing.assert_array_equal(ids, ball.mesh.attributes["material_id"])
    facts = parts["ball_material_7"][0].GetPrim().GetCustomData()["reflest"]
    assert facts["material_id"] == RED_ID
    assert facts["rho_s_stddev"] == 0.02


def test_textures_are_read_in_their_colour_space(ball, tmp_path):
    export_asset(ball, tmp_path / "ball.usda")
    stage = Usd.Stage.Open(str(tmp_path / "ball.usda"))
    preview = UsdShade.Shader(stage.GetPrimAtPath("/ball/ball_material_7/preview_base_colour"))
    assert preview.GetInput("sourceColorSpace").Get() == "sRGB"
    assert preview.GetInput("file").Get().resolvedPath == str(tmp_path / "ball_base_colour.png")
    image = UsdShade.Shader(stage.GetPrimAtPath("/ball/ball_material_7/open_pbr_base_colour"))
    assert image.GetInput("file").GetAttr().GetColorSpace() == "srgb_texture"


def test_materialx_has_the_nodes_and_inputs_of_the_open_pbr_surface(ball, tmp_path):
    export_asset(ball, tmp_path / "ball.usda")
    stage = Usd.Stage.Open(str(tmp_path / "ball.usda"))
    known = MaterialX.createDocument()
    MaterialX.loadLibraries(
        MaterialX.getDefaultDataLibraryFolders(), MaterialX.getDefaultDataSearchPath(), known
    )
    material = UsdShade.Material(stage.GetPrimAtPath("/ball/ball_material_7"))
    surface, _, _ = material.ComputeSurfaceSource("mtlx")
    assert surface.GetIdAttr().Get() == "ND_open_pbr_surface_surfaceshader"
    shaders = [
        UsdShade.Shader(prim)
        for prim in Usd.PrimRange(material.GetPrim())
        if prim.GetName().startswith("open_pbr")
    ]
    assert len(shaders) == 3
    for shader in shaders:
        definition = known.getNodeDef(shader.GetIdAttr().Get())
        assert definition is not None
        for one in shader.GetInputs():
            assert definition.getActiveInput(one.GetBaseName()) is not None, one.GetFullName()


@pytest.mark.parametrize("f0", [0.0, 0.04, 0.2, 0.9])
def test_the_index_of_refraction_gives_f0_back(f0):
    index = index_of_refraction(f0)
    assert ((index - 1) / (index + 1)) ** 2 == pytest.approx(f0)
    assert index_of_refraction(0.04) == pytest.approx(1.5)


def test_the_dome_is_turned_to_the_scans_axes(tmp_path):
    light = tmp_path / "light.hdr"
    light.write_bytes(b"any")
    export_estimate(GLOSSY_RED, "usd", tmp_path / "a.usda", light)
    stage = Usd.Stage.Open(str(tmp_path / "a.usda"))
    dome = UsdLux.DomeLight(next(p for p in stage.Traverse() if p.IsA(UsdLux.DomeLight)))
    turn = UsdGeom.Xformable(dome).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
    # A dome's pole is its +y, the middle of its picture +z; ours are +z and +x.
    assert tuple(turn.TransformDir(Gf.Vec3d(0, 1, 0))) == pytest.approx((0, 0, 1), abs=1e-6)
    assert tuple(turn.TransformDir(Gf.Vec3d(0, 0, 1))) == pytest.approx((1, 0, 0), abs=1e-6)
    assert tuple(turn.TransformDir(Gf.Vec3d(1, 0, 0))) == pytest.approx((0, 1, 0), abs=1e-6)


def test_the_file_says_where_it_comes_from(open_stage):
    stage = open_stage(GLOSSY_RED)
    ((material, _),) = bound_materials(stage).values()
    facts = material.GetPrim().GetCustomData()["reflest"]
    assert facts["model_id"] == GLOSSY_RED.model_id
    assert int(facts["stamp_ns"]) == GLOSSY_RED.stamp_ns
    assert tuple(facts["rho_d"]) == GLOSSY_RED.rho_d
    assert (facts["rho_s"], facts["alpha"]) == (0.2, 0.1)


@pytest.mark.parametrize("name", ['a "quoted" \\ name', "ünïcode", "two\nlines {braces}"])
def test_any_text_survives(open_stage, name):
    stage = open_stage(glossy_red(model_id=name))
    ((material, _),) = bound_materials(stage).values()
    assert material.GetPrim().GetCustomData()["reflest"]["model_id"] == name
