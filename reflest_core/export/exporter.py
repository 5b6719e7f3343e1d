# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes assets; the entrance of this package, which looks the format up."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from reflest_core.export.environment_file import LIGHT_FORMATS, light_format
from reflest_core.export.errors import ExportError
from reflest_core.export.libraries import library, open3d
from reflest_core.whole_file import write_whole

if TYPE_CHECKING:
    from reflest_core.estimation.estimate import BrdfEstimate
    from reflest_core.estimation.material_map import MaterialMap
    from reflest_core.export.asset import Asset
    from reflest_core.export.scan_asset import AssetSettings
    from reflest_core.fusion.scan import Scan


@dataclass(frozen=True)
class Format:
    """A file format.

    Attributes:
        suffixes: Of its files; the first is the usual one.
        writer: ``module:function`` below :mod:`reflest_core.export.formats`, which takes an asset
            and the file's name and returns the contents of all files, the main one first.
        has_light: Whether the environment can go with a file.
        libraries: Modules of the extra ``asset`` that the writer needs.
    """

    suffixes: tuple[str, ...]
    writer: str
    has_light: bool = False
    libraries: tuple[str, ...] = ("trimesh", "PIL")

    def files(self, asset: Asset, file_name: str) -> dict[str, bytes]:
        """The contents of the files, by name, the main one first.

        Args:
            asset: What to write.
            file_name: Of the main file.
        """
        module, function = self.writer.split(":")
        write: Callable[[Asset, str], dict[str, bytes]] = getattr(
            import_module(f"reflest_core.export.formats.{module}"), function
        )
        return write(asset, file_name)


FORMATS = {
    "glb": Format((".glb",), "gltf:glb", has_light=True),
    "gltf": Format((".gltf",), "gltf:gltf", has_light=True),
    "usd": Format((".usda", ".usdc", ".usdz", ".usd"), "usd:usd", True, ("pxr", "trimesh", "PIL")),
    "ply": Format((".ply",), "ply:ply", libraries=()),
    "obj": Format((".obj",), "obj:obj"),
    "mitsuba": Format((".xml",), "mitsuba:ward_scene", has_light=True),
    "mitsuba-stock": Format((".xml",), "mitsuba:stock_scene", has_light=True),
    "sdf": Format((".sdf",), "sdf:sdf"),
}
"""File formats by name; a new one is a module in ``formats`` and a line here."""


def export_scan(
    scan: Scan,
    found: MaterialMap,
    path: Path,
    format_name: str = "",
    settings: AssetSettings | None = None,
) -> Asset:
    """Write the scanned surface with its materials.

    Args:
        scan: What was fused.
        found: The materials of this scan.
        path: The file; others that it needs are written beside it, with its name.
        format_name: A key of :data:`FORMATS`; "" takes it from the suffix.
        settings: How the surface is written; None for the defaults.

    Returns:
        What was written, with its :attr:`~.Asset.warning`.

    Raises:
        ExportError: An unknown format, nothing to export, or a package that is missing.
        OutputError: A file cannot be written.
    """
    checked_format(path, format_name)
    # Open3D and the compiled kernels are imported for this alone.
    from reflest_core.export.scan_asset import scan_asset

    asset = scan_asset(scan, found, asset_name(path), settings)
    export_asset(asset, path, format_name)
    return asset


def export_estimate(
    estimate: BrdfEstimate, format_name: str, path: Path, light: Path | None = None
) -> Asset:
    """Write a 10 cm sphere of an estimate's material.

    Args:
        estimate: The material.
        format_name: A key of :data:`FORMATS`.
        path: The file.
        light: A file of :func:`.export_environment` that lights the scene in the file, or None.

    Returns:
        What was written.

    Raises:
        ExportError: An unknown format, a wrong suffix, an estimate without physical values, or
            ``light`` for a format that has none.
        OutputError: A file cannot be written.
    """
    checked_format(path, format_name)
    from reflest_core.export.asset import swatch

    if light is not None:
        check_lit(light, path, format_name)
    asset = swatch(estimate, _beside(path, light) if light else "")
    export_asset(asset, path, format_name)
    return asset


def export_asset(asset: Asset, path: Path, format_name: str = "") -> None:
    """Write an asset's files, each whole or not at all, the main one last.

    Args:
        asset: What to write.
        path: The main file.
        format_name: A key of :data:`FORMATS`; "" takes it from the suffix.

    Raises:
        ExportError: An unknown format, or a package that is missing.
        OutputError: A file cannot be written.
    """
    (main, *others) = checked_format(path, format_name).files(asset, path.name).items()
    for name, content in (*others, main):
        write_whole(path.with_name(name), content)


def checked_format(path: Path, format_name: str = "") -> Format:
    """The format of a file.

    Args:
        path: The file.
        format_name: A key of :data:`FORMATS`; "" takes it from the suffix.

    Raises:
        ExportError: There is no such format, or the suffix is not one of its.
    """
    if not format_name:
        for one in FORMATS.values():
            if path.suffix.lower() in one.suffixes:
                return one
        known = ", ".join(dict.fromkeys(s for one in FORMATS.values() for s in one.suffixes))
        raise ExportError(f"{path} ends in no known suffix; known are {known}")
    if format_name not in FORMATS:
        known = ", ".join([*FORMATS, *LIGHT_FORMATS])
        raise ExportError(f"{format_name!r} is no export format; known are {known}")
    chosen = FORMATS[format_name]
    if path.suffix.lower() not in chosen.suffixes:
        wanted = " or ".join(chosen.suffixes)
        raise ExportError(f"{path} must end in {wanted} for the format {format_name}")
    return chosen


def check_lit(light: Path, path: Path, format_name: str = "") -> None:
    """Find out before a long scan whether a file can hold a scene in this light.

    Args:
        light: The file of the light.
        path: The file of the scene.
        format_name: A key of :data:`FORMATS`; "" takes it from the suffix.

    Raises:
        ExportError: The format has no light, or the light is no such file.
    """
    light_format(light)
    if not checked_format(path, format_name).has_light:
        raise ExportError(f"{format_name} has no environment light: use glb, usd or mitsuba")
    if not light.is_file():
        raise ExportError(f"there is no environment file {light}: check the path")


def check_libraries(format_name: str) -> None:
    """Find out before a long scan whether a surface can be written.

    Args:
        format_name: A key of :data:`FORMATS`.

    Raises:
        ExportError: A package is missing; the sentence has the pip command.
    """
    open3d()
    for name in ("fast_simplification", "xatlas", *FORMATS[format_name].libraries):
        library(name)


def asset_name(path: Path) -> str:
    """A name for nodes and files from a file's: a letter, then letters, digits, underscores.

    Args:
        path: The file.
    """
    name = re.sub(r"[^A-Za-z0-9_]+", "_", path.stem)
    return name if name[:1].isalpha() else f"scan_{name}".rstrip("_")


def _beside(path: Path, light: Path) -> str:
    """``light`` as seen from the folder of ``path``: the two can be moved together."""
    return Path(os.path.relpath(light.resolve(), path.resolve().parent)).as_posix()
