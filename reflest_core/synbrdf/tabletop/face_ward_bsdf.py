# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The Ward BRDF with parameters that differ from face to face. Importing this loads Mitsuba."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_runtime import load_mitsuba
from reflest_core.synbrdf.path_tracing.ward_bsdf import WardBSDF, specular_share
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh

mi: Any = load_mitsuba()
import drjit as dr  # noqa: E402  (Mitsuba's loader must choose the LLVM first)

PLUGIN = "reflest_ward_faces"


class FaceWardBSDF(WardBSDF):
    """The Ward BRDF of one mesh; :meth:`set_faces` gives each of its faces a material.

    All of a scene is one mesh with one BSDF, so that scenes of any number of materials share the
    kernels.
    """

    def set_faces(self, painted: PaintedMesh) -> None:
        """Take the materials of the mesh that the BSDF is of.

        Args:
            painted: a mesh with a material for each face.
        """
        rho_d, rho_s = painted.rho_d.astype(np.float64), painted.rho_s.astype(np.float64)
        self.faces = [
            *(_table(rho_d[:, channel]) for channel in range(3)),
            _table(rho_s),
            _table(painted.alpha.astype(np.float64)),
            _table(specular_share(rho_d, rho_s)),
        ]

    def _material(self, si: Any) -> Any:
        values = [dr.gather(mi.Float, table, si.prim_index) for table in self.faces]
        return SimpleNamespace(
            rho_d=mi.Color3f(*values[:3]),
            rho_s=values[3],
            alpha=values[4],
            specular_share=values[5],
        )


def _table(values: NDArray[np.float64]) -> Any:
    return mi.Float(np.ascontiguousarray(values, np.float32))


mi.register_bsdf(PLUGIN, FaceWardBSDF)


def face_ward_bsdf(painted: PaintedMesh) -> FaceWardBSDF:
    """Make the plugin for the faces of a mesh.

    Args:
        painted: a mesh with a material for each face.
    """
    bsdf: FaceWardBSDF = mi.load_dict({"type": PLUGIN})
    bsdf.set_faces(painted)
    return bsdf
