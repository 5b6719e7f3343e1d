# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours in the file of a mesh are those that the page shows."""

import json
import struct

import numpy as np

from reflest_core.brdf import srgb
from reflest_core.viewer import unlit_mesh
from reflest_core.viewer.unlit_mesh import before_tone_curve, unlit_glb


def tone_curve(colours):
    """three.js' ACESFilmicToneMapping."""
    (a, b), (c, d, e) = unlit_mesh.NUMERATOR, unlit_mesh.DENOMINATOR
    v = colours / 0.6 @ unlit_mesh.TO_CURVE.T
    return np.clip((v * (v + a) + b) / (v * (c * v + d) + e) @ unlit_mesh.FROM_CURVE.T, 0, 1)


def test_the_tone_curve_gives_every_colour_back_to_the_bit():
    levels = np.arange(0, 256, 15)
    colours = np.stack(np.meshgrid(levels, levels, levels), axis=-1).reshape(-1, 3).astype(np.uint8)
    shown = np.rint(255 * srgb.encode(tone_curve(before_tone_curve(colours).astype(np.float64))))
    assert np.abs(shown - colours).max() <= 1


def test_the_file_holds_an_unlit_mesh_with_a_colour_for_each_vertex():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    colours = np.array([[255, 0, 0], [0, 255, 0], [10, 20, 30]], np.uint8)
    content = unlit_glb(vertices, np.array([[0, 1, 2]], np.int32), colours)
    length = struct.unpack("<I", content[12:16])[0]
    tree = json.loads(content[20 : 20 + length])
    (primitive,) = tree["meshes"][0]["primitives"]
    assert tree["accessors"][primitive["attributes"]["COLOR_0"]]["count"] == 3
    assert tree["materials"][primitive["material"]]["extensions"] == {"KHR_materials_unlit": {}}
