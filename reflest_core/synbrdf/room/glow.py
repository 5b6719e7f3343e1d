# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Surfaces that shine with the colours of a texture. Importing this module loads Mitsuba."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_runtime import load_mitsuba

mi: Any = load_mitsuba()
import drjit as dr  # noqa: E402  (Mitsuba's loader must choose the LLVM first)

PLUGIN = "reflest_glow"


class Glow(mi.Emitter):  # type: ignore[misc]
    """Emits ``radiance``, a texture, from the front of its shape, to all sides alike.

    Shadow rays aim at all of the shape alike. Mitsuba's own area light aims by the texture, with
    constants of it in the kernel, so that each room would compile kernels of its own.
    """

    def __init__(self, props: Any) -> None:
        """Read the emitter from the properties of a Mitsuba scene.

        Args:
            props: ``radiance``, a texture.
        """
        mi.Emitter.__init__(self, props)
        self.radiance = props["radiance"]
        self.m_flags = int(mi.EmitterFlags.Surface) | int(mi.EmitterFlags.SpatiallyVarying)

    def eval(self, si: Any, active: Any = True) -> Any:
        """Radiance towards ``si.wi``.

        Args:
            si: Mitsuba surface interaction.
            active: Mitsuba mask of lanes.
        """
        is_front = mi.Mask(active) & (si.wi.z > 0.0)
        return dr.select(is_front, self.radiance.eval(si, is_front), mi.Color3f(0.0))

    def sample_direction(self, it: Any, sample: Any, active: Any = True) -> tuple[Any, Any]:
        """Choose a place on the shape; return it, and its radiance / density over solid angle.

        Args:
            it: Mitsuba interaction.
            sample: uniform pairs.
            active: Mitsuba mask of lanes.
        """
        ds = self.get_shape().sample_direction(it, sample, active)
        is_lit = mi.Mask(active) & (dr.dot(ds.d, ds.n) < 0.0) & (ds.pdf > 0.0)
        ds.emitter = mi.EmitterPtr(self)
        si = mi.SurfaceInteraction3f(ds, it.wavelengths)
        radiance = self.radiance.eval(si, is_lit)
        return ds, dr.select(is_lit, radiance / ds.pdf, mi.Color3f(0.0))

    def pdf_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
        """Density of :meth:`sample_direction` over solid angle.

        Args:
            it: Mitsuba interaction.
            ds: Mitsuba direction sample.
            active: Mitsuba mask of lanes.
        """
        is_lit = mi.Mask(active) & (dr.dot(ds.d, ds.n) < 0.0)
        return dr.select(is_lit, self.get_shape().pdf_direction(it, ds, is_lit), 0.0)

    def eval_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
        """Radiance from a place that :meth:`sample_direction` chose.

        Args:
            it: Mitsuba interaction.
            ds: Mitsuba direction sample.
            active: Mitsuba mask of lanes.
        """
        is_lit = mi.Mask(active) & (dr.dot(ds.d, ds.n) < 0.0)
        si = mi.SurfaceInteraction3f(ds, it.wavelengths)
        return dr.select(is_lit, self.radiance.eval(si, is_lit), mi.Color3f(0.0))

    def to_string(self) -> str:
        """Describe the plugin."""
        return "Glow[]"


mi.register_emitter(PLUGIN, Glow)


def glow(radiance: NDArray[np.float32], weight: float) -> Any:
    """Make an emitter.

    Args:
        radiance: (H, W, 3) linear sRGB.
        weight: of the emitter, where shadow rays choose one.
    """
    return mi.load_dict({"type": PLUGIN, "radiance": texture(radiance), "sampling_weight": weight})


def texture(image: NDArray[np.float32]) -> dict[str, Any]:
    """Linear values (H, W, 3) as they are; row 0 lies at v = 0.

    Args:
        image: (H, W, 3) pixels.
    """
    return {"type": "bitmap", "bitmap": mi.Bitmap(image), "raw": True, "wrap_mode": "clamp"}
