# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from reflest_core.synbrdf.scenes.exposure import SceneTooDark, auto_exposure, expose


def test_an_even_scene_becomes_middle_grey():
    grey = np.full((10, 10, 3), 7.0, np.float32)
    assert auto_exposure(grey) * 7.0 == pytest.approx(0.18)
    # 18 % linear is 118 in 8-bit sRGB.
    assert expose(grey, auto_exposure(grey)).ravel()[0] == 118


def test_highlights_clip_in_a_tenth_of_the_pixels_at_most():
    rng = np.random.default_rng(1)
    radiance = np.repeat(np.exp(rng.normal(0, 3, (5000, 1))), 3, axis=1).astype(np.float32)
    exposed = expose(radiance, auto_exposure(radiance))
    assert (exposed[:, 0] == 255).mean() == pytest.approx(0.1, abs=0.01)


def test_known_values_of_the_response():
    linear = np.array([0.0, 0.0031308, 0.2140411, 0.5, 1.0, 9.0], np.float32)
    assert expose(linear, 1.0).tolist() == [0, 10, 127, 188, 255, 255]
    assert expose(linear, 0.5)[-2] == 188


def test_darkness_is_refused():
    with pytest.raises(SceneTooDark, match="no light"):
        auto_exposure(np.zeros((4, 4, 3), np.float32))
