# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Four bytes a pixel: within half a step of the brightest channel, and the known bytes of 1.0."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from reflest_core.light import rgbe

RADIANCES = arrays(
    np.float32, (7, 3), elements=st.floats(0, np.float32(1e30), width=32, allow_subnormal=False)
)


@given(RADIANCES)
def test_a_pixel_comes_back_within_a_step_of_its_brightest_channel(radiance):
    back = rgbe.decode(rgbe.encode(radiance))
    brightest = radiance.max(axis=-1, keepdims=True)
    assert (np.abs(back - radiance) <= brightest / 128 + 1e-38).all()


def test_the_format_is_that_of_hdr_files():
    """Radiance writes 1.0 as mantissa 128 and exponent 129, and black as four zeros."""
    pixels = np.array([[1.0, 0.5, 0.25], [0.0, 0.0, 0.0]], np.float32)
    np.testing.assert_array_equal(rgbe.encode(pixels), [[128, 64, 32, 129], [0, 0, 0, 0]])
    np.testing.assert_array_equal(rgbe.decode(rgbe.encode(pixels))[1], 0.0)
