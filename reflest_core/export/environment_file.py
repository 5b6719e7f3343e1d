# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light around the object to a file that renderers take as environment light."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from reflest_core.export.errors import ExportError, check_suffix
from reflest_core.export.openexr import openexr
from reflest_core.export.radiance_hdr import radiance_hdr
from reflest_core.whole_file import write_whole

if TYPE_CHECKING:
    from reflest_core.environment.environment_map import EnvironmentMap
    from reflest_core.surface.observed_surface import ObservedSurface

LIGHT_FORMATS: dict[str, tuple[str, Callable[[EnvironmentMap, str], bytes]]] = {
    "hdr": (".hdr", radiance_hdr),
    "exr": (".exr", openexr),
}
"""Name of a format to the suffix of its files and what makes their content."""


def export_environment(surface: ObservedSurface, format_name: str, path: Path) -> None:
    """Write the light around ``surface``, completed, to ``path``, whole or not at all.

    ``format_name``: one of :data:`LIGHT_FORMATS`.

    Raises:
        ExportError: a wrong suffix, or none of the light was seen.
        OutputError: the file cannot be written.
    """
    # The command line names the formats without waiting for compiled kernels.
    from reflest_core.environment.environment_map import environment_map

    suffix, content = LIGHT_FORMATS[format_name]
    check_suffix(path, suffix, format_name)
    light = surface.light
    if light is None or not light.seen_share > 0.0:
        raise ExportError(
            "no light around the object was seen: let the camera see past the object, and bound "
            "the object by a region of interest or a mask"
        )
    note = (
        f"reflest: light around the object; row 0 is +z, the middle +x, left of it +y of the world "
        f"frame; {light.seen_share:.0%} of all directions were seen, the others completed"
    )
    write_whole(path, content(environment_map(surface), note))


def light_format(path: Path) -> str:
    """The format of a file of that name; :class:`ExportError` where it is none of light."""
    for name, (suffix, _) in LIGHT_FORMATS.items():
        if path.suffix.lower() == suffix:
            return name
    suffixes = " or ".join(suffix for suffix, _ in LIGHT_FORMATS.values())
    raise ExportError(f"{path} must end in {suffixes} to hold the light")
