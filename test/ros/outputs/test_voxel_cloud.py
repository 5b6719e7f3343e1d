# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The cloud as a message, in its three colourings and its bound."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from cloud_reader import colours, column
from view_input import STAMP_NS, estimate, keyframe

from reflest_core.rendering.voxel_colours import (
    UNKNOWN,
    estimate_colours,
    observed_colours,
    view_count_colours,
)
from reflest_ros.outputs.view_settings import VoxelSettings
from reflest_ros.outputs.voxel_cloud import cloud_message


def test_points_are_the_voxels_in_the_world_frame():
    shown = keyframe()
    message = cloud_message(shown, estimate(), VoxelSettings(), 64)
    assert message.header.frame_id == "map"
    assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == STAMP_NS
    assert (message.height, message.width) == (1, 500)
    assert message.row_step == len(message.data) == 500 * message.point_step
    assert message.is_dense
    for axis, name in enumerate("xyz"):
        np.testing.assert_array_equal(column(message, name), shown.surface.positions[:, axis])
        np.testing.assert_array_equal(
            column(message, f"normal_{name}"), shown.surface.normals[:, axis]
        )
    np.testing.assert_array_equal(column(message, "views"), shown.surface.observation_counts)


def test_each_colouring_is_the_one_that_was_asked_for():
    shown, material = keyframe(), estimate()
    surface = shown.surface
    expected = {
        "observed": observed_colours(surface),
        "views": view_count_colours(surface.observation_counts, 64),
        "estimate": estimate_colours(surface, material.ward, np.array([0.0, 0.0, 1.0])),
    }
    for name, wanted in expected.items():
        message = cloud_message(shown, material, VoxelSettings(colour=name), 64)
        np.testing.assert_array_equal(colours(message), wanted)
    assert len({value.tobytes() for value in expected.values()}) == 3


@pytest.mark.parametrize("has_estimate", [True, False])
def test_without_an_estimate_or_a_pose_its_colour_is_the_grey_of_the_unknown(has_estimate):
    shown = keyframe() if not has_estimate else dataclasses.replace(keyframe(), T_world_camera=None)
    material = estimate() if has_estimate else None
    message = cloud_message(shown, material, VoxelSettings(colour="estimate"), 64)
    np.testing.assert_array_equal(colours(message), UNKNOWN)


def test_a_large_cloud_is_thinned_evenly():
    shown = keyframe(voxels=5000)
    message = cloud_message(shown, None, VoxelSettings(max_points=100), 64)
    assert message.width == 100
    kept = np.flatnonzero(np.isin(shown.surface.positions[:, 0], column(message, "x")))
    assert len(kept) == 100
    assert np.diff(kept).max() <= 51


def test_an_empty_scan_gives_an_empty_cloud():
    message = cloud_message(keyframe(voxels=0), None, VoxelSettings(), 64)
    assert (message.width, len(message.data)) == (0, 0)
