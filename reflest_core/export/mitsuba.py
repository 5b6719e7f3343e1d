# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3: a scene of a sphere; its ``bsdf`` element is the material to take elsewhere.

``ward_scene`` names our plugin ``reflest_ward``, which is the estimate exactly: import
``reflest_core.synbrdf.path_tracing.ward_bsdf`` before ``mi.load_file``. ``stock_scene`` needs no
plugin: it mixes a white Beckmann mirror (weight ``rho_s``) with a diffuse base of
``rho_d / (1 - rho_s)``.
Ward's lobe is Beckmann's with the same ``alpha`` but for its normalisation, so the highlights agree
and only grazing angles differ.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

from reflest_core.export.material_source import MaterialSource
from reflest_core.export.microfacet_material import MicrofacetMaterial

SCENE_VERSION = "3.0.0"


def ward_scene(source: MaterialSource) -> bytes:
    """The scene with a ``reflest_ward`` element."""
    ward = source.ward
    bsdf = ElementTree.Element("bsdf", type="reflest_ward", id="reflest")
    _add(bsdf, "rgb", "rho_d", _numbers(ward.rho_d))
    _add(bsdf, "float", "rho_s", repr(ward.rho_s))
    _add(bsdf, "float", "alpha", repr(ward.alpha))
    _add(bsdf, "string", "variant", ward.variant.value)
    return _scene(source, bsdf)


def stock_scene(source: MaterialSource) -> bytes:
    """The scene with what every Mitsuba 3 has."""
    material = MicrofacetMaterial.from_ward(source.ward)
    bsdf = ElementTree.Element("bsdf", type="blendbsdf", id="reflest")
    _add(bsdf, "float", "weight", repr(material.f0))
    base = ElementTree.SubElement(bsdf, "bsdf", type="diffuse")
    _add(base, "rgb", "reflectance", _numbers(material.base_colour))
    facets = ElementTree.SubElement(bsdf, "bsdf", type="roughconductor")
    _add(facets, "string", "material", "none")
    _add(facets, "string", "distribution", "beckmann")
    _add(facets, "float", "alpha", repr(source.ward.alpha))
    return _scene(source, bsdf)


def _scene(source: MaterialSource, bsdf: ElementTree.Element) -> bytes:
    """A unit sphere, seen along +y with z up, under the scan's light or an invented one."""
    scene = ElementTree.Element("scene", version=SCENE_VERSION)
    facts = "; ".join(f"{name} = {value}" for name, value in source.provenance.items())
    # A comment must not hold two hyphens in a row.
    scene.append(ElementTree.Comment(f" reflest: {facts} ".replace("--", "- -")))
    integrator = ElementTree.SubElement(scene, "integrator", type="path")
    _add(integrator, "integer", "max_depth", "3")
    sensor = ElementTree.SubElement(scene, "sensor", type="perspective")
    _add(sensor, "float", "fov", "30")
    to_world = ElementTree.SubElement(sensor, "transform", name="to_world")
    ElementTree.SubElement(to_world, "lookat", origin="0, -4.5, 0", target="0, 0, 0", up="0, 0, 1")
    film = ElementTree.SubElement(sensor, "film", type="hdrfilm")
    _add(film, "integer", "width", "256")
    _add(film, "integer", "height", "256")
    sampler = ElementTree.SubElement(sensor, "sampler", type="independent")
    _add(sampler, "integer", "sample_count", "64")
    if source.light:
        _add_environment(scene, source.light)
    else:
        _add_sky_and_lamp(scene)
    sphere = ElementTree.SubElement(scene, "shape", type="sphere")
    sphere.append(bsdf)
    ElementTree.indent(scene)
    return bytes(ElementTree.tostring(scene, encoding="utf-8", xml_declaration=True)) + b"\n"


def _add_environment(scene: ElementTree.Element, file: str) -> None:
    """The light of the scan. Mitsuba's maps have y up and -z in the middle; ours z and +x."""
    light = ElementTree.SubElement(scene, "emitter", type="envmap")
    _add(light, "string", "filename", file)
    to_world = ElementTree.SubElement(light, "transform", name="to_world")
    ElementTree.SubElement(to_world, "rotate", x="1", angle="90")
    ElementTree.SubElement(to_world, "rotate", z="1", angle="90")


def _add_sky_and_lamp(scene: ElementTree.Element) -> None:
    """An even sky and a distant light from above and left of the camera."""
    sky = ElementTree.SubElement(scene, "emitter", type="constant")
    _add(sky, "rgb", "radiance", "0.4, 0.4, 0.4")
    light = ElementTree.SubElement(scene, "emitter", type="directional")
    _add(light, "vector", "direction", "-0.15, 0.9, -0.6")
    _add(light, "rgb", "irradiance", "2, 2, 2")


def _add(parent: ElementTree.Element, kind: str, name: str, value: str) -> None:
    ElementTree.SubElement(parent, kind, name=name, value=value)


def _numbers(values: tuple[float, ...]) -> str:
    return ", ".join(map(repr, values))
