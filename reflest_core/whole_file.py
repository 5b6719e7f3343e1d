# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Files and folders that appear only when they are complete, by one writer for the package."""

from __future__ import annotations

import glob
import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from reflest_core.errors import ReflestError


class OutputError(ReflestError):
    """A result cannot be written where it was asked for."""


def check_writable(path: Path) -> None:
    """Find out before long work whether a file can be written.

    Args:
        path: The file.

    Raises:
        OutputError: Its folder does not exist or is read-only, it is no regular file, or its name
            is too long.
    """
    target = Path(os.path.realpath(path))
    folder = target.parent
    if not os.path.isdir(folder):
        raise OutputError(f"cannot write {path}: the folder {folder} does not exist")
    if os.path.isdir(path):
        raise OutputError(f"cannot write {path}: it is a folder; name a file")
    if os.path.exists(path) and not os.path.isfile(path):
        raise OutputError(f"cannot write {path}: it is no regular file; name a file")
    if not os.access(folder, os.W_OK):
        raise OutputError(f"cannot write {path}: the folder {folder} is read-only")
    if len(os.fsencode(_partial(target).name)) > os.pathconf(folder, "PC_NAME_MAX"):
        raise OutputError(f"cannot write {path}: its name is too long; choose a shorter one")


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """Open a file that replaces ``path`` when the block ends without an error.

    The content goes to a new file beside ``path``, reaches the disk, and is renamed: a reader finds
    the old file or the new one. A symbolic link stays and its target is replaced. Mode and owner of
    an existing file are kept. What a process that was killed left beside ``path`` is removed.

    Args:
        path: The file to write; its folder must exist.

    Yields:
        The open file, for writing bytes.

    Raises:
        OutputError: The file cannot be written; ``path`` is as it was before.
    """
    partial: Path | None = None
    try:
        target = Path(os.path.realpath(path))
        before = _status(target)
        _remove_abandoned(target)
        partial = _partial(target)
        with partial.open("xb") as file:
            if before is not None:
                _keep_mode_and_owner(file, before)
            yield file
            file.flush()
            os.fsync(file.fileno())
        partial.replace(target)
    except OSError as error:
        raise _output_error(path, error) from error
    finally:
        if partial is not None:
            partial.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write ``content`` to ``path``, whole or not at all (:func:`whole_file`).

    Args:
        path: The file to write; its folder must exist.
        content: All bytes of the file.

    Raises:
        OutputError: The file cannot be written; ``path`` is as it was before.
    """
    with whole_file(path) as file:
        file.write(content)


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Make a folder that appears at ``path`` when the block ends without an error.

    Args:
        path: The folder to make; folders above it are made too.

    Yields:
        A path of the same name to make the folder at.

    Raises:
        OutputError: Anything in the block cannot be written; nothing is left of it.
    """
    workplace = _partial(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _remove_abandoned(path)
        workplace.mkdir()
        yield workplace / path.name
        (workplace / path.name).replace(path)
    except OSError as error:
        raise _output_error(path, error) from error
    finally:
        shutil.rmtree(workplace, ignore_errors=True)


def _partial(target: Path) -> Path:
    return target.with_name(f".{target.name}.{os.getpid()}.{secrets.token_hex(4)}.partial")


def _output_error(path: Path, error: OSError) -> OutputError:
    return OutputError(
        f"cannot write {path}: {error.strerror or error}; make room or choose another place"
    )


def _status(target: Path) -> os.stat_result | None:
    """The status of an existing regular file, None where there is none yet."""
    try:
        status = target.stat()
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(status.st_mode):
        raise OSError("it is a folder")
    if not stat.S_ISREG(status.st_mode):
        raise OSError("it is not a regular file")
    return status


def _remove_abandoned(target: Path) -> None:
    """Remove unfinished files and folders of processes that are no more."""
    for partial in target.parent.glob(f".{glob.escape(target.name)}.*.partial"):
        process = partial.name.removeprefix(f".{target.name}.").split(".")[0]
        if process.isdigit() and not _is_running(int(process)):
            if partial.is_dir():
                shutil.rmtree(partial, ignore_errors=True)
            else:
                partial.unlink(missing_ok=True)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True


def _keep_mode_and_owner(file: BinaryIO, before: os.stat_result) -> None:
    here = os.fstat(file.fileno())
    if (here.st_uid, here.st_gid) != (before.st_uid, before.st_gid):
        os.fchown(file.fileno(), before.st_uid, before.st_gid)
    os.fchmod(file.fileno(), stat.S_IMODE(before.st_mode))
