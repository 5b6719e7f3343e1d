# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light around the object as a file that renderers take for environment light."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from reflest_core.export.errors import ExportError, check_suffix
from reflest_core.light import rgbe
from reflest_core.whole_file import write_whole

if TYPE_CHECKING:
    from reflest_core.environment.environment_map import EnvironmentMap
    from reflest_core.surface.observed_surface import ObservedSurface

LIGHT_FORMATS = {"hdr": ".hdr", "exr": ".exr"}
"""Name of a format to the suffix of its files."""


def export_environment(surface: ObservedSurface, format_name: str, path: Path) -> None:
    """Write the light around a surface, completed, whole or not at all.

    Args:
        surface: The scan, world frame, z up.
        format_name: One of :data:`LIGHT_FORMATS`.
        path: The file to write.

    Raises:
        ExportError: A wrong suffix, or none of the light was seen.
        OutputError: The file cannot be written.
    """
    # The command line names the formats without waiting for compiled kernels.
    from reflest_core.environment.environment_map import environment_map

    check_suffix(path, LIGHT_FORMATS[format_name], format_name)
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
    write_whole(path, environment_bytes(environment_map(surface), format_name, note))


def environment_bytes(
    environment: EnvironmentMap, format_name: str, note: str = "reflest: environment light"
) -> bytes:
    """The content of a file.

    Args:
        environment: The light.
        format_name: One of :data:`LIGHT_FORMATS`.
        note: A comment of one line.
    """
    content = {"hdr": _radiance_hdr, "exr": _openexr}[format_name]
    return content(environment, note)


def light_format(path: Path) -> str:
    """The format of a file of that name.

    Args:
        path: The file.

    Raises:
        ExportError: Its suffix is none of a light.
    """
    for name, suffix in LIGHT_FORMATS.items():
        if path.suffix.lower() == suffix:
            return name
    suffixes = " or ".join(LIGHT_FORMATS.values())
    raise ExportError(f"{path} must end in {suffixes} to hold the light")


def _radiance_hdr(environment: EnvironmentMap, note: str) -> bytes:
    """Radiance's four bytes a pixel, without run lengths; coverage does not fit into it."""
    height, width = environment.radiance.shape[:2]
    header = (
        f"#?RADIANCE\n# {note}\nSOFTWARE=reflest\nFORMAT=32-bit_rle_rgbe\n"
        f"\n-Y {height} +X {width}\n"
    )
    return header.encode("ascii") + rgbe.encode(environment.radiance).tobytes()


def _openexr(environment: EnvironmentMap, note: str) -> bytes:
    """R, G, B are linear radiance, A is the coverage, 32-bit floats.

    The colours are whole everywhere, not premultiplied with A, so that light which was not seen
    shines as completed.
    """
    import OpenEXR

    channels = {
        name: OpenEXR.Channel(np.ascontiguousarray(environment.radiance[..., place], np.float32))
        for place, name in enumerate("RGB")
    }
    channels["A"] = OpenEXR.Channel(np.ascontiguousarray(environment.coverage, np.float32))
    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "comments": note,
        "envmap": OpenEXR.ENVMAP_LATLONG,
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "light.exr"
        OpenEXR.File(header, channels).write(str(path))
        return path.read_bytes()
