# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""USD: one mesh with a subset and a material for each of the scan's, z up, metres.

Each material has a ``UsdPreviewSurface`` and, for the render context ``mtlx``, an OpenPBR surface
(MaterialX). Both take the square root of the GGX width as roughness and the index of refraction
that has the wanted F0. (The preview surface's specular workflow would give the same, but not every
reader knows it.) The Fresnel terms of both rise to 1 at the horizon, which Ward's does not.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.export.asset import Asset, AssetMaterial, Facts
from reflest_core.export.environment_file import environment_bytes
from reflest_core.export.formats.mesh_library import texture_picture
from reflest_core.export.formats.obj import png_bytes
from reflest_core.export.libraries import library
from reflest_core.export.microfacet_material import MicrofacetMaterial

DOME_TURNED = (90.0, 0.0, 90.0)
"""Degrees about x, y and z that take a dome's +y pole and +z middle to ours, +z and +x."""


def usd(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The stage with its texture and environment; ``.usdz`` holds them inside.

    Args:
        asset: What to write.
        file_name: Of the file: ``.usd``, ``.usda``, ``.usdc`` or ``.usdz``.
    """
    stem, suffix = file_name.rsplit(".", 1)
    files = {}
    if asset.base_colour is not None:
        files[f"{stem}_base_colour.png"] = png_bytes(texture_picture(asset))
    if asset.light is not None and not asset.light_file:
        files[f"{stem}_environment.exr"] = environment_bytes(asset.light, "exr")
    texture, light = (next((n for n in files if n.endswith(end)), "") for end in ("png", "exr"))
    light = asset.light_file or light
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            (Path(folder) / name).write_bytes(content)
        layer = Path(folder) / (f"{stem}.usdc" if suffix == "usdz" else file_name)
        _write_stage(asset, layer, texture, light)
        if suffix == "usdz":
            package = Path(folder) / file_name
            library("pxr.UsdUtils").CreateNewUsdzPackage(str(layer), str(package))
            return {file_name: package.read_bytes()}
        return {file_name: layer.read_bytes(), **files}


def _write_stage(asset: Asset, path: Path, texture: str, light: str) -> None:
    usd_module, geometry, gf = (library(f"pxr.{name}") for name in ("Usd", "UsdGeom", "Gf"))
    stage = usd_module.Stage.CreateNew(str(path))
    geometry.SetStageUpAxis(stage, geometry.Tokens.z)
    geometry.SetStageMetersPerUnit(stage, 1.0)
    root = geometry.Xform.Define(stage, f"/{asset.name}")
    stage.SetDefaultPrim(root.GetPrim())
    usd_module.ModelAPI(root.GetPrim()).SetKind("component")
    if asset.is_far:
        root.AddTranslateOp().Set(gf.Vec3d(*asset.origin))
    mesh = _add_mesh(stage, asset)
    for index, material in enumerate(asset.materials):
        faces = np.flatnonzero(asset.mesh.face_materials == index)
        if len(faces):
            added = _add_material(stage, asset, material, texture)
            _bind(mesh, added, material.name, faces)
    if light:
        lights = library("pxr.UsdLux")
        # A light outside of the default prim would be lost where the stage is referenced.
        dome = lights.DomeLight.Define(stage, f"/{asset.name}/environment")
        dome.CreateTextureFileAttr(_anchored(light))
        dome.CreateTextureFormatAttr(lights.Tokens.latlong)
        geometry.Xformable(dome).AddRotateXYZOp().Set(gf.Vec3f(*DOME_TURNED))
    stage.GetRootLayer().Save()


def _add_mesh(stage: Any, asset: Asset) -> Any:
    geometry, vt, sdf = (library(f"pxr.{name}") for name in ("UsdGeom", "Vt", "Sdf"))
    mesh = geometry.Mesh.Define(stage, f"/{asset.name}/surface")
    of, types = asset.mesh, sdf.ValueTypeNames
    mesh.CreatePointsAttr(vt.Vec3fArray.FromNumpy(np.ascontiguousarray(of.vertices, np.float32)))
    mesh.CreateFaceVertexCountsAttr(vt.IntArray([3] * len(of.faces)))
    mesh.CreateFaceVertexIndicesAttr(vt.IntArray.FromNumpy(of.faces.reshape(-1).copy()))
    mesh.CreateNormalsAttr(vt.Vec3fArray.FromNumpy(np.ascontiguousarray(of.normals, np.float32)))
    mesh.SetNormalsInterpolation(geometry.Tokens.vertex)
    mesh.CreateSubdivisionSchemeAttr(geometry.Tokens.none)
    mesh.CreateDoubleSidedAttr(not asset.is_swatch)
    low, high = of.vertices.min(axis=0).tolist(), of.vertices.max(axis=0).tolist()
    mesh.CreateExtentAttr(vt.Vec3fArray([tuple(low), tuple(high)]))
    primvars = geometry.PrimvarsAPI(mesh)
    if of.uv is not None:
        uv = primvars.CreatePrimvar("st", types.TexCoord2fArray, geometry.Tokens.vertex)
        uv.Set(vt.Vec2fArray.FromNumpy(np.ascontiguousarray(of.uv, np.float32)))
    for name, values in of.attributes.items():
        kind, array = (
            (types.FloatArray, vt.FloatArray)
            if values.ndim == 1
            else (types.Float3Array, vt.Vec3fArray)
        )
        primvar = primvars.CreatePrimvar(f"reflest:{name}", kind, geometry.Tokens.vertex)
        primvar.Set(array.FromNumpy(np.ascontiguousarray(values, np.float32)))
    return mesh


def _bind(mesh: Any, material: Any, name: str, faces: Any) -> None:
    shading, geometry, vt = (library(f"pxr.{name}") for name in ("UsdShade", "UsdGeom", "Vt"))
    binding = shading.MaterialBindingAPI.Apply(mesh.GetPrim())
    subset = binding.CreateMaterialBindSubset(
        f"faces_{name}", vt.IntArray.FromNumpy(faces.astype(np.int32)), geometry.Tokens.face
    )
    shading.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(material)
    binding.SetMaterialBindSubsetsFamilyType(geometry.Tokens.partition)


def _add_material(stage: Any, asset: Asset, of: AssetMaterial, texture: str) -> Any:
    shading = library("pxr.UsdShade")
    path = f"/{asset.name}/{of.name}"
    material = shading.Material.Define(stage, path)
    material.GetPrim().SetCustomDataByKey("reflest", _custom_data(of.facts))
    microfacet = MicrofacetMaterial.from_ward(of.ward)
    preview = _preview_surface(stage, path, microfacet, texture)
    material.CreateSurfaceOutput().ConnectToSource(preview.ConnectableAPI(), "surface")
    open_pbr = _open_pbr(stage, path, microfacet, texture)
    material.CreateSurfaceOutput("mtlx").ConnectToSource(open_pbr.ConnectableAPI(), "out")
    return material


def _preview_surface(stage: Any, path: str, of: MicrofacetMaterial, texture: str) -> Any:
    shading, sdf, gf = (library(f"pxr.{name}") for name in ("UsdShade", "Sdf", "Gf"))
    types = sdf.ValueTypeNames
    shader = shading.Shader.Define(stage, f"{path}/preview")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("metallic", types.Float).Set(0.0)
    shader.CreateInput("ior", types.Float).Set(index_of_refraction(of.f0))
    shader.CreateInput("roughness", types.Float).Set(of.roughness)
    shader.CreateOutput("surface", types.Token)
    diffuse = shader.CreateInput("diffuseColor", types.Color3f)
    if not texture:
        diffuse.Set(gf.Vec3f(*of.base_colour))
        return shader
    uv = shading.Shader.Define(stage, f"{path}/preview_uv")
    uv.CreateIdAttr("UsdPrimvarReader_float2")
    uv.CreateInput("varname", types.String).Set("st")
    image = shading.Shader.Define(stage, f"{path}/preview_base_colour")
    image.CreateIdAttr("UsdUVTexture")
    image.CreateInput("file", types.Asset).Set(_anchored(texture))
    image.CreateInput("sourceColorSpace", types.Token).Set("sRGB")
    image.CreateInput("wrapS", types.Token).Set("clamp")
    image.CreateInput("wrapT", types.Token).Set("clamp")
    image.CreateInput("st", types.Float2).ConnectToSource(uv.CreateOutput("result", types.Float2))
    diffuse.ConnectToSource(image.CreateOutput("rgb", types.Float3))
    return shader


def _open_pbr(stage: Any, path: str, of: MicrofacetMaterial, texture: str) -> Any:
    shading, sdf, gf = (library(f"pxr.{name}") for name in ("UsdShade", "Sdf", "Gf"))
    types = sdf.ValueTypeNames
    shader = shading.Shader.Define(stage, f"{path}/open_pbr")
    shader.CreateIdAttr("ND_open_pbr_surface_surfaceshader")
    shader.CreateInput("base_metalness", types.Float).Set(0.0)
    shader.CreateInput("specular_weight", types.Float).Set(1.0)
    shader.CreateInput("specular_ior", types.Float).Set(index_of_refraction(of.f0))
    shader.CreateInput("specular_roughness", types.Float).Set(of.roughness)
    shader.CreateOutput("out", types.Token)
    base = shader.CreateInput("base_color", types.Color3f)
    if not texture:
        base.Set(gf.Vec3f(*of.base_colour))
        return shader
    uv = shading.Shader.Define(stage, f"{path}/open_pbr_uv")
    uv.CreateIdAttr("ND_geompropvalue_vector2")
    uv.CreateInput("geomprop", types.String).Set("st")
    image = shading.Shader.Define(stage, f"{path}/open_pbr_base_colour")
    image.CreateIdAttr("ND_image_color3")
    file = image.CreateInput("file", types.Asset)
    file.Set(_anchored(texture))
    file.GetAttr().SetColorSpace("srgb_texture")
    image.CreateInput("texcoord", types.Float2).ConnectToSource(
        uv.CreateOutput("out", types.Float2)
    )
    base.ConnectToSource(image.CreateOutput("out", types.Color3f))
    return shader


def index_of_refraction(f0: float) -> float:
    """The index whose reflectance at normal incidence is ``f0`` (Fresnel).

    Args:
        f0: In [0, 1).
    """
    root = math.sqrt(min(f0, 0.999))
    return (1 + root) / (1 - root)


def _anchored(path: str) -> str:
    """``path`` as USD resolves it from the file's own folder, not from its search path."""
    return path if path.startswith(("/", "../")) else f"./{path}"


def _custom_data(facts: Facts) -> dict[str, Any]:
    gf = library("pxr.Gf")
    return {
        name: gf.Vec3d(*value) if isinstance(value, list) else value
        for name, value in facts.items()
    }
