"""All validation scenes at the voxels that HemiCNN looks at: a row of Table 2 in a few MB.

HemiCNN sees 25 voxels of a scene. Voxel choice on a surface that has these voxels alone returns
all of them, so that estimates from this file are bit for bit those from the whole data set.
"""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save_file

from reflest_core.evaluation.contenders import EvaluationError
from reflest_core.features.voxel_choice import choose_voxels
from reflest_core.fusion.observed_surface import SURFACE_ARRAYS, ObservedSurface
from reflest_core.models.model_choice import MODELS
from reflest_core.training.sample import Sample

QUICK_SET = Path(__file__).parent / "quick" / "validation.safetensors"
EXPECTED = QUICK_SET.with_name("expected.json")
VARIANT = "hemicnn-rmse1"
FORMAT = "reflest-quick-1"
PER_VOXEL = ("positions", "normals")
PER_OBSERVATION = ("colours", "view_indices")


@dataclass(frozen=True)
class _Layout:
    """Scenes end to end: how many voxels and views each has."""

    voxels: list[int]
    views: list[int]
    environments: list[str]
    indices: list[int]


def save_quick_set(path: Path, samples: list[Sample]) -> None:
    """Write the scenes at HemiCNN's voxels."""
    count = MODELS["hemicnn"].voxels
    surfaces = [keep_voxels(s.surface, choose_voxels(s.surface, count)) for s in samples]
    layout = _Layout(
        [surface.voxel_count for surface in surfaces],
        [len(surface.view_centres) for surface in surfaces],
        [sample.environment for sample in samples],
        [sample.index for sample in samples],
    )
    arrays = {
        name: np.concatenate([getattr(surface, name) for surface in surfaces])
        for name in SURFACE_ARRAYS
        if name != "offsets"
    }
    counts = np.concatenate([surface.observation_counts for surface in surfaces])
    arrays["observation_counts"] = counts.astype(np.uint16)
    arrays["ward"] = np.stack([sample.ward for sample in samples])
    path.parent.mkdir(parents=True, exist_ok=True)
    metadata = {"format": FORMAT, "layout": json.dumps(dataclasses.asdict(layout))}
    save_file(arrays, path, metadata)
    path.chmod(0o644)


def load_quick_set(path: Path = QUICK_SET) -> list[Sample]:
    """The scenes of :func:`save_quick_set`; :class:`EvaluationError` names an unusable file."""
    try:
        with safe_open(path, framework="numpy") as file:
            metadata = file.metadata() or {}
            if metadata.get("format") != FORMAT:
                raise EvaluationError(f"{path} is not a {FORMAT} file; install reflest again")
            layout = _Layout(**json.loads(metadata["layout"]))
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError) as error:
        raise EvaluationError(f"{path} is damaged ({error}); install reflest again") from error
    return [_scene(number, layout, arrays) for number in range(len(layout.voxels))]


def keep_voxels(surface: ObservedSurface, voxels: NDArray[np.int64]) -> ObservedSurface:
    """The surface with only the voxels (N,) of the given indices."""
    counts = surface.observation_counts[voxels]
    offsets = np.concatenate([[0], np.cumsum(counts)])
    rows = np.repeat(surface.offsets[voxels] - offsets[:-1], counts) + np.arange(offsets[-1])
    return dataclasses.replace(
        surface,
        offsets=offsets,
        **{name: getattr(surface, name)[voxels] for name in PER_VOXEL},
        **{name: getattr(surface, name)[rows] for name in PER_OBSERVATION},
    )


def _scene(number: int, layout: _Layout, arrays: dict[str, NDArray[Any]]) -> Sample:
    first_voxel, first_view = sum(layout.voxels[:number]), sum(layout.views[:number])
    voxels = slice(first_voxel, first_voxel + layout.voxels[number])
    views = slice(first_view, first_view + layout.views[number])
    counts = arrays["observation_counts"].astype(np.int64)
    first_row = int(counts[: voxels.start].sum())
    offsets = np.concatenate([[0], np.cumsum(counts[voxels])])
    rows = slice(first_row, first_row + int(offsets[-1]))
    by_kind: dict[str, Any] = {"offsets": offsets}
    for name in SURFACE_ARRAYS:
        if name != "offsets":
            is_voxel, is_row = name in PER_VOXEL, name in PER_OBSERVATION
            part = voxels if is_voxel else rows if is_row else views
            by_kind[name] = arrays[name][part]
    surface = ObservedSurface(**by_kind)
    return Sample(surface, arrays["ward"][number], layout.environments[number],
                  layout.indices[number])  # fmt: skip
