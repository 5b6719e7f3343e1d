# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest replay``: what it prints and writes, and one sentence for everything that is wrong."""

import json
import math

import pytest

from reflest_core.cli.main import main
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.fusion.scan import Scan
from test.core.capture.recording import (
    PERIOD_NS,
    START_NS,
    Role,
    changed,
    recording,
    write_bag,
    write_seven_scenes,
    write_tum,
)
from test.core.capture.test_bag_transforms import NAMES, in_tf
from test.core.weight_files import untrained

COARSE = ["--voxel-size", "0.01"]


@pytest.fixture
def replay(weights, capsys, tmp_path):
    """Run ``reflest replay`` in this process; return code, stdout, stderr and the JSON."""

    def run(*arguments):
        out = tmp_path / "out.json"
        out.unlink(missing_ok=True)
        given = ["replay", *map(str, arguments), "--weights", str(weights), "--json", str(out)]
        code = main([*given, *COARSE])
        printed = capsys.readouterr()
        record = json.loads(out.read_text()) if out.exists() else None
        return code, printed.out, printed.err, record

    return run


def test_every_keyframe_and_the_end_get_an_estimate(replay, bag):
    code, out, err, record = replay(bag)
    assert code == 0
    assert err == ""
    stamps = [estimate["header"]["stamp_ns"] for estimate in record["estimates"]]
    assert len(stamps) >= 2
    assert stamps == sorted(stamps)
    assert record["final"]["header"]["stamp_ns"] == START_NS + 11 * PERIOD_NS
    assert record["final"]["header"]["frame_id"] == "camera_color_optical_frame"
    for stamp in stamps:
        assert f"{stamp / 1e9:.3f} s  rho_d" in out
    final = record["final"]
    assert f"rho_s  {final['rho_s']:.4f}" in out
    assert f"alpha  {final['alpha']:.4f}" in out
    assert record["frames"] == {"seen": 12, "fused": 12, "redundant": 0, "light_alone": 0}
    assert record["refusals"] == {}
    assert record["damage"] is None


@pytest.fixture
def final_of(bag, tmp_path, capsys):
    """The final estimate of an untrained model in the bag: as JSON, and what was printed."""

    def replayed(model):
        out = tmp_path / "out.json"
        chosen = ["--model", model, "--weights", str(untrained(model, tmp_path))]
        assert main(["replay", str(bag), "--json", str(out), *chosen, *COARSE]) == 0
        return json.loads(out.read_text())["final"], capsys.readouterr().out

    return replayed


def test_the_json_has_the_messages_field_names_and_null_for_unknown(final_of):
    final, printed = final_of("grouplet-fast")
    assert set(final) == {
        "header",
        "schema_version",
        "model_id",
        "ward_variant",
        "rho_d",
        "rho_s",
        "alpha",
        "lab",
        "c",
        "d",
        "voxel_count",
        "observation_count",
        "view_count",
        "coverage",
        "status",
        "status_name",
        "status_text",
        "rho_d_stddev",
        "rho_s_stddev",
        "alpha_stddev",
        "lab_stddev",
        "c_stddev",
        "d_stddev",
        "depth_agreement",
        "latency",
    }
    assert final["latency"] is None
    assert final["status_name"] == EstimateStatus(final["status"]).name
    assert final["rho_d_stddev"] == [None] * 3
    assert "±" not in printed


def test_lightnet_says_how_sure_it_is_in_the_json_and_in_print(final_of):
    final, printed = final_of("lightnet")
    assert final["model_id"].startswith("lightnet/")
    assert all(0.0 < stddev < math.inf for stddev in final["rho_d_stddev"])
    assert f"alpha  {final['alpha']:.4f} ± {final['alpha_stddev']:.4f}  (roughness)" in printed
    assert f"  Lab    {final['lab'][0]:.2f} " in printed
    assert f" ± {final['lab_stddev'][0]:.2f} " in printed


def test_the_same_scene_in_any_container_gives_the_same_estimates(replay, bag, tmp_path):
    write_bag(tmp_path / "db3", recording(12), "sqlite3")
    expected, other = replay(bag)[3], replay(tmp_path / "db3")[3]
    assert other["estimates"] == expected["estimates"]
    assert other["final"] == expected["final"]


