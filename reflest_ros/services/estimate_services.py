# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/estimate`` and ``~/export``: the material or the light, from everything that was scanned."""

from __future__ import annotations

import time
from pathlib import Path

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.export.environment_file import LIGHT_FORMATS, export_environment
from reflest_core.export.errors import ExportError
from reflest_core.export.exporter import FORMATS, export_estimate
from reflest_ros.outputs.estimate_message import estimate_to_message, unknown_message
from reflest_ros.services.answers import answer_with
from reflest_ros.services.file_access import FileAccess
from reflest_ros.services.service_pool import ServicePool
from reflest_ros.srv import Estimate, ExportEstimate
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import FusionWorker, Keyframe


class EstimateServices:
    """Both wait for fusion and estimation, while frames keep coming."""

    def __init__(
        self,
        pool: ServicePool,
        files: FileAccess,
        fusion: FusionWorker,
        estimation: EstimationWorker,
    ) -> None:
        """Create the services.

        Args:
            pool: Answers them.
            files: The files that may be written.
            fusion: Gives a snapshot of the scan.
            estimation: Estimates from it.
        """
        self._files = files
        self._fusion = fusion
        self._estimation = estimation
        pool.create(Estimate, "~/estimate", self.estimate)
        pool.create(ExportEstimate, "~/export", self.export)

    def estimate(self, _: Estimate.Request, response: Estimate.Response) -> Estimate.Response:
        """Estimate from everything that was scanned; the answer is published as well.

        Args:
            _: empty.
            response: to fill in.
        """
        response.estimate = unknown_message()

        def work() -> str:
            estimate = self._estimate_now()
            response.estimate = estimate_to_message(estimate)
            return _summary(estimate)

        return answer_with(response, work)

    def export(
        self, request: ExportEstimate.Request, response: ExportEstimate.Response
    ) -> ExportEstimate.Response:
        """Estimate and write the material, or write the light, as a file of another program.

        Args:
            request: as it was received.
            response: to fill in.
        """

        def work() -> str:
            if request.format not in (*FORMATS, *LIGHT_FORMATS):
                raise ExportError(
                    f"format = {request.format[:40]!r} is not one of "
                    f"{', '.join((*FORMATS, *LIGHT_FORMATS))}"
                )
            path = self._files.to_write(request.path)
            if request.format in LIGHT_FORMATS:
                return self._export_light(request.format, path)
            estimate = self._estimate_now()
            export_estimate(estimate, request.format, path)
            return f"wrote {path}: {_summary(estimate)}"

        return answer_with(response, work)

    def _export_light(self, format_name: str, path: Path) -> str:
        surface = self._fusion.call(self._fusion.snapshot).result().surface
        export_environment(surface, format_name, path)
        light = surface.light
        return f"wrote {path}: light of which {light.seen_share if light else 0.0:.0%} was seen"

    def _estimate_now(self) -> BrdfEstimate:
        asked = time.monotonic()
        snapshot = self._fusion.call(self._fusion.snapshot).result()
        return self._estimation.request(Keyframe(snapshot, asked)).result()


def _summary(estimate: BrdfEstimate) -> str:
    return (
        f"{estimate.model_id}, {estimate.ward_variant}, from {estimate.voxel_count} voxels"
        f" and {estimate.view_count} views"
    )
