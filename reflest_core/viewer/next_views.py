# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where to look from next: the places whose views would show most that is new."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles
from reflest_core.surface.coverage import RINGS, SECTORS, seen_cells
from reflest_core.surface.tangent_frame import tangent_frame
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.shown_scan import ShownScan

VIEWS = 3
"""Places that are suggested."""
SAMPLED = 160
"""Voxels that speak for a material."""
AZIMUTHS, HEIGHTS = 24, (12.0, 30.0, 48.0, 66.0, 84.0)
"""Places that are compared: azimuths, and degrees above the horizon."""
USUAL_DISTANCE = 0.6
"""Metres, where no view is known."""
FLATTEST = 0.15
"""Cosine to a surface below which a camera hardly sees it."""
UNSEEN_LIGHT = 0.25
"""Share of the light from above, unseen, from which on to look for it."""
LEAST_GAIN = 0.04
"""Share of the surface, weighted by cosine, that a place must show from a new direction."""


@dataclass(frozen=True)
class Suggestion:
    """An arrow to draw.

    Attributes:
        start: (3,) world frame, metres: where to hold the camera.
        end: (3,) what to look at.
        words: what to do there, in a short sentence.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    words: str


def next_views(scan: ShownScan, material_id: int) -> list[Suggestion]:
    """Suggest places to look at a material from.

    Places lie on a dome around the material, as far away as the views were. Each voxel's hemisphere
    has 32 cells (:mod:`reflest_core.surface.coverage`). The place that adds a cell to most of the
    surface, weighted by how much that faces the camera, comes first, then the best beside it.

    Args:
        scan: what is shown, with its observations.
        material_id: of a material of its map.

    Returns:
        At most :data:`VIEWS` suggestions, the best first; none where all was seen.
    """
    surface = scan.found.surface
    voxels = np.flatnonzero(scan.found.material_ids == material_id)
    if not len(voxels) or not scan.has_observations:
        return []
    voxels = voxels[:: max(len(voxels) // SAMPLED, 1)]
    positions, normals = surface.positions[voxels], surface.normals[voxels]
    centre = positions.mean(axis=0, dtype=np.float64)
    seen = seen_cells(surface, voxels).reshape(len(voxels), -1)
    places = _dome(scan, centre)
    cells = [_cells(positions, normals, place) for place in places]
    cell, facing = np.stack([one[0] for one in cells]), np.stack([one[1] for one in cells])
    found: list[Suggestion] = []
    rows = np.arange(len(voxels))
    for _ in range(VIEWS):
        is_new = (cell >= 0) & ~seen[rows, np.maximum(cell, 0)]
        gains = (is_new * facing).mean(axis=1)
        best = int(gains.argmax())
        if gains[best] < LEAST_GAIN:
            break
        # A camera that moves there passes the cells around it.
        seen[rows[is_new[best]], cell[best][is_new[best]]] = True
        found.append(
            Suggestion(places[best], centre, f"a new direction for {is_new[best].mean():.0%} of it")
        )
        near = np.linalg.norm(places - places[best], axis=1) < 0.35 * np.linalg.norm(
            places[best] - centre
        )
        places, cell, facing = places[~near], cell[~near], facing[~near]
    return found


def unseen_light(scan: ShownScan) -> Suggestion | None:
    """Suggest where in the room to point the camera.

    Args:
        scan: what is shown.

    Returns:
        An arrow away from the scan, into the middle of the light from above that no frame showed;
        None where most of it was seen, or no light is known.
    """
    if scan.light is None:
        return None
    coverage = scan.light[..., 3]
    directions = octahedral_directions(len(coverage))
    weights = octahedral_solid_angles(len(coverage)) * np.clip(directions[..., 2] + 0.2, 0.0, None)
    missing = weights * (1.0 - coverage)
    share = float(missing.sum() / weights.sum())
    if share < UNSEEN_LIGHT:
        return None
    towards = (missing[..., None] * directions).sum(axis=(0, 1)) @ rotation_to_z(scan.up)
    towards = towards / max(float(np.linalg.norm(towards)), 1e-9)
    centre = scan.vertices.mean(axis=0, dtype=np.float64)
    radius = 0.5 * float(np.linalg.norm(np.ptp(scan.vertices, axis=0)))
    return Suggestion(
        centre + 0.8 * radius * towards,
        centre + 1.4 * radius * towards,
        f"{share:.0%} of the light from above was not seen: look round the room this way",
    )


def _dome(scan: ShownScan, centre: NDArray[np.float64]) -> NDArray[np.float64]:
    """(P, 3) places around a centre, above it."""
    surface = scan.found.surface
    eyes = surface.view_centres[surface.is_observing]
    distance = float(np.median(np.linalg.norm(eyes - centre, axis=1))) if len(eyes) else 0.0
    azimuth = np.arange(AZIMUTHS) / AZIMUTHS * 2.0 * np.pi
    height = np.radians(HEIGHTS)[:, None]
    unit = np.stack(
        np.broadcast_arrays(
            np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)
        ),
        axis=-1,
    ).reshape(-1, 3)
    places: NDArray[np.float64] = centre + (distance or USUAL_DISTANCE) * unit @ rotation_to_z(
        scan.up
    )
    return places


def _cells(
    positions: NDArray[np.float32], normals: NDArray[np.float32], place: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """(N,) cells of the voxels' hemispheres that a place lies in, -1 if hardly seen; cosines."""
    towards = place - positions
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    frames = np.array([tangent_frame(normal) for normal in normals]).reshape(-1, 2, 3)
    cosine = np.einsum("vc,vc->v", towards, normals)
    along, across = np.einsum("vkc,vc->kv", frames, towards)
    ring = np.minimum((cosine * RINGS).astype(np.int64), RINGS - 1)
    turn = np.arctan2(across, along) / (2.0 * np.pi) + 0.5
    sector = np.minimum((turn * SECTORS).astype(np.int64), SECTORS - 1)
    return np.where(cosine > FLATTEST, ring * SECTORS + sector, -1), cosine