@pytest.mark.parametrize("write", [write_seven_scenes, write_tum])
def test_folders_of_frames_are_replayed(replay, tmp_path, write):
    write(tmp_path / "folder", 6)
    code, _, err, record = replay(tmp_path / "folder")
    assert (code, err) == (0, "")
    assert record["frames"] == {"seen": 6, "fused": 6, "redundant": 0, "light_alone": 0}


def test_a_region_of_interest_leaves_the_rest_out(replay, bag):
    whole = sum(one["voxel_count"] for one in replay(bag)[3]["materials"])
    sphere = replay(bag, "--roi-sphere", 0, 0, 0, 0.16)[3]
    box = replay(bag, "--roi-box", 0.16, 0.16, 0.16, -0.16, -0.16, -0.09)[3]
    assert 0 < sphere["final"]["voxel_count"] < whole
    assert 0 < box["final"]["voxel_count"] < whole
    assert sphere["settings"]["region"] == {
        "shape": "sphere",
        "centre": [0, 0, 0],
        "size": [0.32, 0.32, 0.32],
    }
    assert box["settings"]["region"]["size"] == pytest.approx([0.32, 0.32, 0.25])


def test_options_lie_over_the_config(replay, bag, tmp_path):
    config = tmp_path / "estimator.yaml"
    config.write_text(
        "/**: {ros__parameters: {fusion: {max_depth: 1.5, voxel_size: 0.05}, "
        "region: {shape: box, centre: [0, 0, 0], size: [1, 1, 1]}}}"
    )
    settings = replay(bag, "--config", config, "--roi-sphere", 0, 0, 0, 0.16)[3]["settings"]
    assert settings["fusion"]["max_depth"] == 1.5
    assert settings["fusion"]["voxel_size"] == 0.01
    assert settings["region"]["shape"] == "sphere"


def test_the_scan_is_saved(replay, bag, tmp_path):
    one_material = ["--roi-sphere", 0, 0, 0, 5]
    record = replay(bag, "--save-scan", tmp_path / "scan.npz", *one_material)[3]
    scan = Scan.load(tmp_path / "scan.npz")
    assert scan.observation_count == record["final"]["observation_count"]


def test_an_earlier_scan_can_be_known(replay, bag, tmp_path):
    assert replay(bag, "--save-scan", tmp_path / "room")[0] == 0
    code, _, err, record = replay(bag, "--known-light", tmp_path / "room")
    assert (code, err) == (0, "")
    assert record["settings"]["estimation"]["known_light"] == str(tmp_path / "room")
    code, _, err, _ = replay(bag, "--known-light", tmp_path / "nowhere.hdr")
    assert code == 2
    assert one_error(code, err).endswith(f"{tmp_path / 'nowhere.hdr'} does not exist")


def test_refusals_are_warned_of_once_and_counted(replay, tmp_path):
    messages = recording(12)
    for index in (3, 4, 5):
        messages = changed(messages, Role.POSE, index, position=(math.nan, 0.0, 0.0))
    write_bag(tmp_path / "bag", messages)
    code, out, err, record = replay(tmp_path / "bag")
    assert code == 0
    assert err.count("NaN") == 1
    assert "warning: pose on /camera/pose at 5.100 s holds NaN" in err
    assert "refused: 3 pose_invalid" in err
    assert record["refusals"]["pose_invalid"]["count"] == 3
    assert "9 frames fused" in out


def test_a_cut_bag_is_used_as_far_as_it_goes(replay, tmp_path):
    file = write_bag(tmp_path / "bag", recording(40))
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2])
    code, _, err, record = replay(file)
    assert code == 0
    assert "warning: bag.mcap is damaged (it is cut off): only its first 0.6" in err
    assert record["damage"] in err
    assert 15 <= record["frames"]["fused"] <= 20


def one_error(code, err):
    """The single error line; warnings may stand before it."""
    assert code == 2
    lines = err.strip().splitlines()
    assert lines[-1].startswith("reflest: error: ")
    assert sum("error" in line for line in lines) == 1
    assert "Traceback" not in err
    return lines[-1]


def test_all_invalid_depth_ends_with_the_reason(replay, tmp_path):
    messages = recording(4)
    for index in range(4):
        messages = changed(messages, Role.DEPTH, index, data=bytes(2 * 96 * 72))
    write_bag(tmp_path / "bag", messages)
    code, _, err, record = replay(tmp_path / "bag")
    assert "has no valid pixel (all are 0, not finite, or saturated: 65535" in one_error(code, err)
    assert record["final"] is None
    assert record["refusals"]["depth_empty"]["count"] == 4


