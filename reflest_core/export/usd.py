# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""USD: a sphere bound to a UsdPreviewSurface, as text (``.usda``).

The specular workflow carries F0 = ``rho_s``. Its Fresnel term rises to 1 at the horizon (Schlick);
Ward's does not, and UsdPreviewSurface has no input to keep it down.
"""

from __future__ import annotations

import json

from reflest_core.export.material_source import MaterialSource
from reflest_core.export.microfacet_material import MicrofacetMaterial
from reflest_core.export.sphere_mesh import RADIUS

TEMPLATE = """\
#usda 1.0
(
    defaultPrim = "reflest"
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "reflest" (
    customData = {{
        dictionary reflest = {{
{provenance}
        }}
    }}
)
{{
    def Sphere "sphere" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        float3[] extent = [(-{radius}, -{radius}, -{radius}), ({radius}, {radius}, {radius})]
        rel material:binding = </reflest/material>
        double radius = {radius}
    }}

    def Material "material"
    {{
        token outputs:surface.connect = </reflest/material/surface.outputs:surface>

        def Shader "surface"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = {base_colour}
            int inputs:useSpecularWorkflow = 1
            color3f inputs:specularColor = {specular_colour}
            float inputs:roughness = {roughness}
            token outputs:surface
        }}
    }}
{light}}}
"""

LIGHT = """
    def DomeLight "light"
    {{
        asset inputs:texture:file = @@@{file}@@@
        token inputs:texture:format = "latlong"
    }}
"""
"""A dome's middle is +z and its pole +y: the scan's world x, y, z become the stage's z, x, y."""


def usd_text(source: MaterialSource) -> bytes:
    """The ``.usda`` file; colours are linear Rec. 709, which is USD's default."""
    material = MicrofacetMaterial.from_ward(source.ward)
    lines = (_attribute(name, value) for name, value in source.provenance.items())
    text = TEMPLATE.format(
        provenance="\n".join(" " * 12 + line for line in lines),
        radius=RADIUS,
        base_colour=_tuple(material.base_colour),
        specular_colour=_tuple((material.f0,) * 3),
        roughness=material.roughness,
        light=LIGHT.format(file=_anchored(source.light)) if source.light else "",
    )
    return text.encode("utf-8")


def _anchored(path: str) -> str:
    """``path`` as USD resolves it from the file's own folder, not from its search path."""
    return path if path.startswith(("/", "../")) else f"./{path}"


def _attribute(name: str, value: str | float | list[float]) -> str:
    if isinstance(value, str):
        # JSON's escapes are among those that usda knows.
        return f"string {name} = {json.dumps(value, ensure_ascii=False)}"
    if isinstance(value, float):
        return f"double {name} = {value}"
    return f"double3 {name} = {_tuple(tuple(value))}"


def _tuple(values: tuple[float, ...]) -> str:
    return f"({', '.join(map(str, values))})"
