# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan in one file: an uncompressed .npz of plain arrays and a JSON header, without pickle."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.light.light_map import LightMap
from reflest_core.whole_file import whole_file

Arrays = dict[str, NDArray[Any]]

FORMAT = "reflest-scan"
VERSION = 4
OLDER = (2, 3)
"""Versions that are converted to the newest when they are read."""


class ScanFileError(ReflestError):
    """A scan file cannot be read."""


def write_scan(path: Path, header: dict[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write a scan file, whole or not at all.

    Args:
        path: The file to write.
        header: What JSON can hold of the scan.
        arrays: The scan's arrays by name.

    Raises:
        OutputError: The file cannot be written; ``path`` is as it was before.
    """
    text = json.dumps({"format": FORMAT, "version": VERSION, **header})
    with whole_file(path) as file:
        np.savez(file, allow_pickle=False, **{"header": np.array(text), **arrays})


def read_scan(path: Path) -> tuple[dict[str, Any], Arrays]:
    """Read a scan file of this or an older version.

    Args:
        path: The file.

    Returns:
        The header and the arrays by name, as the newest version has them.

    Raises:
        ScanFileError: The file is missing, damaged or of another version.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            header = json.loads(str(file["header"]))
            if header["format"] != FORMAT:
                raise KeyError("format")
            version = header["version"]
            if version not in (VERSION, *OLDER):
                raise ScanFileError(
                    f"{path} is a scan file of version {version}, but this reflest reads version "
                    f"{VERSION} and older: scan again or use the reflest that wrote it"
                )
            arrays = {name: file[name] for name in file.files if name != "header"}
            return _upgraded(header, arrays)
    except FileNotFoundError:
        raise ScanFileError(f"there is no scan file {path}: check the path") from None
    except (OSError, EOFError, zipfile.BadZipFile, ValueError, KeyError, TypeError, AttributeError):
        raise ScanFileError(
            f"{path} is not a scan that reflest saved, or it is damaged: save it again"
        ) from None


def restore_rows(prefix: str, targets: Mapping[str, NDArray[Any]], arrays: Arrays) -> int:
    """Copy stored arrays into the first rows of arrays at full capacity.

    Args:
        prefix: Names in ``arrays`` are this and a name of ``targets``.
        targets: The arrays to fill.
        arrays: The stored arrays, all of the same length.

    Returns:
        How many rows were filled.

    Raises:
        ValueError: An array is missing or does not fit.
    """
    counts = set()
    for name, target in targets.items():
        array = arrays.get(prefix + name)
        if (
            array is None
            or array.dtype != target.dtype
            or array.shape[1:] != target.shape[1:]
            or len(array) > len(target)
        ):
            raise ValueError(f"array {prefix + name} is missing or does not fit")
        target[: len(array)] = array
        counts.add(len(array))
    if len(counts) != 1:
        raise ValueError(f"arrays {prefix}* differ in length")
    return counts.pop()


def _upgraded(header: dict[str, Any], arrays: Arrays) -> tuple[dict[str, Any], Arrays]:
    """Header and arrays of the newest version; ``KeyError`` where the file is damaged.

    Version 3 did not store in which channel light was clipped: in all, then. Version 2 had one
    exposure only, and its first files no light.
    """
    if header["version"] == 2:
        empty = {f"light_{name}": array for name, array in LightMap().arrays.items()}
        arrays = empty | arrays
        arrays["light_white"] = (arrays["light_count"] > 0.0).astype(np.float32)
        arrays["views_gains"] = np.ones(len(arrays["views_stamps"]), np.float32)
        header = header | {"exposure_gain": 1.0}
    if header["version"] < 4 and arrays["light_clipped_count"].ndim == 2:
        of_any = arrays["light_clipped_count"][..., None]
        arrays = arrays | {"light_clipped_count": np.repeat(of_any, 3, axis=-1)}
    return header, arrays
