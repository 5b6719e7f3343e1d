# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Checks what a scan file holds before a compiled kernel sees it.

A scan file may come from anywhere. The kernels index with what it holds and trust its numbers, so
every value is checked here: types and ranges of the header, ranges and finiteness of the arrays.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.pose import FURTHEST
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.parameter import ParameterError
from reflest_core.ply_file import printable
from reflest_core.surface.voxel_key import VOXEL_LIMIT, key_coordinates

Arrays = Mapping[str, NDArray[Any]]

MOST_FRAMES = 2**30
"""Half of what the kernels count to, so that a scan can go on for a year."""
MOST_ORDER = 2**62
LONGEST_NAME = 1024
"""Characters of a frame's name."""
GREATEST_GAIN = 2.0**20
FARTHEST_FROM_SAMPLE = 4.0
"""Voxels between a surface point and the sample point of its voxel."""
GREATEST_TSDF = 16.0
"""Distances are cut off in front of the surface, and only about behind it."""
GREATEST_COLOUR = 255.01
"""With room for rounding."""
UNIT_TOLERANCE = 1e-3
"""By which the length of a normal may differ from 1."""


@dataclasses.dataclass(frozen=True)
class ScanHeader:
    """The checked header of a scan file.

    Attributes:
        fusion: Settings of the scan.
        region: Its region of interest.
        origin: Of its coordinates in the world frame, metres.
        frame_number: Frames that it took in.
        unchecked_until: Number of the last one before a jump of the tracker; -1 without one.
        last_stamp_ns: Stamp of the last one, None where there is none.
        frame_id: The camera's frame.
        world_frame_id: The world frame.
        exposure_gain: Of the last frame.
        work_sphere: As stored, None in older files.
        middle: Surface point in the middle of the last view, world frame, metres; None where there
            is none and in older files.
    """

    fusion: FusionSettings
    region: RegionSettings
    origin: tuple[float, float, float]
    frame_number: int
    unchecked_until: int
    last_stamp_ns: int | None
    frame_id: str
    world_frame_id: str
    exposure_gain: float
    work_sphere: Any
    middle: tuple[float, float, float] | None


def checked_header(header: Mapping[str, Any]) -> ScanHeader:
    """Check the header of a scan file.

    Args:
        header: Parsed JSON.

    Returns:
        The header with its types.

    Raises:
        ValueError: A value is missing, of another type or out of range.
    """
    try:
        region = header["region"]
        stamp_ns = header["last_stamp_ns"]
        return ScanHeader(
            FusionSettings(**_typed(FusionSettings(), header["fusion"])),
            RegionSettings(
                _of_type(region["shape"], str), _vector(region["centre"]), _vector(region["size"])
            ),
            _place(header.get("origin", [0.0, 0.0, 0.0])),
            _integer(header["frame_number"], 0, MOST_FRAMES),
            _integer(header.get("unchecked_until", -1), -1, MOST_FRAMES),
            None if stamp_ns is None else _integer(stamp_ns, -(2**63), 2**63 - 1),
            _name(header.get("frame_id", "")),
            _name(header.get("world_frame_id", "")),
            _gain(header["exposure_gain"]),
            header.get("work_sphere"),
            None if header.get("middle") is None else _place(header["middle"]),
        )
    except KeyError as error:
        raise ValueError(f"its header has no {error}") from None
    except (TypeError, AttributeError, ParameterError) as error:
        raise ValueError(f"its header cannot be used: {error}") from None


def check_arrays(
    arrays: Arrays, fusion: FusionSettings, frame_number: int, most_voxels: int
) -> None:
    """Check the numbers of a scan file; types and shapes are checked when they are copied.

    Args:
        arrays: Of the newest version.
        fusion: Settings of the scan.
        frame_number: Frames that it took in.
        most_voxels: For which there is room.

    Raises:
        ValueError: A value is missing, not finite or out of range.
    """
    try:
        _check_volume(arrays, frame_number)
        _check_voxels(arrays, fusion.voxel_size, frame_number)
        _check_views(arrays, VOXEL_LIMIT * fusion.voxel_size)
        _check_light(arrays)
        _check_materials(arrays, most_voxels)
    except KeyError as error:
        raise ValueError(f"array {error} is missing") from None


def _check_volume(arrays: Arrays, frame_number: int) -> None:
    _within("volume_tsdf", arrays, -GREATEST_TSDF, GREATEST_TSDF)
    _within("volume_last_seen", arrays, 0, frame_number)
    _coordinates(arrays["volume_keys"], "volume_keys")


def _check_voxels(arrays: Arrays, voxel_size: float, frame_number: int) -> None:
    _within("store_last_seen", arrays, 0, frame_number)
    lengths = np.linalg.norm(arrays["store_normals"].astype(np.float64), axis=-1)
    if not np.all(np.abs(lengths - 1.0) <= UNIT_TOLERANCE):
        raise ValueError("store_normals holds a vector that is not of unit length")
    positions = arrays["store_positions"]
    cells = _coordinates(arrays["store_keys"], "store_keys")
    if positions.shape != cells.shape:
        raise ValueError("store_positions does not fit store_keys")
    away = np.abs(positions / voxel_size - cells)
    if not np.all(away <= FARTHEST_FROM_SAMPLE):
        raise ValueError("store_positions are not at the voxels of store_keys")
    if len(arrays["store_counts"]) != len(cells):
        raise ValueError("store_counts does not fit store_keys")


