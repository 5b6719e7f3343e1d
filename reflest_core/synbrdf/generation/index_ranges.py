# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which scenes or views are meant: ``7``, ``0:10``, ``0:100:20`` and lists of these."""

from __future__ import annotations

from reflest_core.errors import ReflestError


class IndexRangeError(ReflestError):
    """A selection that names nothing."""


def parse_indices(text: str, count: int, what: str) -> list[int]:
    """Parse indices, in order, each once.

    Args:
        text: such as ``0:10,25``.
        count: indices below it are allowed.
        what: what is counted, for error messages.
    """
    chosen: set[int] = set()
    for part in text.split(","):
        try:
            numbers = [int(number) for number in part.split(":")]
            indices = range(*numbers) if len(numbers) > 1 else range(numbers[0], numbers[0] + 1)
        except (ValueError, TypeError) as error:
            raise IndexRangeError(
                f"--{what} does not understand {part!r}: give numbers, FIRST:END or "
                "FIRST:END:STEP, with commas between them"
            ) from error
        # Before it is listed: a range may name more than memory holds.
        if indices and not all(0 <= end < count for end in (indices[0], indices[-1])):
            raise _outside(text, count, what)
        chosen.update(indices)
    if not chosen:
        raise _outside(text, count, what)
    return sorted(chosen)


def _outside(text: str, count: int, what: str) -> IndexRangeError:
    return IndexRangeError(f"--{what} {text} must name some of 0 to {count - 1}")
