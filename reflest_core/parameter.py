# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Tunable parameters as data: default, meaning, unit and range in one place.

A stage describes its tuning as a frozen dataclass of :func:`parameter` fields. The node declares
its ROS parameters from it, the CLI reads YAML into it, config/estimator.yaml is printed from it.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any, cast

from reflest_core.errors import ReflestError


class ParameterError(ReflestError):
    """A parameter's value lies outside its range or is not one of its choices."""


@dataclasses.dataclass(frozen=True)
class ParameterInfo:
    """What a user must know to set a parameter.

    Attributes:
        description: One or two sentences.
        unit: "" where there is none.
        minimum: Smallest value allowed, inclusive; None without a limit.
        maximum: Largest value allowed, inclusive; None without a limit.
        choices: The values allowed; empty for any.
    """

    description: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()

    def check(self, name: str, value: object) -> None:
        """Check a value.

        Args:
            name: The parameter's name, for the message.
            value: A value of the parameter's type.

        Raises:
            ParameterError: Naming the parameter, its value and its range.
        """
        if self.choices and value not in self.choices:
            raise ParameterError(f"{name} = {value!r} is not one of {', '.join(self.choices)}")
        for number in value if isinstance(value, (list, tuple)) else (value,):
            if isinstance(number, bool) or not isinstance(number, (int, float)):
                continue
            unit = f" {self.unit}" if self.unit else ""
            limits = f"[{_limit(self.minimum, '-inf')}, {_limit(self.maximum, 'inf')}]{unit}"
            if math.isnan(number):
                is_bounded = self.minimum is not None or self.maximum is not None
                wanted = f"a value within {limits}" if is_bounded else "a number"
                raise ParameterError(f"{name} = nan is not a number: give {wanted}")
            below = self.minimum is not None and number < self.minimum
            above = self.maximum is not None and number > self.maximum
            if below or above:
                raise ParameterError(f"{name} = {number}{unit} is outside {limits}")


def _limit(value: float | None, without: str) -> str:
    return without if value is None else str(value)


def parameter(default: Any, description: str, **info: Any) -> Any:
    """Declare a field of a settings dataclass.

    Args:
        default: Its default value (tuples for vectors).
        description: One or two sentences.
        **info: Further fields of :class:`ParameterInfo`.

    Returns:
        A dataclass field with its :class:`ParameterInfo` attached.
    """
    metadata = {"parameter": ParameterInfo(description, **info)}
    return dataclasses.field(default=default, metadata=metadata)


def info_of(field: dataclasses.Field[Any]) -> ParameterInfo:
    """Return what :func:`parameter` attached to a field.

    Args:
        field: A field of a settings dataclass.

    Returns:
        Its description, unit and range.
    """
    return cast(ParameterInfo, field.metadata["parameter"])


def check_parameters(settings: Any) -> None:
    """Check every field of a settings dataclass; call it from ``__post_init__``.

    Args:
        settings: The dataclass.

    Raises:
        ParameterError: A value is outside its range or not one of its choices.
    """
    for field in dataclasses.fields(settings):
        info_of(field).check(field.name, getattr(settings, field.name))
