import numpy as np

from reflest_core.fusion.views import ViewTable

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


def test_full_table_gives_the_oldest_slot_away():
    views = ViewTable(3)
    assert [views.put(on_arc(n), F, B, n) for n in range(3)] == [0, 1, 2]
    assert views.is_full
    assert [views.put(on_arc(10 + n), F, B, 10 + n) for n in range(4)] == [0, 1, 2, 0]
    assert views.count == 3
    assert views.stamps.tolist() == [13, 11, 12]
    np.testing.assert_allclose(views.centres[0], on_arc(13), rtol=1e-6)