def test_an_unknown_encoding_ends_with_one_clear_message(replay, tmp_path):
    messages = recording(2)
    for index in range(2):
        messages = changed(messages, Role.RGB, index, encoding="bayer_rggb16")
    write_bag(tmp_path / "bag", messages)
    code, _, err, _ = replay(tmp_path / "bag")
    error = one_error(code, err)
    assert "/camera/color/image_raw (Image, bayer_rggb16)" in error
    assert "rgb8" in error
    code, _, err, _ = replay(tmp_path / "bag", "--rgb-topic", "/camera/color/image_raw")
    assert "has encoding 'bayer_rggb16'" in one_error(code, err)


def test_a_missing_topic_ends_with_what_there_is(replay, tmp_path):
    messages = [recorded for recorded in recording(2) if recorded.role is not Role.POSE]
    write_bag(tmp_path / "bag", messages)
    code, _, err, _ = replay(tmp_path / "bag")
    assert "no pose topic" in one_error(code, err)


def test_a_region_with_nothing_in_it_ends_with_the_reason(replay, bag):
    code, _, err, record = replay(bag, "--roi-sphere", 5, 5, 5, 0.1)
    assert "region of interest" in one_error(code, err)
    assert record["refusals"]["no_overlap"]["count"] == 12


def test_a_report_that_cannot_be_made_is_not_said_to_be_written(replay, bag, tmp_path):
    pytest.importorskip("open3d")
    page = tmp_path / "report.html"
    code, out, _, _ = replay(bag, "--roi-sphere", 5, 5, 5, 0.1, "--report", page)
    assert code == 2
    assert not page.exists()
    assert str(page) not in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--voxel-size", "5"], "fusion.voxel_size = 5"),
        (["--config", "absent.yaml"], "absent.yaml"),
        (["--save-scan", "no/such/folder/scan.npz"], "no/such/folder"),
        (["--materials", "cloud.txt"], "cloud.txt must end in .ply"),
        (["--rgb-topic", "/nothing"], "/nothing"),
        (["--intrinsics", "1", "1", "1", "1"], "--intrinsics"),
    ],
)
def test_a_bad_option_is_named(weights, bag, capsys, arguments, words):
    code = main(["replay", str(bag), "--weights", str(weights), *arguments])
    printed = capsys.readouterr()
    assert words in one_error(code, printed.err)
    assert printed.out == ""


def test_a_model_that_there_is_not_is_refused_with_those_that_there_are(bag, capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["replay", str(bag), "--model", "resnet"])
    assert "--model: invalid choice: 'resnet' (choose from 'lightnet'" in capsys.readouterr().err


def test_masks_in_the_config_need_their_topic(weights, bag, tmp_path, capsys):
    config = tmp_path / "estimator.yaml"
    config.write_text("/**: {ros__parameters: {capture: {use_mask: true}}}")
    code = main(["replay", str(bag), "--weights", str(weights), "--config", str(config)])
    assert "--mask-topic" in one_error(code, capsys.readouterr().err)


def test_the_json_replaces_the_old_one_whole_or_not_at_all(weights, bag, tmp_path, capsys):
    target = tmp_path / "out.json"
    target.mkdir()
    code = main(["replay", str(bag), "--weights", str(weights), "--json", str(target)])
    assert str(target) in one_error(code, capsys.readouterr().err)
    assert list(tmp_path.iterdir()) == [target]


def test_a_bag_with_tf_gives_the_same_estimates(replay, bag, tmp_path):
    write_bag(tmp_path / "tf", in_tf(recording(12)), topics=NAMES)
    expected = replay(bag)[3]["final"]
    code, _, err, record = replay(tmp_path / "tf", "--world-frame", "map")
    assert (code, err) == (0, "")
    for name in ("rho_s", "alpha", "voxel_count", "observation_count"):
        assert record["final"][name] == pytest.approx(expected[name], rel=1e-4)
    assert record["settings"]["capture"]["pose_source"] == "tf"


@pytest.mark.parametrize("x", ["-1e-3", "-.1E-2", "-0.001", "-1.0e-03"])
def test_a_negative_option_may_have_an_exponent(replay, bag, x):
    record = replay(bag, "--roi-sphere", x, 0, "1e-3", 0.2)[3]
    assert record["settings"]["region"]["centre"] == [-0.001, 0, 0.001]
