# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The settings that the options of a scanning command make."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path

from reflest_core.capture.settings import CaptureSettings
from reflest_core.cli.roi_pixel import sphere_at_pixel
from reflest_core.cli.scan_options import is_saved
from reflest_core.estimation.settings import ReflestSettings, with_values
from reflest_core.fusion.settings import RegionSettings
from reflest_core.parameter import ParameterError

OF_THE_MACHINE = ("memory_budget_mb", "threads")
"""Values of fusion that a saved scan takes from the command."""


def scan_settings(options: argparse.Namespace) -> ReflestSettings:
    """Return the settings of ``--config`` (or the defaults) with the options laid over them.

    Args:
        options: all options of the command.

    Raises:
        ParameterError: naming the parameter that is wrong.
    """
    config: Path | None = options.config
    settings = ReflestSettings.from_yaml(config, _warn) if config else ReflestSettings()
    fusion = {"voxel_size": options.voxel_size, "max_depth": options.max_depth}
    estimation = {
        "model": options.model,
        "weights": options.weights,
        "up": options.up,
        "known_light": options.known_light,
    }
    capture = _with_tf(settings.capture, options.world_frame)
    if not is_saved(options.capture):
        capture = _with_mask(capture, options.mask_topic)
    elif unused := _values_of_scanning(settings):
        _warn(
            f"{', '.join(unused)} in {config}: not used, for {options.capture} was scanned before "
            "and has its own"
        )
    return replace(
        settings,
        capture=capture,
        region=_region(options, capture) or settings.region,
        fusion=with_values(settings.fusion, _given(fusion), "fusion"),
        estimation=with_values(settings.estimation, _given(estimation), "estimation"),
    )


def _warn(sentence: str) -> None:
    print(f"reflest: warning: {sentence}", file=sys.stderr)


def _values_of_scanning(settings: ReflestSettings) -> list[str]:
    """Name the values unlike the defaults that say how a capture is read and scanned."""
    usual = ReflestSettings()
    return [
        f"{group}.{field.name}"
        for group in ("capture", "region", "fusion")
        for field in fields(getattr(usual, group))
        if field.name not in OF_THE_MACHINE
        and getattr(getattr(settings, group), field.name)
        != getattr(getattr(usual, group), field.name)
    ]


def _given(values: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in values.items() if value is not None}


def _with_tf(capture: CaptureSettings, world_frame: str | None) -> CaptureSettings:
    if world_frame is None:
        return capture
    return replace(capture, pose_source="tf", world_frame=world_frame)


def _with_mask(capture: CaptureSettings, mask_topic: str | None) -> CaptureSettings:
    if mask_topic is not None:
        return replace(capture, use_mask=True)
    if capture.use_mask:
        raise ParameterError("capture.use_mask is set: name the mask topic with --mask-topic")
    return capture


def _region(options: argparse.Namespace, capture: CaptureSettings) -> RegionSettings | None:
    if options.roi_pixel:
        return sphere_at_pixel(options, capture)
    if options.roi_box:
        return _box(options.roi_box)
    if options.roi_sphere:
        x, y, z, radius = options.roi_sphere
        with _naming("--roi-sphere"):
            return RegionSettings.sphere((x, y, z), radius)
    return None


def _box(corners: Sequence[float]) -> RegionSettings:
    """Return the box between two opposite corners, given in either order."""
    pairs = list(zip(corners[:3], corners[3:], strict=True))
    (x, y, z), (width, depth, height) = (
        [(low + high) / 2 for low, high in pairs],
        [abs(high - low) for low, high in pairs],
    )
    if not min(width, depth, height) > 0.0:
        raise ParameterError("--roi-box: its two corners must differ in x, y and z")
    with _naming("--roi-box"):
        return RegionSettings("box", (x, y, z), (width, depth, height))


@contextmanager
def _naming(option: str) -> Iterator[None]:
    """Name the option in a sentence on its value."""
    try:
        yield
    except ParameterError as error:
        raise ParameterError(f"{option}: {error}") from error
