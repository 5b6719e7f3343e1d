# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate to a material file: the one entrance of this package."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.export.environment_file import LIGHT_FORMATS, light_format
from reflest_core.export.errors import ExportError, check_suffix
from reflest_core.export.gltf import gltf_binary, gltf_json
from reflest_core.export.material_source import MaterialSource
from reflest_core.export.mitsuba import stock_scene, ward_scene
from reflest_core.export.usd import usd_text
from reflest_core.whole_file import write_whole

FORMATS: dict[str, tuple[str, Callable[[MaterialSource], bytes]]] = {
    "gltf": (".gltf", gltf_json),
    "glb": (".glb", gltf_binary),
    "usd": (".usda", usd_text),
    "mitsuba": (".xml", ward_scene),
    "mitsuba-stock": (".xml", stock_scene),
}
"""Name of a format to the suffix of its files and what makes their content."""


WITHOUT_LIGHT = ("gltf", "glb")
"""Formats that have no environment light."""


def export_estimate(
    estimate: BrdfEstimate, format_name: str, path: Path, light: Path | None = None
) -> None:
    """Write the material of ``estimate`` to ``path``, whole or not at all.

    ``light``: a file of :func:`.export_environment`, which shall light the scene in the file.

    Raises:
        ExportError: an unknown format, a wrong suffix, an estimate without physical values, or
            ``light`` for a format that has none.
        OutputError: the file cannot be written.
    """
    if format_name not in FORMATS:
        known = ", ".join([*FORMATS, *LIGHT_FORMATS])
        raise ExportError(f"{format_name!r} is no export format; known are {known}")
    suffix, content = FORMATS[format_name]
    check_suffix(path, suffix, format_name)
    if light is not None:
        light_format(light)
        if format_name in WITHOUT_LIGHT:
            raise ExportError(f"{format_name} has no environment light: use usd or mitsuba")
        if not light.is_file():
            raise ExportError(f"there is no environment file {light}: check the path")
    source = MaterialSource.from_estimate(estimate, _beside(path, light) if light else "")
    write_whole(path, content(source))


def _beside(path: Path, light: Path) -> str:
    """``light`` as seen from the folder of ``path``: the two can be moved together."""
    return Path(os.path.relpath(light.resolve(), path.resolve().parent)).as_posix()
