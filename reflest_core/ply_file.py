# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""PLY files, binary little-endian: points and faces as structured arrays (Turk 1994)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

TYPES = {
    "i1": "char",
    "u1": "uchar",
    "i2": "short",
    "u2": "ushort",
    "i4": "int",
    "u4": "uint",
    "f4": "float",
    "f8": "double",
}
"""PLY's names of NumPy's types."""
OTHER_NAMES = {
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
MOST_HEADER_BYTES = 1 << 16
VERTEX = re.compile(
    r"ply\r?\nformat binary_little_endian 1\.0\r?\n(?:(?:comment|obj_info)[^\n]*\n)*"
    r"element vertex (\d{1,12})\r?\n((?:(?:property \w+ \w+|comment[^\n]*)\r?\n)+)(?=element |\Z)"
)
"""The beginning of a header whose first element are vertices with single values."""


def write_ply(
    file: IO[bytes], elements: Mapping[str, NDArray[np.void]], comments: Sequence[str] = ()
) -> None:
    """Write elements one after another.

    Args:
        file: Open for writing.
        elements: By name; the fields of a record are its properties, one of shape (n,) is a list.
        comments: Lines of the header.
    """
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment {printable(line)}" for line in comments),
    ]
    contents = []
    for name, records in elements.items():
        lines.append(f"element {name} {len(records)}")
        stored: list[Any] = []
        for field, (dtype, *_) in (records.dtype.fields or {}).items():
            kind = dtype.base.str[1:]
            if dtype.shape:
                lines.append(f"property list uchar {TYPES[kind]} {field}")
                stored.append((f"{field} count", "u1"))
            else:
                lines.append(f"property {TYPES[kind]} {field}")
            stored.append((field, f"<{kind}", dtype.shape))
        packed = np.empty(len(records), stored)
        for field, (dtype, *_) in (records.dtype.fields or {}).items():
            packed[field] = records[field]
            if dtype.shape:
                packed[f"{field} count"] = dtype.shape[0]
        contents.append(packed)
    file.write("\n".join([*lines, "end_header", ""]).encode("ascii", "replace"))
    for packed in contents:
        file.write(packed.tobytes())


def printable(text: str) -> str:
    """Replace what would end a line or cannot be printed.

    Args:
        text: Any.

    Returns:
        One line, with a question mark for each such character.
    """
    return "".join(one if one.isprintable() else "?" for one in text)


def read_vertices(path: Path) -> NDArray[np.void]:
    """Read the vertices of a binary little-endian file.

    Args:
        path: The file.

    Returns:
        (N,) records; their fields are the properties.

    Raises:
        OSError: It cannot be opened.
        ValueError: It is no such file, or ends before its vertices do; a clause that says why.
    """
    with path.open("rb") as file:
        head = file.read(MOST_HEADER_BYTES)
        text, end, _ = head.partition(b"end_header\n")
        header = VERTEX.match(text.decode("ascii", "replace"))
        if header is None or not end:
            raise ValueError("it is no binary little-endian PLY file whose vertices come first")
        dtype = _dtype(header[2])
        size = int(header[1]) * dtype.itemsize
        file.seek(0, 2)
        if size > file.tell() - len(text) - len(end):
            raise ValueError("it ends before its vertices do")
        file.seek(len(text) + len(end))
        return np.frombuffer(file.read(size), dtype)


def _dtype(properties: str) -> np.dtype[Any]:
    types = {name: kind for kind, name in TYPES.items()} | OTHER_NAMES
    fields = []
    for line in properties.splitlines():
        words = line.split()
        if words[0] == "property":
            if words[1] not in types:
                raise ValueError(f"its property {words[2]} is of the type {words[1]}")
            fields.append((words[2], f"<{types[words[1]]}"))
    return np.dtype(fields)
