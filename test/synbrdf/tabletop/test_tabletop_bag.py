# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rendered tabletops: faces have their materials, and the truth lies where the bag's depth is."""

import json

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.brdf.parameters import WardParameters
from reflest_core.capture.open_capture import open_capture
from reflest_core.cli.main import main
from reflest_core.ply_file import read_vertices
from reflest_core.synbrdf.path_tracing.mitsuba_scene import RadianceTracer, mitsuba_scene
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.scenes.material_sources import MaterialSource, NamedMaterial
from reflest_core.synbrdf.scenes.views import depth_camera
from reflest_core.synbrdf.tabletop.face_ward_bsdf import face_ward_bsdf
from reflest_core.synbrdf.tabletop.texture import two_materials
from reflest_core.synbrdf.tabletop.truth import POINT
from test.synbrdf.lights.test_environments import gradient
from test.synbrdf.spheres import icosphere

RED = WardParameters((0.5, 0.1, 0.1), 0.1, 0.1)
BLUE = WardParameters((0.1, 0.1, 0.5), 0.02, 0.2)
WIDTH, HEIGHT, FRAMES = 96, 72, 3


def test_each_face_reflects_as_its_material_alone_does():
    ball = icosphere(4)
    named = [NamedMaterial(ward, MaterialSource.MEASURED, "x") for ward in (RED, BLUE)]
    painted = two_materials(ball, *named, "ball", np.array([0, 0, 1.0, 0.0]))
    light = gradient(32).astype(np.float32) / 32
    x, z = np.meshgrid(np.linspace(-0.6, 0.6, 8), [-0.5, -0.3, 0.3, 0.5])
    origins = np.stack([x, np.full(x.shape, -3.0), z], axis=-1).reshape(-1, 3).astype(np.float32)
    directions = np.tile(np.float32([0, 1, 0]), (len(origins), 1))
    tracer = RadianceTracer(64, lanes=1 << 12)
    both = tracer.trace(mitsuba_scene(ball, face_ward_bsdf(painted), light), origins, directions, 5)
    for ward, side in ((RED, origins[:, 2] < 0), (BLUE, origins[:, 2] > 0)):
        alone = tracer.trace(mitsuba_scene(ball, ward_bsdf(ward), light), origins, directions, 5)
        np.testing.assert_allclose(both[side], alone[side], rtol=1e-4)
        assert np.abs(both[~side] / alone[~side] - 1).max() > 0.5


def arguments_of(out, light):
    options = ["--out", str(out), "--seed", "3", "--frames", str(FRAMES), "--samples", "4"]
    options += ["--width", str(WIDTH), "--height", str(HEIGHT), "--materials", "measured"]
    return ["synbrdf", "tabletop", *options, "--setting", "table", "--light", light]


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    out = tmp_path_factory.mktemp("tables") / "table"
    assert main(arguments_of(out, "distant")) == 0
    return out


def test_the_folder_holds_a_bag_and_the_truth(bag):
    names = sorted(path.name for path in bag.iterdir())
    assert names == ["metadata.yaml", "table.mcap", "truth.json", "truth.ply"]
    truth = json.loads((bag / "truth.json").read_text())
    assert truth["format"] == "synbrdf-sv-truth-1"
    assert [card["id"] for card in truth["materials"]] == list(range(len(truth["materials"])))
    assert {card["source"] for card in truth["materials"]} == {"measured"}
    assert truth["materials"][0]["part"] == "table"
    assert sum(card["seen_share"] for card in truth["materials"]) == pytest.approx(1.0)
    assert truth["path_depth"] >= 5


def test_truth_points_lie_on_what_the_camera_saw(bag):
    points, camera = read_vertices(bag / "truth.ply"), depth_camera(WIDTH, HEIGHT)
    places = np.stack([points[name] for name in "xyz"], axis=1).astype(np.float64)
    seen = np.zeros(len(points), int)
    for frame in open_capture(bag):
        pose = frame.T_world_camera
        x, y, z = ((places - pose[:3, 3]) @ pose[:3, :3]).T
        u, v = camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy
        u, v = np.rint(u).astype(int), np.rint(v).astype(int)
        within = (z > 0) & (u >= 0) & (u < WIDTH) & (v >= 0) & (v < HEIGHT)
        measured = frame.depth[v[within], u[within]]
        # A pixel is up to a centimetre across, and the table is seen at a slant.
        seen[np.flatnonzero(within)[np.abs(measured - z[within]) < 0.02]] += 1
    assert (seen > 0).mean() > 0.97
    assert points["views"].min() >= 1
    assert (np.abs(seen - points["views"]) <= 1).mean() > 0.95


