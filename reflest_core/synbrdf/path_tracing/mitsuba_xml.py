# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene of the data set as a Mitsuba 3 file, with its mesh and light beside it.

``scene.xml`` needs the plugin ``reflest_ward``: ``reflest synbrdf render`` registers it, and so
does ``import reflest_core.synbrdf.path_tracing.ward_bsdf`` before ``mitsuba.load_file``. Importing
this module loads Mitsuba.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.errors import ReflestError
from reflest_core.synbrdf.path_tracing.image_files import write_exr
from reflest_core.synbrdf.path_tracing.mitsuba_scene import (
    ENVIRONMENT_TURNS,
    PATH_DEPTH,
    mitsuba_mesh,
)
from reflest_core.synbrdf.path_tracing.ward_bsdf import PLUGIN, ward_bsdf
from reflest_core.synbrdf.scenes.scene import Scene
from reflest_core.whole_file import whole_folder

VERSION = "3.0.0"
SCENE, MESH, ENVIRONMENT = "scene.xml", "mesh.ply", "environment.exr"
OPTICAL_TO_MITSUBA = np.diag([-1.0, -1.0, 1.0, 1.0])
"""Mitsuba's cameras look along z with x to the left and y up."""


class RoomNotWritten(ReflestError):
    """A scene stands in a room, which these files do not hold."""


class MaterialsNotWritten(ReflestError):
    """A scene has several materials, which these files do not hold."""


def write_scene(
    folder: Path, scene: Scene, camera: CameraIntrinsics, views: list[int], samples: int
) -> None:
    """Write a folder: the XML with one sensor for each view, the mesh, the environment.

    Args:
        folder: to make.
        scene: the scene.
        camera: intrinsics.
        views: indices of views.
        samples: paths of a pixel.

    Raises:
        RoomNotWritten: The scene stands in a room.
        MaterialsNotWritten: The scene has several materials.
        OutputError: The folder cannot be written.
    """
    if not scene.painted.is_uniform:
        raise MaterialsNotWritten(
            f"{folder.name} has several materials, which Mitsuba files do not hold: use --product "
            "object, or 'reflest synbrdf images'"
        )
    if scene.room is not None:
        raise RoomNotWritten(
            f"{folder.name} stands in a room, which Mitsuba files do not hold yet: use --lighting "
            "natural or diverse, or 'reflest synbrdf images'"
        )
    with whole_folder(folder) as unfinished:
        unfinished.mkdir()
        mesh = mitsuba_mesh(scene.mesh, ward_bsdf(scene.painted.dominant.ward))
        try:
            mesh.write_ply(str(unfinished / MESH))
        except RuntimeError as error:
            raise OSError(str(error)) from error
        write_exr(unfinished / ENVIRONMENT, scene.light.radiance)
        (unfinished / SCENE).write_bytes(scene_xml(scene, camera, views, samples))


def scene_xml(scene: Scene, camera: CameraIntrinsics, views: list[int], samples: int) -> bytes:
    """The text of ``scene.xml``.

    Args:
        scene: the scene.
        camera: intrinsics.
        views: indices of views.
        samples: paths of a pixel or an observation.
    """
    root = ElementTree.Element("scene", version=VERSION)
    about = f" SynBRDF {scene.split.value} {scene.index}: {scene.shape} under {scene.light.name} "
    root.append(ElementTree.Comment(about.replace("--", "- -")))
    integrator = ElementTree.SubElement(root, "integrator", type="path")
    _add(integrator, "integer", "max_depth", str(PATH_DEPTH))
    for view in views:
        _add_sensor(root, camera, view, scene.poses[view], samples)
    _add_object(root, scene)
    emitter = ElementTree.SubElement(root, "emitter", type="envmap")
    _add(emitter, "string", "filename", ENVIRONMENT)
    to_world = ElementTree.SubElement(emitter, "transform", name="to_world")
    # The last turn in the list is the first in Mitsuba's product, and the other way round in XML.
    for axis, degrees in reversed(ENVIRONMENT_TURNS):
        ElementTree.SubElement(to_world, "rotate", {axis: "1"}, angle=repr(degrees))
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _add_sensor(
    root: ElementTree.Element,
    camera: CameraIntrinsics,
    view: int,
    pose: NDArray[np.float64],
    samples: int,
) -> None:
    sensor = ElementTree.SubElement(root, "sensor", type="perspective", id=f"view-{view:06d}")
    field = 2.0 * math.degrees(math.atan(0.5 * camera.width / camera.fx))
    _add(sensor, "float", "fov", repr(field))
    _add(sensor, "string", "fov_axis", "x")
    _add(sensor, "float", "near_clip", "0.001")
    to_world = ElementTree.SubElement(sensor, "transform", name="to_world")
    matrix = (pose @ OPTICAL_TO_MITSUBA).reshape(-1)
    ElementTree.SubElement(to_world, "matrix", value=" ".join(map(repr, matrix.tolist())))
    film = ElementTree.SubElement(sensor, "film", type="hdrfilm")
    _add(film, "integer", "width", str(camera.width))
    _add(film, "integer", "height", str(camera.height))
    ElementTree.SubElement(film, "rfilter", type="box")
    sampler = ElementTree.SubElement(sensor, "sampler", type="multijitter")
    _add(sampler, "integer", "sample_count", str(samples))


def _add_object(root: ElementTree.Element, scene: Scene) -> None:
    shape = ElementTree.SubElement(root, "shape", type="ply", id="object")
    _add(shape, "string", "filename", MESH)
    material = scene.painted.dominant.ward
    bsdf = ElementTree.SubElement(shape, "bsdf", type=PLUGIN)
    _add(bsdf, "rgb", "rho_d", ", ".join(map(repr, material.rho_d)))
    _add(bsdf, "float", "rho_s", repr(material.rho_s))
    _add(bsdf, "float", "alpha", repr(material.alpha))
    _add(bsdf, "string", "variant", material.variant.value)


def _add(parent: ElementTree.Element, kind: str, name: str, value: str) -> None:
    ElementTree.SubElement(parent, kind, name=name, value=value)
