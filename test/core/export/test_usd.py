# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pixar's own library reads what was written."""

import pytest
from pxr import Usd, UsdGeom, UsdShade, UsdValidation

from reflest_core.export.material_file import export_estimate
from test.core.export.estimates import GLOSSY_RED, glossy_red


@pytest.fixture
def open_stage(tmp_path):
    def opened(estimate):
        path = tmp_path / "material.usda"
        export_estimate(estimate, "usd", path)
        return Usd.Stage.Open(str(path))

    return opened


def test_the_sphere_is_bound_to_the_preview_surface(open_stage):
    stage = open_stage(GLOSSY_RED)
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    sphere = stage.GetPrimAtPath("/reflest/sphere")
    assert UsdGeom.Sphere(sphere).GetRadiusAttr().Get() == pytest.approx(0.05)
    material, _ = UsdShade.MaterialBindingAPI(sphere).ComputeBoundMaterial()
    shader, _, _ = material.ComputeSurfaceSource()
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    values = {one.GetBaseName(): one.Get() for one in shader.GetInputs()}
    assert values["useSpecularWorkflow"] == 1
    assert tuple(values["diffuseColor"]) == pytest.approx((0.5, 0.1, 0.05))
    assert tuple(values["specularColor"]) == pytest.approx((0.2, 0.2, 0.2))
    assert values["roughness"] == pytest.approx(0.09243**0.5, abs=1e-4)


def test_no_validator_of_usd_objects(open_stage):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 10
    errors = UsdValidation.ValidationContext(validators).Validate(open_stage(GLOSSY_RED))
    assert [error.GetMessage() for error in errors] == []


def test_the_file_says_where_it_comes_from(open_stage):
    stage = open_stage(GLOSSY_RED)
    facts = stage.GetDefaultPrim().GetCustomData()["reflest"]
    assert facts["model_id"] == GLOSSY_RED.model_id
    assert int(facts["stamp_ns"]) == GLOSSY_RED.stamp_ns
    assert tuple(facts["rho_d"]) == GLOSSY_RED.rho_d
    assert (facts["rho_s"], facts["alpha"]) == (0.2, 0.1)


@pytest.mark.parametrize("name", ['a "quoted" \\ name', "ünïcode", "two\nlines {braces}"])
def test_any_text_survives(open_stage, name):
    stage = open_stage(glossy_red(model_id=name))
    assert stage.GetDefaultPrim().GetCustomData()["reflest"]["model_id"] == name


def test_the_smallest_roughness_is_readable(open_stage):
    stage = open_stage(glossy_red(alpha=0.001, rho_s=1e-7))
    shader = UsdShade.Shader(stage.GetPrimAtPath("/reflest/material/surface"))
    assert shader.GetInput("specularColor").Get()[0] == pytest.approx(1e-7)
