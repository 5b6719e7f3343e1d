# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Measured figures as JSON files, each with the command, commit and data that it came from."""

from __future__ import annotations

import dataclasses
import json
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.synbrdf.scenes.scene_file import MANIFEST
from reflest_core.whole_file import write_whole

NUMBERS = re.compile(r"\[([-+.\deE,\s]+)\]")


@dataclass(frozen=True)
class Provenance:
    """How a record was made.

    Attributes:
        command: The command line, without folders of the machine.
        commit: The checkout's commit.
        data: The data set in words.
    """

    command: str
    commit: str
    data: str


def provenance_of(command: str, data: Path) -> Provenance:
    """The provenance of figures that this checkout measures.

    Args:
        command: The command line.
        data: Folder of the data set, or of captures.

    Raises:
        EvaluationError: the folder holds neither.
    """
    return Provenance(command, _commit(), _describe(data))


def write_record(path: Path, provenance: Provenance, figures: dict[str, Any]) -> None:
    """Write a record whole or not at all; a list of numbers stays on one line.

    Args:
        path: The JSON file.
        provenance: How the figures were made.
        figures: JSON values, NumPy arrays and data classes by name.
    """
    record = {"provenance": dataclasses.asdict(provenance), **figures}
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(record, indent=1, default=_plain)
    write_whole(path, (NUMBERS.sub(_on_one_line, text) + "\n").encode())


def read_record(path: Path) -> dict[str, Any] | None:
    """Read a record.

    Args:
        path: the file.

    Returns:
        The record, or None where there is no such file.

    Raises:
        EvaluationError: the file is not JSON.
    """
    if not path.exists():
        return None
    try:
        record: dict[str, Any] = json.loads(path.read_text())
    except ValueError as error:
        raise EvaluationError(f"{path} is damaged ({error}); delete it and run again") from error
    return record


def _on_one_line(numbers: re.Match[str]) -> str:
    return "[" + ", ".join(number.strip() for number in numbers[1].split(",")) + "]"


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    raise TypeError(f"{type(value).__name__} has no JSON form")


def _commit() -> str:
    """The checkout's commit, marked if files of the package differ from it."""
    here = str(Path(__file__).parents[1])

    def git(*arguments: str) -> str:
        command = ["git", "-C", here, *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()

    commit = git("rev-parse", "--short", "HEAD")
    if not commit:
        return "unknown (not a git checkout)"
    return commit + (" with changes" if git("status", "--porcelain", "--", here) else "")


def _describe(data: Path) -> str:
    path = data / MANIFEST
    captures = [*data.glob("metadata.yaml"), *data.glob("*/metadata.yaml")]
    if captures and not path.exists():
        return f"{len(captures)} captures" if len(captures) > 1 else "one capture"
    try:
        manifest = json.loads(path.read_text())
        environments, meshes = len(manifest["environments"]), len(manifest["meshes"])
        seed = manifest["seed"]
    except (OSError, ValueError, KeyError) as error:
        raise EvaluationError(f"{path} is not a data set's manifest ({error!r})") from error
    return f"SynBRDF seed {seed}, {environments} environments, {meshes} meshes"
