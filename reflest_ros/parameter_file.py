# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes ``config/estimator.yaml`` from the settings, so that the two cannot drift apart.

``python -m reflest_ros.parameter_file > config/estimator.yaml``
"""

from __future__ import annotations

import textwrap
from typing import Any

import yaml

from reflest_ros.parameters import all_parameters, describe

HEADER = """\
# Every parameter of the estimator with its default. Written by reflest_ros.parameter_file from the
# settings in the code; a test compares the two.
/**:
  ros__parameters:
"""


def parameter_file() -> str:
    """Write the base parameter file.

    Returns:
        Its text.
    """
    lines = [HEADER.rstrip("\n")]
    group = ""
    for parameter in all_parameters():
        its_group, name = parameter.name.split(".")
        if its_group != group:
            group = its_group
            lines.append(f"    {group}:")
        lines += textwrap.wrap(
            describe(parameter.info),
            100,
            initial_indent=" " * 6 + "# ",
            subsequent_indent=" " * 6 + "# ",
        )
        lines.append(f"      {name}: {_yaml_value(parameter.default)}")
    return "\n".join(lines) + "\n"


def _yaml_value(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    plain = list(value) if isinstance(value, tuple) else value
    return yaml.safe_dump(plain, default_flow_style=True).split("\n")[0]


if __name__ == "__main__":
    print(parameter_file(), end="")
