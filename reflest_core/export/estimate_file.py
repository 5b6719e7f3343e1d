# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reads an estimate from the JSON that ``reflest replay --json`` writes."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

from reflest_core.estimation.estimate import (
    READABLE_VERSIONS,
    BrdfEstimate,
    status_from_number,
)
from reflest_core.export.errors import ExportError


def read_estimate(path: Path) -> BrdfEstimate:
    """The final estimate of a replay, or the estimate that is the whole file.

    Args:
        path: The JSON file.

    Raises:
        ExportError: The file cannot be read, is of another version or holds no estimate.
    """
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ExportError(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:
        raise ExportError(f"{path} is not JSON ({error})") from error
    if not isinstance(record, dict):
        raise ExportError(f"{path} holds no estimate: expected what `reflest replay --json` writes")
    version = record.get("schema_version")
    if version is None:
        raise ExportError(
            f"{path} has no schema_version, so it is not what `reflest replay --json` writes: "
            "check the path"
        )
    if version not in READABLE_VERSIONS:
        *older, newest = map(str, READABLE_VERSIONS)
        raise ExportError(
            f"{path} has schema_version {version!r}, and this reflest reads {', '.join(older)} and "
            f"{newest}: replay the capture again"
        )
    if "final" in record:
        if record["final"] is None:
            raise ExportError(f"{path} holds no final estimate: {record.get('no_estimate')}")
        record = record["final"]
    try:
        return estimate_from_record(record)
    except (KeyError, TypeError, ValueError) as error:
        raise ExportError(f"{path} holds a damaged estimate ({error!r})") from error


def estimate_from_record(record: dict[str, Any]) -> BrdfEstimate:
    """The estimate that :meth:`BrdfEstimate.to_json` was called on; null becomes NaN.

    Args:
        record: The JSON object.

    Raises:
        KeyError: A field is missing.
        TypeError: A field has a wrong type.
        ValueError: A field has a wrong value.
    """
    values: dict[str, Any] = {
        "stamp_ns": int(record["header"]["stamp_ns"]),
        "frame_id": str(record["header"]["frame_id"]),
    }
    for field in dataclasses.fields(BrdfEstimate):
        if field.name not in values:
            if field.name == "depth_agreement" and record["schema_version"] < 3:
                continue  # that version did not have it
            values[field.name] = _value(record[field.name], str(field.type))
    values["status"] = status_from_number(values["status"], values["schema_version"])
    return BrdfEstimate(**values)


def _value(value: Any, kind: str) -> Any:
    if kind == "Rgb":
        first, second, third = value
        return (_number(first), _number(second), _number(third))
    if kind == "float":
        return _number(value)
    return str(value) if kind == "str" else int(value)


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)
