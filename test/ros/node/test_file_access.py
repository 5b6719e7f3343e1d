# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Services read and write below one folder, and nothing but regular files."""

from __future__ import annotations

import os

import pytest

from reflest_core.whole_file import OutputError
from reflest_ros.services.file_access import FileAccess, FileAccessError
from reflest_ros.settings import FileSettings


@pytest.fixture
def root(tmp_path):
    (tmp_path / "root").mkdir()
    return tmp_path / "root"


@pytest.fixture
def files(root):
    return FileAccess(FileSettings(root=str(root)))


@pytest.mark.parametrize("name", ["scan", "./scan", "folder/scan"])
def test_a_relative_path_starts_at_the_root(files, root, name):
    (root / "folder").mkdir()
    assert files.to_write(name) == root / name
    (root / name).write_text("scan")
    assert files.to_read(name) == files.to_read(str(root / name)) == root / name


@pytest.mark.parametrize(
    "path",
    [
        "",
        "/",
        ".",
        "..",
        "../scan",
        "a/../../scan",
        "/etc/passwd",
        "/proc/self/mem",
        "/dev/zero",
        "a\0b",
        "link/scan",
        "link",
        "x" * 300 + "/../../y",
    ],
)
def test_nothing_outside_the_root_is_read_or_written(files, root, tmp_path, path):
    (root / "link").symlink_to(tmp_path)
    for use in (files.to_read, files.to_write):
        with pytest.raises(FileAccessError):
            use(path)


def test_a_link_out_of_the_root_is_not_followed(files, root, tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (root / "scan").symlink_to(victim)
    for use in (files.to_read, files.to_write):
        with pytest.raises(FileAccessError, match="not below"):
            use("scan")


@pytest.mark.parametrize("kind", ["fifo", "folder"])
def test_what_is_no_regular_file_is_refused(files, root, kind):
    os.mkfifo(root / "it") if kind == "fifo" else (root / "it").mkdir()
    for use in (files.to_read, files.to_write):
        with pytest.raises(FileAccessError, match="it is"):
            use("it")


def test_nothing_is_written_where_that_is_turned_off(root):
    files = FileAccess(FileSettings(root=str(root), allow_write=False))
    with pytest.raises(FileAccessError, match=r"files\.allow_write"):
        files.to_write("scan")
    (root / "scan").write_text("scan")
    assert files.to_read("scan") == root / "scan"


def test_the_default_root_is_the_nodes_own_and_made_at_the_first_write(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    files = FileAccess(FileSettings(), "left_arm")
    assert files.root == tmp_path / "reflest" / "left_arm"
    assert not files.root.exists()
    assert files.to_write("scan") == files.root / "scan"
    assert files.root.stat().st_mode & 0o777 == 0o700


def test_a_root_that_cannot_be_is_one_sentence():
    with pytest.raises(FileAccessError, match=r"files\.root"):
        FileAccess(FileSettings(root="~nosuchuser/x"))


def test_a_folder_that_does_not_exist_is_named_before_any_work(files, root):
    with pytest.raises(OutputError, match=r"the folder .*nosuch does not exist"):
        files.to_write("nosuch/scan")
