# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The core's estimate as ``reflest_ros/msg/BrdfEstimate``, and back."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from reflest_core.estimation.estimate import (
    SCHEMA_VERSION,
    BrdfEstimate,
    EstimateStatus,
    status_from_number,
)
from reflest_ros.inputs.core_messages import ns_to_stamp, stamp_to_ns
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage

HEADER_FIELDS = ("stamp_ns", "frame_id")


def estimate_to_message(estimate: BrdfEstimate) -> BrdfEstimateMessage:
    """Every field under its own name; stamp and frame_id in the header.

    Args:
        estimate: the keyframe's estimate.
    """
    message = BrdfEstimateMessage()
    message.header.stamp = ns_to_stamp(estimate.stamp_ns)
    message.header.frame_id = estimate.frame_id
    for field in dataclasses.fields(estimate):
        if field.name not in HEADER_FIELDS:
            setattr(message, field.name, _message_value(getattr(estimate, field.name)))
    return message


def unknown_message() -> BrdfEstimateMessage:
    """Return the message that stands for no estimate: values NaN, status unknown.

    Returns:
        A message with STATUS_UNKNOWN, so that nothing in it is mistaken for an estimate.
    """
    message = BrdfEstimateMessage(
        schema_version=SCHEMA_VERSION, status=BrdfEstimateMessage.STATUS_UNKNOWN
    )
    for field in dataclasses.fields(BrdfEstimate):
        if field.type == "Rgb":
            setattr(message, field.name, [math.nan] * 3)
        elif field.type == "float":
            setattr(message, field.name, math.nan)
    return message


def estimate_from_message(message: BrdfEstimateMessage) -> BrdfEstimate:
    """What :func:`estimate_to_message` was given.

    Args:
        message: as it was received.
    """
    values: dict[str, Any] = {
        "stamp_ns": stamp_to_ns(message.header.stamp),
        "frame_id": message.header.frame_id,
    }
    for field in dataclasses.fields(BrdfEstimate):
        if field.name not in HEADER_FIELDS:
            value = getattr(message, field.name)
            values[field.name] = tuple(value.tolist()) if hasattr(value, "tolist") else value
    values["status"] = status_from_number(values["status"], values["schema_version"])
    return BrdfEstimate(**values)


def _message_value(value: Any) -> Any:
    if isinstance(value, EstimateStatus):
        return int(value)
    return list(value) if isinstance(value, tuple) else value
