# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An RGB-D sequence as others read it: topics, stamps, and geometry against an analytic sphere."""

import json

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from scipy.ndimage import binary_dilation
from scipy.spatial.transform import Rotation

pytest.importorskip("mitsuba")

from reflest_core.brdf.parameters import WardParameters
from reflest_core.capture.open_capture import open_capture
from reflest_core.cli.main import main
from reflest_core.light.equirectangular import radiance_from
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.material_sources import Materials, MaterialSource
from reflest_core.synbrdf.scenes.measured_materials import FAMILIES
from reflest_core.synbrdf.sequences.sequence_scene import (
    ENVIRONMENT_HEIGHT,
    SequenceRefused,
    SequenceRequest,
    draw_sequence_scene,
)
from reflest_core.whole_file import OutputError
from test.synbrdf.lights.test_environments import gradient
from test.synbrdf.spheres import icosphere, write_obj

FRAMES, WIDTH, HEIGHT = 4, 64, 48
TYPES = {
    "/camera/color/image_raw": "sensor_msgs/msg/Image",
    "/camera/aligned_depth_to_color/image_raw": "sensor_msgs/msg/Image",
    "/camera/color/camera_info": "sensor_msgs/msg/CameraInfo",
    "/camera/pose": "geometry_msgs/msg/PoseStamped",
}


def arguments_of(out, sources, *more):
    options = ["--out", str(out), "--seed", "7", "--frames", str(FRAMES), "--samples", "16"]
    options += ["--width", str(WIDTH), "--height", str(HEIGHT), "--rate", "20"]
    options += ["--meshes", str(sources / "ball.obj"), "--environments", str(sources / "sky.npz")]
    return ["synbrdf", "sequence", *options, *more]


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    write_obj(folder / "ball.obj", icosphere(5))
    np.savez(folder / "sky.npz", sky=gradient(32) / 32)
    return folder


@pytest.fixture(scope="module")
def bag(sources, tmp_path_factory):
    out = tmp_path_factory.mktemp("bags") / "ball"
    material = ["--material", "0.4", "0.2", "0.1", "0.1", "0.1"]
    assert main(arguments_of(out, sources, *material)) == 0
    return out


@pytest.fixture(scope="module")
def messages(bag):
    """Every message of each topic, in order."""
    found = {}
    with AnyReader([bag], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
        assert {c.topic: c.msgtype for c in reader.connections} == TYPES
        for connection, log_time, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append((log_time, message))
    return found


@pytest.fixture(scope="module")
def truth(bag):
    return json.loads((bag / "truth.json").read_text())


def test_the_folder_holds_a_bag_and_the_truth(bag):
    assert sorted(p.name for p in bag.iterdir()) == ["ball.mcap", "metadata.yaml", "truth.json"]
    assert [p.name for p in bag.parent.iterdir()] == ["ball"]


def test_each_frame_has_one_stamp_on_four_topics(messages):
    stamps = {}
    for topic, of_topic in messages.items():
        stamps[topic] = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in of_topic]
        assert stamps[topic] == [log_time for log_time, _ in of_topic]
        assert np.diff(stamps[topic]).tolist() == [50_000_000] * (FRAMES - 1)
    assert len(stamps) == 4
    assert len({tuple(of_topic) for of_topic in stamps.values()}) == 1


def test_encodings_frames_and_calibration(messages):
    (_, colour), (_, depth), (_, info), (_, pose) = (messages[topic][0] for topic in TYPES)
    assert (colour.encoding, colour.step, colour.height) == ("rgb8", 3 * WIDTH, HEIGHT)
    assert (depth.encoding, depth.step, depth.height) == ("16UC1", 2 * WIDTH, HEIGHT)
    assert (colour.is_bigendian, depth.is_bigendian) == (0, 0)
    focal = 525 / 640 * WIDTH
    expected = [focal, 0, (WIDTH - 1) / 2, 0, focal, (HEIGHT - 1) / 2, 0, 0, 1]
    assert info.k.tolist() == pytest.approx(expected)
    assert info.p.reshape(3, 4)[:, :3].reshape(-1).tolist() == pytest.approx(expected)
    assert (info.distortion_model, info.d.tolist()) == ("plumb_bob", [0] * 5)
    frames = {m.header.frame_id for m in (colour, depth, info)}
    assert frames == {"camera_color_optical_frame"}
    assert pose.header.frame_id == "map"


