# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where a page gets its scan from, and what it may ask for: a capture, a saved scan or a node."""

from __future__ import annotations

import tempfile
import zipfile
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.errors import ReflestError
from reflest_core.estimation.material_map import MaterialMap

if TYPE_CHECKING:
    from reflest_core.estimation.pipeline import Pipeline
    from reflest_core.viewer.shown_scan import ShownScan

THUMBNAIL = 160
"""Pixels of a keyframe's picture, along its longer edge."""
FORMATS = {
    "glb": ".glb",
    "usd": ".usdz",
    "gltf": ".gltf",
    "obj": ".obj",
    "ply": ".ply",
    "sdf": ".sdf",
    "mitsuba-stock": ".xml",
    "hdr": ".hdr",
    "exr": ".exr",
}
"""Formats that the page offers, with the suffixes of their files."""


class ViewerError(ReflestError):
    """The viewer cannot do what was asked for; the sentence says why."""


@dataclass(frozen=True)
class Keyframe:
    """A camera on its path.

    Attributes:
        stamp_ns: stamp of its image.
        T_world_camera: (4, 4) pose of the optical frame.
        fov: vertical field of view, radians.
        aspect: width over height.
        picture: (h, w, 3) uint8 sRGB, small.
        found: the materials as they were then; None where nothing was estimated.
    """

    stamp_ns: int
    T_world_camera: NDArray[np.float64]
    fov: float
    aspect: float
    picture: NDArray[np.uint8]
    found: MaterialMap | None = None

    @staticmethod
    def of(frame: Frame, found: MaterialMap | None) -> Keyframe:
        """Keep what the page shows of a frame.

        Args:
            frame: that was fused, in the scan's coordinates.
            found: the materials after it.
        """
        height, width = frame.rgb.shape[:2]
        scale = THUMBNAIL / max(height, width)
        size = (max(round(width * scale), 1), max(round(height * scale), 1))
        return Keyframe(
            frame.stamp_ns,
            frame.T_world_camera,
            2.0 * float(np.arctan(height / 2.0 / frame.intrinsics.fy)),
            width / height,
            np.asarray(cv2.resize(frame.rgb, size, interpolation=cv2.INTER_AREA), np.uint8),
            found,
        )


@dataclass(frozen=True)
class SourceState:
    """What there is to show; replaced as a whole.

    Attributes:
        scan: the surface with its materials; None before the first estimate.
        keyframes: the camera's path, in time.
        progress: a sentence.
        share: of the work that is done, in [0, 1].
        is_working: whether more will come without being asked for.
    """

    scan: ShownScan | None = None
    keyframes: tuple[Keyframe, ...] = ()
    progress: str = ""
    share: float = 0.0
    is_working: bool = False


@dataclass(frozen=True)
class Outcome:
    """What was done on a request.

    Attributes:
        message: a sentence for the person who asked.
        files: contents by name, for the browser to save; empty where the files lie elsewhere.
    """

    message: str
    files: dict[str, bytes] = field(default_factory=dict)


class ScanSource(Protocol):
    """A scan that may change. Every method may be called from any thread.

    All but :meth:`state` and :meth:`close` raise :class:`.ReflestError` where the request cannot
    be met; the sentence says why.
    """

    @property
    def name(self) -> str:
        """What the page is headed with."""
        ...

    @property
    def up(self) -> tuple[float, float, float]:
        """Direction that points up in the world frame."""
        ...

    @property
    def can_rescan(self) -> bool:
        """Whether :meth:`set_region` and :meth:`reset` can be asked for."""
        ...

    def state(self) -> SourceState:
        """What there is to show now; another object only where it has changed."""
        ...

    def set_region(self, centre: tuple[float, float, float], radius: float) -> Outcome:
        """Scan a sphere instead.

        Args:
            centre: world frame, metres.
            radius: metres.
        """
        ...

    def reset(self) -> Outcome:
        """Begin again."""
        ...

    def save(self) -> Outcome:
        """Save the scan."""
        ...

    def export(self, format_name: str) -> Outcome:
        """Write the surface with its materials, or the light.

        Args:
            format_name: a key of :data:`FORMATS`.
        """
        ...

    def close(self) -> None:
        """End all work."""
        ...


def saved_files(scanner: Pipeline, name: str) -> Outcome:
    """The scan file, for the browser to save.

    Args:
        scanner: its scan is saved.
        name: of the file, without suffix.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.npz"
        scanner.save(path)
        content = path.read_bytes()
    return Outcome(
        f"saved {name}.npz: reflest view {name}.npz opens it again", {path.name: content}
    )


def exported_files(scanner: Pipeline, found: MaterialMap, name: str, format_name: str) -> Outcome:
    """The exported surface, for the browser to save; several files come in one archive.

    Args:
        scanner: holds the scan.
        found: its materials.
        name: of the file, without suffix.
        format_name: a key of :data:`FORMATS`.

    Raises:
        ExportError: There is nothing to export, or a package is missing.
    """
    from reflest_core.export.environment_file import LIGHT_FORMATS, export_environment
    from reflest_core.export.exporter import export_scan
    from reflest_core.export.scan_asset import AssetSettings

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}{FORMATS[format_name]}"
        warning = ""
        if format_name in LIGHT_FORMATS:
            export_environment(scanner.snapshot().surface, format_name, path)
        else:
            # A browser saves one file as it is, several in an archive; the page offers the light.
            with_light = format_name not in ("glb", "gltf")
            settings = AssetSettings(up=scanner.settings.estimation.up, with_light=with_light)
            warning = export_scan(scanner.scan, found, path, format_name, settings).warning
        contents = {
            str(one.relative_to(folder)): one.read_bytes()
            for one in sorted(Path(folder).rglob("*"))
            if one.is_file()
        }
    if len(contents) > 1:
        contents = {f"{name}-{format_name}.zip": _archive(contents)}
    saved = ", ".join(contents)
    return Outcome(f"exported {saved}{f'; {warning}' if warning else ''}", contents)


def _archive(contents: dict[str, bytes]) -> bytes:
    packed = BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    return packed.getvalue()
