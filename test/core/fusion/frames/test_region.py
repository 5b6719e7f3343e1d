# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.settings import RegionSettings
from reflest_core.parameter import ParameterError

POINTS = np.array([[1.0, 2.0, 3.0], [1.4, 2.0, 3.0], [1.0, 2.9, 3.0], [1.4, 2.9, 3.9]])


def inside(shape):
    settings = RegionSettings(shape, (1.0, 2.0, 3.0), (1.0, 2.0, 2.0))
    return Region.from_settings(settings).contains(POINTS).tolist()


def test_box_spans_its_edges_about_its_centre():
    assert inside("box") == [True, True, True, True]
    narrow = RegionSettings("box", (1.0, 2.0, 3.0), (0.7, 2.0, 2.0))
    assert Region.from_settings(narrow).contains(POINTS).tolist() == [True, False, True, False]


def test_sphere_takes_the_first_size_as_its_diameter():
    assert inside("sphere") == [True, True, False, False]


def test_no_region_holds_everything():
    assert inside("none") == [True] * 4


@pytest.mark.parametrize(("shape", "size"), [("box", (1.0, 0.0, 1.0)), ("sphere", (0.0, 1.0, 1.0))])
def test_a_region_without_room_is_refused(shape, size):
    with pytest.raises(ParameterError, match=f"a {shape} needs"):
        RegionSettings(shape, (0.0, 0.0, 0.0), size)
    RegionSettings("none", (0.0, 0.0, 0.0), size)