def frame_of(messages, index):
    """Depth in metres, rays in the camera frame, and the camera's pose, straight from the bag."""
    depth = messages["/camera/aligned_depth_to_color/image_raw"][index][1]
    metres = np.asarray(depth.data).view("<u2").reshape(HEIGHT, WIDTH) / 1000
    k = messages["/camera/color/camera_info"][index][1].k.reshape(3, 3)
    pixels = np.stack(np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT), [1]), -1)[:, :, 0]
    rays = pixels @ np.linalg.inv(k).T
    pose = messages["/camera/pose"][index][1].pose
    q, p = pose.orientation, pose.position
    rotation = Rotation.from_quat([q.x, q.y, q.z, q.w]).as_matrix()
    return metres, rays, rotation, np.array([p.x, p.y, p.z])


@pytest.mark.parametrize("index", range(FRAMES))
def test_depth_is_the_spheres_z_and_lands_on_it_in_the_world(messages, truth, index):
    metres, rays, rotation, centre = frame_of(messages, index)
    radius = truth["diameter"] / 2
    directions = rays @ rotation.T
    a = (directions**2).sum(-1)
    b = directions @ centre
    c = centre @ centre - radius**2
    discriminant = b**2 - a * c
    # Rays with z = 1 in the camera: the parameter along them is Z. A rim of a thousandth of the
    # radius is left out, where the triangles end before the sphere.
    inside = discriminant > 2e-3 * a * radius**2
    outside = discriminant < -2e-3 * a * radius**2
    expected = (-b - np.sqrt(np.maximum(discriminant, 0))) / a
    assert inside.sum() > 50
    assert np.abs(metres - expected)[inside].max() < 1.5e-3
    assert (metres[outside] == 0).all()
    points = centre + metres[..., None] * directions
    np.testing.assert_allclose(np.linalg.norm(points[inside], axis=-1), radius, atol=2e-3)
    # The world's z is up, and the camera above the object sees its upper side.
    assert centre[2] > 0
    assert points[inside][:, 2].mean() > 0


def test_the_background_is_the_environment(bag, messages, truth, sources):
    source = find_environments(sources / "sky.npz")[0]
    turned = rotated(load_environment(source, ENVIRONMENT_HEIGHT), truth["environment_rotation"])
    for index in range(FRAMES):
        metres, rays, rotation, _ = frame_of(messages, index)
        colour = np.asarray(messages["/camera/color/image_raw"][index][1].data)
        directions = (rays @ rotation.T).reshape(-1, 3)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        expected = expose(radiance_from(turned, directions.astype(np.float32)), truth["exposure"])
        # Three pixels from the outline nothing of the object can be mixed in.
        clear = ~binary_dilation(metres > 0, iterations=3)
        difference = colour.reshape(HEIGHT, WIDTH, 3).astype(int) - expected.reshape(
            HEIGHT, WIDTH, 3
        )
        assert np.abs(difference[clear]).max() <= 1


def test_our_own_reader_takes_every_frame(bag):
    capture = open_capture(bag)
    frames = list(capture)
    assert len(frames) == FRAMES
    assert frames[0].rgb.shape == (HEIGHT, WIDTH, 3)
    assert frames[0].rgb[frames[0].depth > 0].std() > 3


def test_the_truth_has_the_estimates_names(truth):
    assert truth["ward_variant"] == "ward-1992"
    assert (truth["rho_d"], truth["rho_s"], truth["alpha"]) == ([0.4, 0.2, 0.1], 0.1, 0.1)
    luminance = 0.2126 * 0.4 + 0.7152 * 0.2 + 0.0722 * 0.1
    assert truth["d"] == pytest.approx(0.9)
    contrast = (0.1 + luminance / 2) ** (1 / 3) - (luminance / 2) ** (1 / 3)
    assert truth["c"] == pytest.approx(contrast, rel=1e-3)
    # The lightness of a luminance, CIE 1976.
    assert truth["lab"][0] == pytest.approx(116 * luminance ** (1 / 3) - 16, rel=1e-3)
    assert truth["shape"] == "ball"
    assert truth["environment"] == "sky"
    assert "--seed 7" in truth["command"]


def test_the_same_request_gives_the_same_bytes(bag, truth, sources, tmp_path):
    material = ["--material", "0.4", "0.2", "0.1", "0.1", "0.1"]
    assert main(arguments_of(tmp_path / "ball", sources, *material)) == 0
    for name in ("ball.mcap", "metadata.yaml"):
        assert (tmp_path / "ball" / name).read_bytes() == (bag / name).read_bytes()
    again = json.loads((tmp_path / "ball" / "truth.json").read_text())
    assert {**again, "command": ""} == {**truth, "command": ""}


