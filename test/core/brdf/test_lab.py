# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Lab against the colour-science library, the transfer curve against its standard's values."""

import colour
import numpy as np
import pytest
import torch

from reflest_core.brdf.lab import lab_to_rgb, luminance, rgb_to_lab
from reflest_core.brdf.srgb import decode, encode

RGB = np.random.default_rng(0).random((200, 3))


def test_lab_against_colour_science():
    xyz = colour.RGB_to_XYZ(RGB, "sRGB", apply_cctf_decoding=False)
    expected = colour.XYZ_to_Lab(xyz, colour.CCS_ILLUMINANTS["cie_2_1931"]["D65"])
    # colour-science rounds the sRGB matrix to four digits, as IEC 61966-2-1 prints it.
    np.testing.assert_allclose(rgb_to_lab(RGB), expected, atol=0.02)


def test_neutrals_have_no_colour_and_white_is_100():
    greys = np.linspace(0, 1, 11)[:, None] * np.ones(3)
    lab = rgb_to_lab(greys)
    np.testing.assert_allclose(lab[:, 1:], 0, atol=1e-9)
    assert lab[-1, 0] == pytest.approx(100)
    assert lab[0, 0] == pytest.approx(0)


def test_round_trip():
    np.testing.assert_allclose(lab_to_rgb(rgb_to_lab(RGB)), RGB, atol=1e-12)


def test_gradient_is_finite_at_black():
    black = torch.zeros(3, dtype=torch.float64, requires_grad=True)
    rgb_to_lab(black).sum().backward()
    assert torch.isfinite(black.grad).all()


def test_luminance_of_white_and_green():
    assert luminance(np.ones(3)) == pytest.approx(1)
    assert luminance(np.array([0.0, 1, 0])) == pytest.approx(0.7152, abs=1e-4)


def test_srgb_known_values_and_round_trip():
    # 18 % grey encodes to 118/255 and half light to 188/255 (IEC 61966-2-1).
    assert round(float(encode(np.array(0.18))) * 255) == 118
    assert round(float(encode(np.array(0.5))) * 255) == 188
    levels = np.arange(256) / 255
    np.testing.assert_allclose(encode(decode(levels)), levels, atol=1e-7)
    np.testing.assert_allclose(decode(torch.tensor(levels)).numpy(), decode(levels), atol=1e-12)