def _check_views(arrays: Arrays, reach: float) -> None:
    """Cameras lie no farther than ``reach``, metres, from the scan's origin along any axis."""
    _within("views_gains", arrays, 1.0 / GREATEST_GAIN, GREATEST_GAIN)
    _within("views_order", arrays, -1, MOST_ORDER)
    _within("views_frames", arrays, 0, MOST_FRAMES)
    order = arrays["views_order"]
    stored = order >= 0
    centres = arrays["views_centres"]
    if centres.shape[:1] != order.shape or not np.all(np.abs(centres[stored]) <= reach):
        raise ValueError(f"views_centres holds a value outside [{-reach:g}, {reach:g}]")
    held = arrays["chunks_view_ids"]
    if held.size and int(held.max()) >= max(len(order), 1):
        raise ValueError("chunks_view_ids names a view that does not exist")
    for name in ("views_foreground", "views_background"):
        values = arrays[name]
        if not np.all(np.isnan(values) | ((values >= 0.0) & (values <= GREATEST_COLOUR))):
            raise ValueError(f"{name} is out of its range")


def _check_light(arrays: Arrays) -> None:
    for name in arrays:
        if name.startswith("light_"):
            _within(name, arrays, 0.0, 1e12)


def _check_materials(arrays: Arrays, most_voxels: int) -> None:
    """A file from before there were materials has no array of them."""
    keys = arrays.get("material_keys", np.zeros(0, np.int64))
    if len(keys) > most_voxels:
        raise ValueError("material_keys are more than there is room for voxels")
    _coordinates(keys, "material_keys")


def _within(name: str, arrays: Arrays, least: float, most: float) -> None:
    values = arrays[name]
    if values.dtype.kind not in "fiub" or not np.all((values >= least) & (values <= most)):
        raise ValueError(f"{name} holds a value outside [{least:g}, {most:g}]")


def _coordinates(keys: NDArray[Any], name: str) -> NDArray[np.int64]:
    """(N, 3) coordinates of keys, checked to be within the volume's limit."""
    if keys.dtype != np.int64 or keys.ndim != 1 or not np.all(keys > 0):
        raise ValueError(f"{name} holds what is no key")
    cells = key_coordinates(keys)
    if not np.all(np.abs(cells) <= VOXEL_LIMIT):
        raise ValueError(f"{name} holds a key beyond the volume's limit")
    return cells


def _typed(defaults: Any, given: Any) -> dict[str, Any]:
    """The fields of a settings dataclass, each of its default's type."""
    known = {field.name: getattr(defaults, field.name) for field in dataclasses.fields(defaults)}
    values = {}
    for name, value in _of_type(given, dict).items():
        if name not in known:
            raise ValueError(f"{name[:40]} is no setting of a scan")
        kind = type(known[name])
        values[name] = float(value) if kind is float and type(value) is int else value
        if type(values[name]) is not kind:
            raise ValueError(f"{name} = {value!r:.40} is not a {kind.__name__}")
    return values


def _of_type(value: Any, kind: type) -> Any:
    if type(value) is not kind:
        raise ValueError(f"{value!r:.40} is not a {kind.__name__}")
    return value


def _vector(value: Any) -> tuple[float, float, float]:
    x, y, z = (float(one) for one in _of_type(value, list))
    if not all(map(math.isfinite, (x, y, z))):
        raise ValueError(f"{value!r:.40} is not finite")
    return (x, y, z)


def _place(value: Any) -> tuple[float, float, float]:
    place = _vector(value)
    if max(map(abs, place)) > FURTHEST:
        raise ValueError(f"{value!r:.40} is too far away")
    return place


def _integer(value: Any, least: int, most: int) -> int:
    if not least <= _of_type(value, int) <= most:
        raise ValueError(f"{str(value)[:40]} is out of its range")
    return int(value)


def _name(value: Any) -> str:
    if len(_of_type(value, str)) > LONGEST_NAME:
        raise ValueError("a frame's name is too long")
    if not value.isprintable():
        raise ValueError("a frame's name holds a control character")
    return str(value)


def storable_name(name: str) -> str:
    """Make a frame's name one that a scan file may hold.

    Args:
        name: As it came with a frame.

    Returns:
        The name, cut off where it is too long, with a question mark for what cannot be printed.
    """
    return printable(name[:LONGEST_NAME])


def _gain(value: Any) -> float:
    gain = float(value)
    if not 1.0 / GREATEST_GAIN <= gain <= GREATEST_GAIN:
        raise ValueError(f"exposure_gain = {gain} is out of its range")
    return gain
