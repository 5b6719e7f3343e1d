# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Folders that appear whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from reflest_core.errors import ReflestError


class FolderUnwritable(ReflestError):
    """There is no room or no right to write."""


@contextmanager
def whole_folder(out: Path) -> Iterator[Path]:
    """Give a path, of the same name as ``out``, to make a folder at; it becomes ``out`` at the end.

    Args:
        out: folder to make.

    Raises:
        FolderUnwritable: naming ``out``, if anything in the block cannot be written.
    """
    workplace = out.with_name(f".{out.name}.partial")
    unfinished = workplace / out.name
    try:
        shutil.rmtree(workplace, ignore_errors=True)
        workplace.mkdir(parents=True)
        yield unfinished
        os.replace(unfinished, out)
    except OSError as error:
        raise FolderUnwritable(
            f"{out} cannot be written ({error.strerror or error}): make room or choose another "
            "--out, and run the same command again"
        ) from error
    finally:
        shutil.rmtree(workplace, ignore_errors=True)
