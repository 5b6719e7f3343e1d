# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate to a material file: the one entrance of this package."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.export.errors import ExportError
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


def export_estimate(estimate: BrdfEstimate, format_name: str, path: Path) -> None:
    """Write the material of ``estimate`` to ``path``, whole or not at all.

    Raises:
        ExportError: an unknown format, a wrong suffix, or an estimate without physical values.
        OutputError: the file cannot be written.
    """
    if format_name not in FORMATS:
        raise ExportError(f"{format_name!r} is no export format; known are {', '.join(FORMATS)}")
    suffix, content = FORMATS[format_name]
    if path.suffix.lower() != suffix:
        raise ExportError(f"{path} must end in {suffix} for the format {format_name}")
    write_whole(path, content(MaterialSource.from_estimate(estimate)))
