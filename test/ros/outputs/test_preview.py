# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The picture as a message that any viewer shows."""

from __future__ import annotations

import numpy as np
from view_input import estimate

from reflest_core.brdf.srgb import decode
from reflest_ros.outputs.preview import EXPOSURE, LIGHT, preview_message


def pixels(message):
    return np.frombuffer(message.data, np.uint8).reshape(message.height, message.step // 3, 3)


def test_the_message_is_a_complete_image():
    message = preview_message(estimate(), 64)
    assert (message.width, message.height, message.encoding, message.step) == (64, 64, "rgb8", 192)
    assert len(message.data) == 64 * 192
    assert message.header.stamp.sec == 1_750_000_000
    assert message.header.stamp.nanosec == 123_456_789
    assert message.header.frame_id == "camera"


def test_a_diffuse_sphere_has_lamberts_brightness_in_its_middle():
    picture = pixels(preview_message(estimate(rho_d=(0.6, 0.3, 0.1), rho_s=0.0), 65))
    # The middle faces the camera, which is at -y.
    cosine = -LIGHT[1] / np.linalg.norm(LIGHT)
    expected = EXPOSURE * cosine * np.array([0.6, 0.3, 0.1])
    np.testing.assert_allclose(decode(picture[32, 32] / 255.0), expected, atol=0.004)
    np.testing.assert_array_equal(picture[0, 0], 0)


def test_the_highlight_lies_towards_the_light():
    dull = pixels(preview_message(estimate(rho_d=(0.2, 0.2, 0.2), rho_s=0.0), 64)).astype(int)
    glossy = pixels(preview_message(estimate(rho_d=(0.2, 0.2, 0.2), rho_s=0.1), 64)).astype(int)
    row, column = np.unravel_index((glossy - dull).sum(axis=2).argmax(), (64, 64))
    # Up and left in the picture.
    assert row < 30
    assert column < 30
