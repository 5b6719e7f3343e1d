# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/estimate`` and ``~/export``: materials or the light, from everything that was scanned."""

from __future__ import annotations

from pathlib import Path

from reflest_core.estimation.pipeline import EVERY_VOXEL, KeyframeSnapshot, Pipeline
from reflest_core.export.environment_file import LIGHT_FORMATS, export_environment
from reflest_core.export.errors import ExportError
from reflest_core.export.exporter import (
    FORMATS,
    asset_name,
    checked_format,
    export_estimate,
)
from reflest_core.export.libraries import open3d
from reflest_core.whole_file import write_whole
from reflest_ros.outputs.estimate_message import estimate_to_message, unknown_message
from reflest_ros.outputs.estimate_output import EstimateOutput
from reflest_ros.services.answers import answer_with
from reflest_ros.services.estimate_requests import AnsweredEstimate, EstimateRequests
from reflest_ros.services.file_access import FileAccess
from reflest_ros.services.node_services import ESTIMATE_THREADS, NodeServices
from reflest_ros.srv import Estimate, ExportEstimate
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import FusionWorker

SPHERE = "sphere-"
"""Before a format: a sphere of one material in place of the scanned surface."""


class EstimateServices:
    """They wait for fusion and estimation, while frames keep coming."""

    def __init__(
        self,
        pools: NodeServices,
        files: FileAccess,
        pipeline: Pipeline,
        fusion: FusionWorker,
        estimation: EstimationWorker,
        output: EstimateOutput,
    ) -> None:
        """Create the services.

        Args:
            pools: Answer them.
            files: The files that may be written.
            pipeline: The scan.
            fusion: The thread that it belongs to.
            estimation: Estimates from it.
            output: Has the newest estimate.
        """
        self._files = files
        self._pipeline = pipeline
        self._fusion = fusion
        self._estimation = estimation
        self._requests = EstimateRequests(fusion, estimation, output, ESTIMATE_THREADS - 1)
        pools.estimates.create(Estimate, "~/estimate", self.estimate)
        pools.work.create(ExportEstimate, "~/export", self.export)

    def estimate(self, _: Estimate.Request, response: Estimate.Response) -> Estimate.Response:
        """Estimate from everything that was scanned; the answer is published as well.

        While images or other requests keep coming, it answers within a second: where its own
        estimate takes longer, with the newest one, and the message says so.

        Args:
            _: empty.
            response: to fill in.
        """
        response.estimate = unknown_message()

        def work() -> str:
            answer = self._requests.now()
            response.estimate = estimate_to_message(answer.estimate)
            return _summary(answer)

        return answer_with(response, work)

    def export(
        self, request: ExportEstimate.Request, response: ExportEstimate.Response
    ) -> ExportEstimate.Response:
        """Write the surface with its materials, a sphere of one, or the light, as a file.

        Args:
            request: as it was received.
            response: to fill in.
        """

        def work() -> str:
            name = request.format.removeprefix(SPHERE)
            is_sphere = name != request.format
            if name not in FORMATS and (is_sphere or name not in LIGHT_FORMATS):
                known = (*FORMATS, *LIGHT_FORMATS)
                raise ExportError(
                    f"format = {request.format[:40]!r} is not one of {', '.join(known)}; "
                    f"{SPHERE}glb and so on write a sphere of one material"
                )
            path = self._files.to_write(request.path)
            if name in LIGHT_FORMATS:
                return self._export_light(name, path)
            checked_format(path, name)
            return self._export_sphere(name, path) if is_sphere else self._export_scan(name, path)

        return answer_with(response, work)

    def _export_sphere(self, format_name: str, path: Path) -> str:
        answer = self._requests.now()
        export_estimate(answer.estimate, format_name, path)
        return f"wrote {path}: {_summary(answer)}"

    def _export_scan(self, format_name: str, path: Path) -> str:
        """Only the copy is made in the fusion thread; frames wait meanwhile."""
        from reflest_core.export.scan_asset import AssetSettings, mesh_asset
        from reflest_core.export.scanned_mesh import mesh_of_voxels

        open3d()
        pipeline = self._pipeline
        settings = AssetSettings(up=pipeline.settings.estimation.up)

        def copied() -> tuple[KeyframeSnapshot, float]:
            return pipeline.snapshot(EVERY_VOXEL), pipeline.scan.fusion.voxel_size

        snapshot, voxel_size = self._fusion.call(copied).result()
        surface = snapshot.surface
        mesh = mesh_of_voxels(
            surface.positions, surface.normals, voxel_size, settings.faces, up=settings.up
        )
        found = self._estimation.call(lambda: pipeline.materials(snapshot)).result()
        asset = mesh_asset(mesh, voxel_size, found, asset_name(path), settings)
        (main, *others) = checked_format(path, format_name).files(asset, path.name).items()
        for name, content in (*others, main):
            write_whole(self._files.to_write(str(path.with_name(name))), content)
        beside = f" and {len(others)} beside it" if others else ""
        warning = f"; {asset.warning}" if asset.warning else ""
        counts = f"{len(asset.materials)} materials, {len(mesh.faces)} faces"
        return f"wrote {path}{beside}: {counts}{warning}"

    def _export_light(self, format_name: str, path: Path) -> str:
        surface = self._fusion.call(self._fusion.snapshot).result().surface
        export_environment(surface, format_name, path)
        light = surface.light
        return f"wrote {path}: light of which {light.seen_share if light else 0.0:.0%} was seen"


def _summary(answer: AnsweredEstimate) -> str:
    estimate = answer.estimate
    return (
        f"{estimate.model_id}, {estimate.ward_variant}, from {estimate.voxel_count} voxels"
        f" and {estimate.view_count} views{'; ' if answer.note else ''}{answer.note}"
    )
