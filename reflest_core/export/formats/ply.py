# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""PLY: the surface with base colours and values at its vertices, binary little-endian."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.export.asset import Asset, AssetMesh
from reflest_core.export.microfacet_material import MicrofacetMaterial
from reflest_core.ply_file import write_ply


def ply(asset: Asset, file_name: str) -> dict[str, bytes]:
    """The file.

    Its vertices have ``x y z nx ny nz``, ``red green blue`` (8-bit sRGB base colour), ``s t``
    where there is a texture, and the values of their material: ``rho_s alpha material_id`` and the
    standard deviations, -1 where unknown.

    Args:
        asset: What to write. z stays up.
        file_name: Of the file, with its suffix.
    """
    mesh = asset.mesh
    label = np.zeros(len(mesh.vertices), np.int32)
    label[mesh.faces] = mesh.face_materials[:, None]
    # Far from the world's origin float32 would lose millimetres.
    vertices = mesh.vertices + np.array(asset.origin) if asset.is_far else mesh.vertices
    columns: dict[str, NDArray[Any]] = {
        **dict(zip("xyz", vertices.T, strict=True)),
        **dict(zip(("nx", "ny", "nz"), mesh.normals.T, strict=True)),
        **dict(zip(("red", "green", "blue"), _colours(asset, mesh, label).T, strict=True)),
        "rho_s": np.array([one.ward.rho_s for one in asset.materials], np.float32)[label],
        "alpha": np.array([one.ward.alpha for one in asset.materials], np.float32)[label],
    }
    for name, values in mesh.attributes.items():
        if values.ndim == 1:
            columns[name] = values
        else:
            for channel, column in zip("rgb", values.T, strict=True):
                columns[f"{name.removesuffix('_stddev')}_{channel}_stddev"] = column
    if mesh.uv is not None and asset.base_colour is not None:
        columns |= {"s": mesh.uv[:, 0], "t": mesh.uv[:, 1]}
    records = np.empty(len(label), [(name, values.dtype) for name, values in columns.items()])
    for name, values in columns.items():
        records[name] = values
    faces = np.empty(len(mesh.faces), [("vertex_indices", "<i4", (3,))])
    faces["vertex_indices"] = mesh.faces
    content = io.BytesIO()
    write_ply(content, {"vertex": records, "face": faces}, ["reflest, metres, z up"])
    return {file_name: content.getvalue()}


def _colours(asset: Asset, mesh: AssetMesh, label: NDArray[np.int32]) -> NDArray[np.uint8]:
    """(N, 3) sRGB of the texture at each vertex, or of its material."""
    image = asset.base_colour
    if image is None or mesh.uv is None:
        linear = [MicrofacetMaterial.from_ward(one.ward).base_colour for one in asset.materials]
        encoded: NDArray[np.float64] = srgb.encode(np.array(linear))
        return np.rint(255 * encoded).astype(np.uint8)[label]
    size = np.array(image.shape[1::-1])
    places = np.stack([mesh.uv[:, 0], 1 - mesh.uv[:, 1]], axis=1) * size
    column, row = np.clip(places.astype(np.int64), 0, size - 1).T
    return np.asarray(image[row, column], np.uint8)