def test_realism_has_its_own_seeded_faults_and_the_same_scene(bag, truth, sources, tmp_path):
    material = ["--material", "0.4", "0.2", "0.1", "0.1", "0.1", "--realism"]
    for name in ("one/ball", "two/ball"):
        assert main(arguments_of(tmp_path / name, sources, *material)) == 0
    real, again = (tmp_path / name / "ball.mcap" for name in ("one/ball", "two/ball"))
    assert real.read_bytes() == again.read_bytes()
    told = json.loads((tmp_path / "one" / "ball" / "truth.json").read_text())
    assert told["realism"]["jpeg_quality"] == 60
    assert told["exposure"] == truth["exposure"]
    clean, noisy = (list(open_capture(path)) for path in (bag, tmp_path / "one" / "ball"))
    for ours, theirs in zip(clean, noisy, strict=True):
        both = (ours.depth > 0) & (theirs.depth > 0)
        error = np.abs(theirs.depth - ours.depth)[both]
        assert 0 < error.mean() < 0.01
        assert (theirs.depth > 0).sum() < (ours.depth > 0).sum() * 1.1
        moved = np.linalg.norm(theirs.T_world_camera - ours.T_world_camera)
        assert 0 < moved < 0.05
        assert 0 < np.abs(theirs.rgb.astype(int) - ours.rgb).mean() < 60


def test_choosing_a_material_leaves_the_rest_of_the_scene():
    drawn = draw_sequence_scene(SequenceRequest(seed=2, frames=5))
    chosen_material = WardParameters((0.1, 0.1, 0.1), 0.0, 0.2)
    chosen = draw_sequence_scene(SequenceRequest(seed=2, frames=5, material=chosen_material))
    assert chosen.material == chosen_material != drawn.material
    np.testing.assert_array_equal(chosen.poses, drawn.poses)
    np.testing.assert_array_equal(chosen.mesh.vertices, drawn.mesh.vertices)
    assert chosen.light.name == drawn.light.name
    other = draw_sequence_scene(SequenceRequest(seed=3, frames=5))
    assert other.material != drawn.material
    assert not np.array_equal(other.poses, drawn.poses)


def test_measured_materials_are_named_in_the_truth(sources, tmp_path):
    request = SequenceRequest(seed=5, frames=2, materials=Materials(MaterialSource.MEASURED))
    scene = draw_sequence_scene(request)
    assert (scene.material_source, scene.material_name in FAMILIES) == ("measured", True)
    assert main(arguments_of(tmp_path / "ball", sources, "--materials", "measured")) == 0
    written = json.loads((tmp_path / "ball" / "truth.json").read_text())
    assert written["material_source"] == "measured"
    assert "--materials measured" in written["command"]


def test_an_existing_folder_is_never_touched(bag, sources, capsys):
    before = {path.name: path.stat().st_mtime_ns for path in bag.iterdir()}
    assert main(arguments_of(bag, sources)) == 2
    assert "exists: delete it or choose another --out" in capsys.readouterr().err
    assert {path.name: path.stat().st_mtime_ns for path in bag.iterdir()} == before


def test_a_failed_run_leaves_nothing(sources, tmp_path, monkeypatch):
    from reflest_core.synbrdf.sequences import sequence

    def full_disk(*_):
        raise OSError("no space left")

    monkeypatch.setattr(sequence, "write_truth", full_disk)
    request = SequenceRequest(seed=7, frames=2, width=16, height=16, samples=4)
    with pytest.raises(OutputError, match=r"cannot write .*ball: no space left"):
        sequence.write_sequence(tmp_path / "ball", request, "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"frames": 1}, "--frames"),
        ({"width": 0}, "--width"),
        ({"height": 100_000}, "--height"),
        ({"samples": 6}, "multiple of 4"),
        ({"samples": 0}, "--samples"),
        ({"rate": 0.0}, "--rate"),
        ({"rate": float("nan")}, "--rate"),
        ({"seed": -1}, "--seed"),
        ({"shape": "teapot"}, "teapot.*blob"),
        ({"material": WardParameters((0.9, 0.1, 0.1), 0.3, 0.1)}, "at most 1"),
        ({"material": WardParameters((0.1, -0.1, 0.1), 0.3, 0.1)}, "0 or more"),
        ({"material": WardParameters((0.1, float("nan"), 0.1), 0.3, 0.1)}, "0 or more"),
        ({"material": WardParameters((0.1, 0.1, 0.1), 0.3, 0.0)}, "alpha"),
        (
            {
                "material": WardParameters((0.1, 0.1, 0.1), 0.3, 0.1),
                "materials": Materials(MaterialSource.MEASURED),
            },
            "exclude each other",
        ),
    ],
)
def test_impossible_requests_are_refused(options, reason):
    with pytest.raises(SequenceRefused, match=reason):
        SequenceRequest(**{"seed": 1, **options})
