# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan in one file: an uncompressed .npz of plain arrays and a JSON header, without pickle."""

from __future__ import annotations

import json
import math
import os
import stat
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.array_file import DAMAGE
from reflest_core.errors import ReflestError
from reflest_core.light.light_map import LightMap
from reflest_core.whole_file import whole_file

Arrays = dict[str, NDArray[Any]]

FORMAT = "reflest-scan"
VERSION = 4
OLDER = (2, 3)
"""Versions that are converted to the newest when they are read."""


MOST_MEMBERS = 64
MOST_HEADER_BYTES = 1 << 20
HEAD_BYTES = 1 << 16
"""Of a file in which its format is looked for."""


class ScanFileError(ReflestError):
    """A scan file cannot be read."""


class DamagedScanError(ScanFileError):
    """The file is a scan that reflest saved, and it is damaged."""


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


def read_scan(
    path: Path, check_size: Callable[[Path, int], None] | None = None
) -> tuple[dict[str, Any], Arrays]:
    """Read a scan file of this or an older version.

    Args:
        path: The file.
        check_size: Raises what it likes where a scan of so many bytes is too large to be read.

    Returns:
        The header and the arrays by name, as the newest version has them.

    Raises:
        DamagedScanError: The file is a scan and damaged.
        ScanFileError: The file is missing, cannot be read, is no scan or of another version.
    """
    try:
        is_ours = is_scan_file(path)
    except FileNotFoundError:
        raise ScanFileError(f"there is no scan file {path}: check the path") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ScanFileError(f"cannot read the scan file {path}: {reason}") from None
    if not is_ours:
        raise ScanFileError(f"{path} is not a scan that reflest saved: check the path")
    try:
        if check_size is not None:
            check_size(path, path.stat().st_size)
        header, arrays = _members(path)
        if header["format"] != FORMAT:
            raise ValueError("its format is another")
        version = header["version"]
        if type(version) is not int or version not in (VERSION, *OLDER):
            raise ScanFileError(
                f"{path} is a scan file of version {str(version)[:20]}, but this reflest reads "
                f"version {VERSION} and older: scan again or use the reflest that wrote it"
            )
        return _upgraded(header, arrays)
    except ScanFileError:
        raise
    except PermissionError as error:
        raise ScanFileError(f"cannot read the scan file {path}: {error.strerror}") from None
    except (
        *DAMAGE,
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        OverflowError,
    ) as error:
        raise damaged(path, error) from None


def damaged(path: Path, error: BaseException) -> DamagedScanError:
    """Describe a damaged scan file.

    Args:
        path: The file.
        error: What is wrong with it.

    Returns:
        The error to raise.
    """
    return DamagedScanError(f"{path} is a damaged scan file ({str(error)[:200]}): save it again")


def is_scan_file(path: Path) -> bool:
    """Return whether a file begins as saved scans do.

    Args:
        path: The file.

    Raises:
        OSError: It cannot be read.
        ValueError: It is not a regular file.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    with open(descriptor, "rb") as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise ValueError("it is not a regular file")
        head = file.read(HEAD_BYTES)
    return head.startswith(b"PK") and FORMAT.encode("utf-32-le") in head


def _members(path: Path) -> tuple[dict[str, Any], Arrays]:
    """Header and arrays of an archive whose declared sizes have been checked."""
    with path.open("rb") as file, zipfile.ZipFile(file) as archive:
        size = os.fstat(file.fileno()).st_size
        entries = archive.infolist()
        names = [entry.filename for entry in entries]
        if len(names) > MOST_MEMBERS or len(set(names)) != len(names):
            raise ValueError("its list of arrays cannot be right")
        for entry in entries:
            if entry.compress_type != zipfile.ZIP_STORED or entry.flag_bits & 1:
                raise ValueError(f"{entry.filename[:40]} is compressed or encrypted")
            if entry.file_size != entry.compress_size:
                raise ValueError(f"{entry.filename[:40]} declares two sizes")
        if sum(entry.file_size for entry in entries) > size:
            raise ValueError("its arrays are larger than the file")
        if archive.getinfo("header.npy").file_size > MOST_HEADER_BYTES:
            raise ValueError("its header is too long")
        arrays = {name.removesuffix(".npy"): _array(archive, name) for name in names}
    header = json.loads(str(arrays.pop("header")), parse_constant=_no_constant)
    if not isinstance(header, dict):
        raise ValueError("its header is no object")
    return header, arrays


def _array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """One array, of which the declared shape has been compared with the bytes that there are."""
    with archive.open(name) as member:
        version = np.lib.format.read_magic(member)
        if version != (1, 0):
            raise ValueError(f"{name[:40]} has an unknown version")
        shape, is_fortran, dtype = np.lib.format.read_array_header_1_0(member)
        if dtype.hasobject or dtype.kind not in "fiubU" or is_fortran:
            raise ValueError(f"{name[:40]} has the type {dtype}")
        content = member.read()
    if any(length < 0 for length in shape) or math.prod(shape) * dtype.itemsize != len(content):
        raise ValueError(f"{name[:40]} is not as large as it declares")
    return np.frombuffer(content, dtype).reshape(shape)


def _no_constant(text: str) -> float:
    raise ValueError(f"its header holds {text}")


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
