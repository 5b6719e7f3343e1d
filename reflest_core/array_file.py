# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Arrays from ``.npy`` and ``.npz`` files that anyone may have written.

Nothing is unpickled, and the size that an array declares is checked before memory is taken for it.
"""

from __future__ import annotations

import contextlib
import math
import tokenize
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

MOST_BYTES = 1 << 30
"""Of one array."""
MOST_MEMBERS = 100_000
DAMAGE = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    RuntimeError,  # encrypted; NotImplementedError and RecursionError too
    SyntaxError,
    tokenize.TokenError,
    MemoryError,
)
"""What zipfile and NumPy raise at damaged files, beside ValueError and KeyError."""


def array_names(path: Path) -> list[str]:
    """List the arrays of an ``.npz`` collection, sorted.

    Args:
        path: The file.

    Raises:
        OSError: The file cannot be opened.
        ValueError: It is no collection; a clause that says why.
    """
    with _archive(path) as archive:
        names = archive.namelist()
    if len(names) > MOST_MEMBERS:
        raise ValueError(f"it lists more than {MOST_MEMBERS} arrays")
    return sorted(name.removesuffix(".npy") for name in names if name.endswith(".npy"))


def read_member(path: Path, name: str) -> NDArray[Any]:
    """Read one array of an ``.npz`` collection.

    Args:
        path: The file.
        name: One of :func:`array_names`.

    Raises:
        OSError: The file cannot be opened.
        ValueError: There is no such array, it is damaged or too large; a clause that says why.
    """
    with _archive(path) as archive, archive.open(f"{name}.npy") as member:
        return _read(member)


def read_array(path: Path) -> NDArray[Any]:
    """Read an ``.npy`` file.

    Args:
        path: The file.

    Raises:
        OSError: The file cannot be opened.
        ValueError: It is no array, damaged or too large; a clause that says why.
    """
    with path.open("rb") as file, _damage_as_value_error():
        return _read(file)


@contextlib.contextmanager
def _archive(path: Path) -> Iterator[zipfile.ZipFile]:
    with path.open("rb") as file, _damage_as_value_error(), zipfile.ZipFile(file) as archive:
        yield archive


def _read(file: IO[bytes]) -> NDArray[Any]:
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        shape, is_fortran, dtype = np.lib.format.read_array_header_1_0(file)
    elif version == (2, 0):
        shape, is_fortran, dtype = np.lib.format.read_array_header_2_0(file)
    else:
        raise ValueError(f"its array has the unknown version {version}")
    if dtype.hasobject:
        raise ValueError("it holds Python objects, which are not read")
    size = math.prod(shape) * dtype.itemsize
    if any(length < 0 for length in shape) or size > MOST_BYTES:
        raise ValueError(f"it declares an array of {shape}, more than {MOST_BYTES >> 20} MB")
    content = file.read(size)
    if len(content) != size:
        raise ValueError("it ends before its array does")
    return np.frombuffer(content, dtype).reshape(shape, order="F" if is_fortran else "C")


@contextlib.contextmanager
def _damage_as_value_error() -> Iterator[None]:
    """Raise any of :data:`DAMAGE`, and what is missing, as a ValueError."""
    try:
        yield
    except DAMAGE as error:
        raise ValueError(f"{error!s:.200}" or "it is damaged") from error
    except KeyError as error:
        raise ValueError(f"it has no array {error!s:.80}") from error
