# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Files that commands write: checked before anything is read, written whole or not at all."""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from reflest_core.whole_file import OutputError, write_whole

RECORDING_SUFFIXES = frozenset((".mcap", ".db3"))
RECORDING_INDEX = "metadata.yaml"


def check_overwriting(outputs: Mapping[str, Path], inputs: Iterable[Path]) -> None:
    """Refuse to write over what is read, over a recording, or twice into one file.

    Args:
        outputs: files to write, by option.
        inputs: files and folders that are read, all of which exist.

    Raises:
        OutputError: Two of these are one file, by name or by link; the sentence names the option.
    """
    for (option, path), (other_option, other) in itertools.combinations(outputs.items(), 2):
        if _is_one_file(path, other):
            raise OutputError(
                f"{option} and {other_option} both name {path}: give each a file of its own"
            )
    existing = {option: path for option, path in outputs.items() if os.path.exists(path)}
    for option, path in existing.items():
        if _is_recording(path):
            raise OutputError(
                f"{option} {path} is a recording and would be overwritten: name another file"
            )
    for source in inputs if existing else ():
        for file in _files_of(source):
            for option, path in existing.items():
                if _is_one_file(path, file):
                    raise OutputError(
                        f"{option} {path} would overwrite {file}, which this command reads: name "
                        "another file"
                    )


def _is_recording(path: Path) -> bool:
    return any(
        one.name == RECORDING_INDEX or not RECORDING_SUFFIXES.isdisjoint(one.suffixes)
        for one in (path, Path(os.path.realpath(path)))
    )


def _is_one_file(path: Path, other: Path) -> bool:
    if os.path.exists(path) and os.path.exists(other):
        return os.path.samefile(path, other)
    return os.path.realpath(path) == os.path.realpath(other)


def _files_of(source: Path) -> Iterator[Path]:
    """A file itself; of a bag's folder its recordings, of any other folder all files."""
    if not source.is_dir():
        yield source
        return
    for folder, _, names in os.walk(source):
        files = [Path(folder) / name for name in names]
        recordings = [file for file in files if _is_recording(file)]
        yield from recordings or files
        if recordings:
            return


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write a record. NaN is not JSON: write null (None) for it.

    Args:
        path: the file.
        record: values that JSON has.

    Raises:
        OutputError: with the system's reason.
    """
    text = json.dumps(record, indent=2, allow_nan=False) + "\n"
    write_whole(path, text.encode("utf-8"))
