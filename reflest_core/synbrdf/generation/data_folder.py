# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A folder of a data set: its manifest says what it holds, and a resumed run must agree."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from reflest_core.synbrdf.scenes.scene_file import MANIFEST, SceneFileError
from reflest_core.whole_file import write_whole


def begin_manifest(folder: Path, manifest: dict[str, Any]) -> None:
    """Make a folder and its manifest, or check that what is there was begun alike.

    Args:
        folder: to write into.
        manifest: what the data set is and which code made it.

    Raises:
        SceneFileError: The folder cannot be made, is damaged, or differs.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SceneFileError(f"{folder} cannot be made: {error.strerror}") from error
    path = folder / MANIFEST
    if not path.exists():
        write_json(path, manifest)
        return
    found = _content(path)
    differing = sorted(key for key in manifest if found.get(key) != manifest[key])
    if differing:
        raise SceneFileError(
            f"{folder} was begun with another {', '.join(differing)}; use the same or another --out"
        )


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read what a data set is.

    Args:
        folder: of the data set.

    Raises:
        SceneFileError: There is no manifest, or it is damaged.
    """
    path = folder / MANIFEST
    if not path.is_file():
        raise SceneFileError(f"{folder} has no {MANIFEST}; make it with 'reflest synbrdf generate'")
    return _content(path)


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write whole or not at all, keys sorted.

    Args:
        path: the file.
        content: values that JSON has.
    """
    write_whole(path, (json.dumps(content, indent=1, sort_keys=True) + "\n").encode())


def _content(path: Path) -> dict[str, Any]:
    try:
        manifest = json.loads(path.read_text())
    except ValueError as error:
        raise SceneFileError(
            f"{path} is damaged ({error}); delete it and generate again"
        ) from error
    if not isinstance(manifest, dict):
        raise SceneFileError(f"{path} is damaged (no object of JSON); delete it and generate again")
    return manifest
