# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimate against truth, parameter by parameter."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from reflest_core.estimation.estimate import BrdfEstimate


@dataclass(frozen=True)
class ComparedParameter:
    """One number of the BRDF beside its truth.

    Attributes:
        name: As it is printed.
        meaning: In words.
        truth: The true value.
        estimate: The estimated value.
        stddev: The estimate's standard deviation; NaN where it is not known.
    """

    name: str
    meaning: str
    truth: float
    estimate: float
    stddev: float

    @property
    def error(self) -> float:
        """Estimate minus truth."""
        return self.estimate - self.truth

    @property
    def deviation(self) -> str:
        """The estimate's standard deviation as text, empty where it is not known."""
        return "" if math.isnan(self.stddev) else f"±{self.stddev:.3f}"


NAMES = (
    ("rho_d", ("rho_d red", "rho_d green", "rho_d blue"), "diffuse albedo, linear sRGB"),
    ("rho_s", ("rho_s",), "specular albedo"),
    ("alpha", ("alpha",), "roughness"),
    ("lab", ("L*", "a*", "b*"), "CIE Lab of rho_d, D65"),
    ("c", ("c",), "contrast of the gloss"),
    ("d", ("d",), "distinctness of the gloss"),
)


def compare(estimate: BrdfEstimate, truth: dict[str, Any]) -> list[ComparedParameter]:
    """Every Ward and Lab/c,d value of the estimate beside its truth.

    Args:
        estimate: the keyframe's estimate.
        truth: the material's true values.
    """
    return [
        ComparedParameter(name, meaning, true_value, estimated, stddev)
        for field, names, meaning in NAMES
        for name, true_value, estimated, stddev in zip(
            names,
            _values(truth[field]),
            _values(getattr(estimate, field)),
            _values(getattr(estimate, f"{field}_stddev")),
            strict=True,
        )
    ]


def table(compared: list[ComparedParameter]) -> str:
    """The comparison as lines of text; ± stands before one standard deviation.

    Args:
        compared: parameters with truth and estimate.
    """
    lines = [f"  {'parameter':<12}{'truth':>9}{'estimate':>10}{'±':>9}{'error':>9}   meaning"]
    lines += [
        f"  {one.name:<12}{one.truth:>9.3f}{one.estimate:>10.3f}{one.deviation:>9}"
        f"{one.error:>+9.3f}   {one.meaning}"
        for one in compared
    ]
    return "\n".join(lines)


def _values(value: Any) -> tuple[float, ...]:
    return tuple(value) if isinstance(value, (list, tuple)) else (value,)
