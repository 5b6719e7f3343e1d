# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light as messages that a viewer and an AR application read."""

from __future__ import annotations

import numpy as np
import pytest

from reflest_core.environment.environment_map import EnvironmentMap
from reflest_core.environment.picture import coverage_codes, tone_mapped
from reflest_ros.outputs.environment import coverage_message, preview_message, radiance_message


@pytest.fixture
def environment():
    rng = np.random.default_rng(4)
    return EnvironmentMap(
        rng.uniform(0, 3, (16, 32, 3)).astype(np.float32),
        rng.uniform(0, 1, (16, 32)).astype(np.float32),
        rng.uniform(0, 0.2, (16, 32)).astype(np.float32),
    )


@pytest.mark.parametrize(
    ("make", "encoding", "expected"),
    [
        (radiance_message, "32FC3", lambda one: one.radiance),
        (coverage_message, "mono8", coverage_codes),
        (preview_message, "rgb8", tone_mapped),
    ],
)
def test_the_message_is_the_image(environment, make, encoding, expected):
    message, pixels = make(environment, "map", 12_000_000_034), expected(environment)
    assert (message.height, message.width, message.encoding) == (16, 32, encoding)
    assert message.step * message.height == len(message.data) == pixels.nbytes
    read = np.frombuffer(message.data, pixels.dtype).reshape(pixels.shape)
    np.testing.assert_array_equal(read, pixels)
    assert message.header.frame_id == "map"
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (12, 34)
