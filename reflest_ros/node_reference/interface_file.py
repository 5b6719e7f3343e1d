# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reads ``.msg`` and ``.srv`` files with their comments, which are their documentation."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

CONSTANT = re.compile(r"(?P<type>\S+)\s+(?P<name>[A-Z][A-Z0-9_]*)\s*=\s*(?P<value>.+)")
FIELD = re.compile(r"(?P<type>\S+)\s+(?P<name>[a-z][a-z0-9_]*)")


@dataclass(frozen=True)
class Field:
    """A field or a constant.

    Attributes:
        kind: Its type.
        name: Its name.
        value: Of a constant; "" for a field.
        comment: The lines above it.
    """

    kind: str
    name: str
    value: str
    comment: str


@dataclass(frozen=True)
class Section:
    """A message, a request or a response.

    Attributes:
        comment: What stands above the fields, a blank line between; without the copyright.
        fields: In their order.
    """

    comment: str
    fields: tuple[Field, ...]


def read_interface(path: Path) -> list[Section]:
    """Read an interface file.

    Args:
        path: A ``.msg`` or ``.srv`` file.

    Returns:
        One section of a ``.msg`` file, request and response of a ``.srv`` file.

    Raises:
        ValueError: A line is neither a comment, a constant nor a field.
    """
    parts = re.split(r"^---$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return [_section(part) for part in parts]


def _section(text: str) -> Section:
    heading: list[str] = []
    comment: list[str] = []
    fields: list[Field] = []
    for line in map(str.strip, text.strip().splitlines()):
        if line.startswith("#"):
            comment.append(line.removeprefix("#").strip())
        elif not line:
            if not fields and not " ".join(comment).startswith("Copyright"):
                heading += comment
            comment = []
        else:
            fields.append(_field(line, " ".join(comment)))
            comment = []
    # A section without fields is all heading.
    return Section(" ".join(heading if fields else heading + comment), tuple(fields))


def _field(line: str, comment: str) -> Field:
    match = CONSTANT.fullmatch(line) or FIELD.fullmatch(line)
    if match is None:
        raise ValueError(f"{line!r} is neither a constant nor a field")
    parts = match.groupdict()
    return Field(parts["type"], parts["name"], parts.get("value", ""), comment)
