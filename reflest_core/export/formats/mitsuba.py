# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3: a scene of the surface; each ``bsdf`` element is a material to take elsewhere.

``mitsuba`` names our plugin ``reflest_ward``, which is the estimate exactly, with one colour for
each material: import ``reflest_core.synbrdf.path_tracing.ward_bsdf`` before ``mi.load_file``.
``mitsuba-stock`` needs no plugin: it mixes a white Beckmann mirror (weight ``rho_s``) with a
diffuse base of ``rho_d / (1 - rho_s)``, or the base colour texture where there is one. Ward's lobe
is Beckmann's with the same ``alpha`` (not squared) but for its normalisation: only grazing angles
differ.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree

import numpy as np

from reflest_core.export.asset import Asset, AssetMaterial
from reflest_core.export.environment_file import environment_bytes
from reflest_core.export.formats.mesh_library import texture_picture
from reflest_core.export.formats.obj import obj_lines, png_bytes
from reflest_core.export.microfacet_material import base_colour

SCENE_VERSION = "3.0.0"


def ward_scene(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The scene with ``reflest_ward`` elements.

    Args:
        asset: What to write. z stays up.
        file_name: Of the file, with its suffix.
    """
    materials = [_ward(material) for material in asset.materials]
    return _files(asset, file_name, materials, texture="")


def stock_scene(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The scene with what every Mitsuba 3 has.

    Args:
        asset: What to write. z stays up.
        file_name: Of the file, with its suffix.
    """
    stem = file_name.rsplit(".", 1)[0]
    texture = f"{stem}_base_colour.png" if asset.base_colour is not None else ""
    materials = [_stock(material, texture) for material in asset.materials]
    return _files(asset, file_name, materials, texture)


def _ward(material: AssetMaterial) -> ElementTree.Element:
    ward = material.ward
    bsdf = ElementTree.Element("bsdf", type="reflest_ward", id=material.name)
    _add(bsdf, "rgb", "rho_d", _numbers(ward.rho_d))
    _add(bsdf, "float", "rho_s", repr(ward.rho_s))
    _add(bsdf, "float", "alpha", repr(ward.alpha))
    _add(bsdf, "string", "variant", ward.variant.value)
    return bsdf


def _stock(material: AssetMaterial, texture: str) -> ElementTree.Element:
    rho_s = min(material.ward.rho_s, 1.0)
    outer = ElementTree.Element("bsdf", type="twosided", id=material.name)
    bsdf = ElementTree.SubElement(outer, "bsdf", type="blendbsdf")
    _add(bsdf, "float", "weight", repr(rho_s))
    base = ElementTree.SubElement(bsdf, "bsdf", type="diffuse")
    if texture:
        bitmap = ElementTree.SubElement(base, "texture", type="bitmap", name="reflectance")
        _add(bitmap, "string", "filename", texture)
        _add(bitmap, "string", "wrap_mode", "clamp")
    else:
        colour = base_colour(np.array(material.ward.rho_d), np.array(rho_s))
        _add(base, "rgb", "reflectance", _numbers(colour.tolist()))
    facets = ElementTree.SubElement(bsdf, "bsdf", type="roughconductor")
    _add(facets, "string", "material", "none")
    _add(facets, "string", "distribution", "beckmann")
    _add(facets, "float", "alpha", repr(material.ward.alpha))
    return outer


def _files(
    asset: Asset, file_name: str, materials: list[ElementTree.Element], texture: str
) -> dict[str, bytes]:
    stem = file_name.rsplit(".", 1)[0]
    files: dict[str, bytes] = {}
    light = asset.light_file
    if asset.light is not None and not light:
        light = f"{stem}_environment.exr"
        files[light] = environment_bytes(asset.light, "exr")
    scene = _scene(asset, light)
    for index, (material, bsdf) in enumerate(zip(asset.materials, materials, strict=True)):
        facts = "; ".join(f"{name} = {value}" for name, value in material.facts.items())
        # A comment must not hold two hyphens in a row.
        scene.append(ElementTree.Comment(f" reflest: {facts} ".replace("--", "- -")))
        if asset.is_swatch:
            shape = ElementTree.SubElement(scene, "shape", type="sphere")
            _add(shape, "float", "radius", repr(_radius(asset)))
        else:
            mesh = asset.mesh.part(index)
            if not len(mesh.faces):
                continue
            name = f"{stem}_{index + 1}.obj"
            files[name] = ("\n".join(obj_lines(mesh)) + "\n").encode()
            shape = ElementTree.SubElement(scene, "shape", type="obj")
            _add(shape, "string", "filename", name)
        shape.append(bsdf)
    if texture:
        files[texture] = png_bytes(texture_picture(asset))
    ElementTree.indent(scene)
    main = bytes(ElementTree.tostring(scene, encoding="utf-8", xml_declaration=True)) + b"\n"
    return {file_name: main, **files}


def _scene(asset: Asset, light: str) -> ElementTree.Element:
    """Camera and light: the surface in view from -y and above, under the scan's light."""
    scene = ElementTree.Element("scene", version=SCENE_VERSION)
    integrator = ElementTree.SubElement(scene, "integrator", type="path")
    _add(integrator, "integer", "max_depth", "3")
    sensor = ElementTree.SubElement(scene, "sensor", type="perspective")
    _add(sensor, "float", "fov", "30")
    low, high = asset.mesh.vertices.min(axis=0), asset.mesh.vertices.max(axis=0)
    centre = 0.5 * (low + high).astype(np.float64)
    radius = _radius(asset) if asset.is_swatch else 0.5 * float(np.linalg.norm(high - low))
    towards = np.array([0.0, -1.0, 0.0 if asset.is_swatch else 0.7])
    distance = (4.5 if asset.is_swatch else 1 / math.sin(math.radians(15))) * radius
    origin = centre + distance * towards / np.linalg.norm(towards)
    to_world = ElementTree.SubElement(sensor, "transform", name="to_world")
    ElementTree.SubElement(
        to_world,
        "lookat",
        origin=_numbers(origin.tolist()),
        target=_numbers(centre.tolist()),
        up="0, 0, 1",
    )
    _add(sensor, "float", "near_clip", repr(0.01 * distance))
    _add(sensor, "float", "far_clip", repr(10.0 * distance))
    film = ElementTree.SubElement(sensor, "film", type="hdrfilm")
    _add(film, "integer", "width", "256")
    _add(film, "integer", "height", "256")
    sampler = ElementTree.SubElement(sensor, "sampler", type="independent")
    _add(sampler, "integer", "sample_count", "64")
    if light:
        _add_environment(scene, light)
    else:
        _add_sky_and_lamp(scene)
    return scene


def _radius(asset: Asset) -> float:
    """Of a swatch's sphere, metres."""
    return float(np.linalg.norm(asset.mesh.vertices, axis=1).max())


def _add_environment(scene: ElementTree.Element, file: str) -> None:
    """The light of the scan. Mitsuba's maps have y up and -z in the middle; reflest's z and +x."""
    light = ElementTree.SubElement(scene, "emitter", type="envmap")
    _add(light, "string", "filename", file)
    to_world = ElementTree.SubElement(light, "transform", name="to_world")
    ElementTree.SubElement(to_world, "rotate", x="1", angle="90")
    ElementTree.SubElement(to_world, "rotate", z="1", angle="90")


def _add_sky_and_lamp(scene: ElementTree.Element) -> None:
    """A uniform sky and a distant light from above and left of the camera."""
    sky = ElementTree.SubElement(scene, "emitter", type="constant")
    _add(sky, "rgb", "radiance", "0.4, 0.4, 0.4")
    light = ElementTree.SubElement(scene, "emitter", type="directional")
    _add(light, "vector", "direction", "-0.15, 0.9, -0.6")
    _add(light, "rgb", "irradiance", "2, 2, 2")


def _add(parent: ElementTree.Element, kind: str, name: str, value: str) -> None:
    ElementTree.SubElement(parent, kind, name=name, value=value)


def _numbers(values: tuple[float, ...] | list[float]) -> str:
    return ", ".join(map(repr, values))
