# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np

from reflest_core.fusion.observations.views import ViewTable

F = np.full(3, 1, np.float32)
B = np.full(3, 2, np.float32)
SCENE = np.zeros(3)


def on_arc(degrees, distance=1.0):
    angle = np.radians(degrees)
    return distance * np.array([np.cos(angle), np.sin(angle), 0.0])


def test_near_is_measured_as_an_angle_about_the_scene():
    views = ViewTable(8)
    for n, degrees in enumerate((0.0, 3.0, 10.0)):
        views.put(on_arc(degrees), F, B, n)
    assert views.near(on_arc(1.9), SCENE, 2.0).tolist() == [1, 0]
    assert views.near(on_arc(6.0), SCENE, 2.0).tolist() == []
    assert views.near(on_arc(1.9, 0.9), SCENE, 2.0).tolist() == []
    assert views.near(on_arc(1.9), on_arc(1.9, 0.5), 2.0).tolist() == []


def test_full_table_gives_the_oldest_eighth_away():
    views = ViewTable(16)
    assert [views.put(on_arc(n), F, B, n) for n in range(16)] == list(range(16))
    assert views.is_full
    assert views.oldest().tolist() == [0, 1]
    views.forget(views.oldest())
    assert (views.count, views.stored, views.is_full) == (16, 14, False)
    assert views.near(on_arc(0.0), SCENE, 1.1).tolist() == []
    assert [views.put(on_arc(20 + n), F, B, 20 + n) for n in range(2)] == [0, 1]
    assert views.is_full
    assert views.oldest().tolist() == [2, 3]
    np.testing.assert_allclose(views.centres[0], on_arc(20), rtol=1e-6)