def test_the_cloud_has_the_values_of_its_materials(bag):
    points = read_vertices(bag / "truth.ply")
    cards = json.loads((bag / "truth.json").read_text())["materials"]
    assert set(points["material_id"]) <= {card["id"] for card in cards}
    for card in cards:
        own = points[points["material_id"] == card["id"]]
        assert set(own["alpha"].tolist()) <= {np.float32(card["alpha"])}
        assert set(own["rho_s"].tolist()) <= {np.float32(card["rho_s"])}
        if card["texture"] == "plain" and len(own):
            assert np.unique(own["rho_d_g"]).tolist() == [np.float32(card["rho_d"][1])]


def test_the_cloud_is_a_ply_file_that_others_read(bag):
    trimesh = pytest.importorskip("trimesh")
    cloud = trimesh.load(bag / "truth.ply", process=False)
    data = cloud.metadata["_ply_raw"]["vertex"]["data"]
    points = read_vertices(bag / "truth.ply")
    assert tuple(data.dtype.names) == POINT.names
    np.testing.assert_array_equal(data["material_id"], points["material_id"])
    np.testing.assert_array_equal(data["rho_d_b"], points["rho_d_b"])


def test_the_same_request_gives_the_same_bytes(bag, tmp_path):
    assert main(arguments_of(tmp_path / "table", "distant")) == 0
    for name in ("table.mcap", "truth.ply"):
        assert (tmp_path / "table" / name).read_bytes() == (bag / name).read_bytes()


def test_an_existing_folder_is_refused(bag, capsys):
    assert main(["synbrdf", "tabletop", "--out", str(bag)]) == 2
    assert "exists: delete it" in capsys.readouterr().err


def test_in_a_room_its_walls_have_depth_and_no_truth(bag, tmp_path):
    assert main(arguments_of(tmp_path / "table", "near")) == 0
    distant, near = (next(iter(open_capture(path))) for path in (bag, tmp_path / "table"))
    on_table = distant.depth > 0
    # Rounded to whole millimetres from single or double precision.
    np.testing.assert_allclose(near.depth[on_table], distant.depth[on_table], atol=1.001e-3)
    assert (near.depth[on_table] == distant.depth[on_table]).mean() > 0.99
    assert (near.depth > 0).sum() > 1.2 * on_table.sum()
    np.testing.assert_array_equal(
        read_vertices(tmp_path / "table" / "truth.ply"), read_vertices(bag / "truth.ply")
    )


CHOSEN = ["--table-material", "0.4", "0.3", "0.2", "0.04", "0.1"]
CHOSEN += ["--object", "blob", "0.5", "0.05", "0.04", "0.05", "0.03"]
CHOSEN += ["--object", "lathe", "0.06", "0.2", "0.4", "0.03", "0.15"]


def test_chosen_objects_stand_on_a_chosen_table(tmp_path):
    out = tmp_path / "chosen"
    arguments = ["synbrdf", "tabletop", "--out", str(out), "--seed", "32", "--frames", "2"]
    arguments += ["--samples", "4", "--width", "64", "--height", "48", *CHOSEN]
    arguments += ["--truth-points", "2000"]
    assert main(arguments) == 0
    truth = json.loads((out / "truth.json").read_text())
    assert truth["shapes"] == ["blob", "lathe"]
    assert truth["setting"] == "table"
    found = [(one["part"], one["source"], one["rho_d"][0]) for one in truth["materials"]]
    assert found == [
        ("table", "given", 0.4),
        ("object-1", "given", 0.5),
        ("object-2", "given", 0.06),
    ]
    assert " ".join(CHOSEN) in truth["command"]
    assert 500 < len(read_vertices(out / "truth.ply")) <= 2000


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--object", "cow", "0", "0", "0", "0", "0.1"], "--object is a cow, but must be one of"),
        (["--object", "blob", "x", "0", "0", "0", "0.1"], "a kind of shape and five numbers"),
        (["--object", "blob", "0.9", "0", "0", "0.2", "0.1"], "at most 1"),
        (["--table-material", "0", "0", "0", "0", "2"], "--table-material has alpha 2.0"),
        (["--truth-points", "10"], "--truth-points is 10, but must be 1000 to 10000000"),
        ([*CHOSEN[:6], "--setting", "corner"], "--table-material needs a table"),
        (["--object", "blob", ".1", ".1", ".1", ".1", ".1"] * 40, "the table has no room for"),
    ],
)
def test_what_cannot_stand_on_a_table_is_refused_by_name(tmp_path, capsys, words, sentence):
    out = tmp_path / "refused"
    assert main(["synbrdf", "tabletop", "--out", str(out), *words]) == 2
    assert sentence in capsys.readouterr().err
    assert not out.exists()
