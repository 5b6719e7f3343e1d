# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One writer of files and folders: whole or not at all."""

import os
import stat

import pytest

from reflest_core.whole_file import (
    OutputError,
    check_writable,
    whole_file,
    whole_folder,
    write_whole,
)


def test_new_file_has_its_content_and_the_usual_mode(tmp_path):
    write_whole(tmp_path / "a", b"content")
    assert (tmp_path / "a").read_bytes() == b"content"
    (tmp_path / "usual").touch()
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "usual").stat().st_mode


def interrupted_write(path):
    with whole_file(path) as file:
        file.write(b"new")
        raise InterruptedError("interrupted")


def test_old_content_stays_and_nothing_is_left_beside_where_writing_fails(tmp_path):
    (tmp_path / "a").write_bytes(b"old")
    with pytest.raises(OutputError, match="interrupted"):
        interrupted_write(tmp_path / "a")
    assert (tmp_path / "a").read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a"]


def test_what_a_killed_process_left_is_removed_and_what_a_living_one_writes_is_not(tmp_path):
    dead, living = (tmp_path / f".a.{n}.0a1b2c3d.partial" for n in (2**22 + 1, os.getpid()))
    dead.touch()
    living.touch()
    write_whole(tmp_path / "a", b"new")
    assert sorted(os.listdir(tmp_path)) == sorted([living.name, "a"])


def test_mode_of_an_existing_file_is_kept(tmp_path):
    (tmp_path / "a").write_bytes(b"old")
    (tmp_path / "a").chmod(0o600)
    write_whole(tmp_path / "a", b"new")
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o600
    assert (tmp_path / "a").read_bytes() == b"new"


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    target = tmp_path / "elsewhere" / "target"
    target.write_bytes(b"old")
    (tmp_path / "link").symlink_to(target)
    write_whole(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert target.read_bytes() == b"new"


@pytest.mark.parametrize("folder", [".", "b" * 300])
def test_a_name_that_is_too_long_is_refused_before_any_work(tmp_path, folder):
    with pytest.raises(OutputError, match=r"too long|does not exist"):
        check_writable(tmp_path / folder / ("a" * 250))


@pytest.mark.parametrize("kind", ["missing folder", "folder", "pipe"])
def test_places_that_cannot_hold_a_file_are_refused_in_one_sentence(kind, tmp_path):
    path = tmp_path / "place"
    if kind == "missing folder":
        path = path / "a"
    elif kind == "folder":
        path.mkdir()
    else:
        os.mkfifo(path)
    with pytest.raises(OutputError, match=rf"cannot write {path}: .*; make room or choose"):
        write_whole(path, b"content")


def unfinished_folder(path):
    with whole_folder(path) as unfinished:
        unfinished.mkdir()
        (unfinished / "one").write_bytes(b"new")
        assert not path.exists()
        raise InterruptedError("interrupted")


def test_a_folder_appears_complete_or_not_at_all(tmp_path):
    folder = tmp_path / "above" / "a"
    with pytest.raises(OutputError, match=r"cannot write .*a: interrupted"):
        unfinished_folder(folder)
    assert os.listdir(folder.parent) == []
    with whole_folder(folder) as unfinished:
        assert unfinished.name == "a"
        unfinished.mkdir()
        (unfinished / "one").write_bytes(b"new")
    assert os.listdir(folder.parent) == ["a"]
    assert (folder / "one").read_bytes() == b"new"


def test_a_folder_that_a_killed_process_left_is_removed(tmp_path):
    (tmp_path / f".a.{2**22 + 1}.0a1b2c3d.partial" / "a").mkdir(parents=True)
    with whole_folder(tmp_path / "a") as unfinished:
        unfinished.mkdir()
    assert os.listdir(tmp_path) == ["a"]
