# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is read is never written over, and two results never go into one file."""

import pytest

from reflest_core.cli.main import main
from reflest_core.cli.output_files import check_overwriting


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A bag, another recording, a folder of frames, and links to some of them."""
    monkeypatch.chdir(tmp_path)
    for name in ("bag", "frames/rgb"):
        (tmp_path / name).mkdir(parents=True)
    for name in ("bag/bag.mcap", "bag/metadata.yaml", "bag/old.json", "other.mcap", "room.npz"):
        (tmp_path / name).write_bytes(b"precious")
    for name in ("frames/rgb.txt", "frames/rgb/1.png", "recording"):
        (tmp_path / name).write_bytes(b"precious")
    (tmp_path / "link.json").symlink_to("bag/bag.mcap")
    (tmp_path / "frame.json").symlink_to("frames/rgb/1.png")
    (tmp_path / "hard.json").hardlink_to(tmp_path / "recording")
    (tmp_path / "linked_bag").symlink_to("bag")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["replay", "bag/bag.mcap", "--json", "bag/bag.mcap"], "--json bag/bag.mcap is a recor"),
        (["replay", "bag", "--save-scan", "bag/metadata.yaml"], "--save-scan bag/metadata.yaml is"),
        (["replay", "bag", "--json", "link.json"], "--json link.json is a recording"),
        (["replay", "linked_bag", "--report", "./bag/bag.mcap"], "--report bag/bag.mcap is a rec"),
        (["replay", "bag", "--json", "other.mcap"], "--json other.mcap is a recording"),
        (["replay", "recording", "--json", "hard.json"], "would overwrite recording, which"),
        (["replay", "frames", "--json", "frames/rgb.txt"], "would overwrite frames/rgb.txt, which"),
        (["replay", "frames", "--json", "frame.json"], "would overwrite frames/rgb/1.png, which"),
        (
            ["replay", "bag", "--known-light", "room.npz", "--save-scan", "room.npz"],
            "--save-scan r",
        ),
        (["replay", "bag", "--json", "a", "--save-scan", "a"], "--json and --save-scan both name"),
        (["replay", "bag", "--json", "a", "--report", "../{here}/a"], "--json and --report both"),
        (["replay", "bag", "--json", "/dev/null"], "/dev/null: it is no regular file"),
        (
            ["export", "room.npz", "--format", "ply", "--out", "room.npz"],
            "would overwrite room.npz",
        ),
        (["export", "bag", "--format", "ply", "--out", "bag/bag.mcap"], "--out bag/bag.mcap is a"),
    ],
)
def test_it_is_refused_and_nothing_changes(folder, capsys, arguments, sentence):
    def contents():
        return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    before = contents()
    assert main([word.format(here=folder.name) for word in arguments]) == 2
    assert sentence in capsys.readouterr().err
    assert contents() == before


def test_a_former_result_is_replaced_wherever_it_lies(folder):
    check_overwriting({"--json": folder / "bag/old.json"}, [folder / "bag"])
    check_overwriting({"--json": folder / "frames/new.json"}, [folder / "frames"])


def test_training_does_not_replace_what_it_begins_with(folder, capsys):
    (folder / "lightnet.safetensors").touch()
    given = ["--from", "lightnet.safetensors", "--out", "."]
    assert main(["train", "frames", "--model", "lightnet", *given]) == 2
    assert "would overwrite lightnet.safetensors, which" in capsys.readouterr().err


def test_data_are_not_packed_into_themselves(capsys):
    assert main(["train", "frames", "--pack", "--out", "./frames"]) == 2
    assert "--out frames is the data itself" in capsys.readouterr().err
