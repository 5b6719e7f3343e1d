# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a scan holds, in memory and in one file."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.frames.region import Region, RegionShape
from reflest_core.fusion.frames.work_sphere import WorkSphere
from reflest_core.fusion.memory_budget import MemoryBudget, MemoryBudgetError
from reflest_core.fusion.observations.observation_chunks import ChunkPool
from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.scan_check import check_arrays, checked_header, storable_name
from reflest_core.fusion.scan_file import damaged, read_scan, restore_rows, write_scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.tsdf.volume import TsdfVolume
from reflest_core.light.light_map import LightMap
from reflest_core.surface.material_ids import GivenIds


class ScanState:
    """TSDF volume, voxel observations, views and light of one scan.

    Attributes:
        fusion: Settings.
        region_settings: The region of interest, world frame.
        origin: (3,) float64, of the scan's own coordinates in the world frame, metres: 0, or near
            the first camera where that is far away. Everything below is in the scan's coordinates.
        volume: The TSDF.
        store: The observations of voxels.
        views: The stored views.
        light: What the background showed.
        work_sphere: What is scanned where there is no region.
        middle: (3,) float64, the surface point in the middle of the last view; None before the
            first one, and where a region or a mask says what is looked at.
        frame_number: Frames fused.
        unchecked_until: Number of the last frame before a jump of the tracker: surface that was
            last seen up to then is dropped where later frames contradict it; -1 without a jump.
        last_stamp_ns: Stamp of the last one, None before the first.
        frame_id: The camera's frame of the last one.
        world_frame_id: The world frame of the last one.
    """

    def __init__(self, fusion: FusionSettings, region: RegionSettings) -> None:
        """Begin an empty scan.

        Args:
            fusion: Settings.
            region: The region of interest.

        Raises:
            MemoryBudgetError: The machine cannot give what ``memory_budget_mb`` asks for.
        """
        self.fusion = fusion
        self.set_region(region)

    def reset(self) -> None:
        """Forget everything that was scanned."""
        budget = MemoryBudget.from_settings(self.fusion)
        try:
            self.volume = TsdfVolume(self.fusion.voxel_size, self.fusion.truncation, budget.blocks)
            self.store = ObservationStore(
                budget.voxels, budget.chunks, self.fusion.observations_per_voxel
            )
        except MemoryError:
            raise MemoryBudgetError.of(self.fusion) from None
        self.views = ViewTable(budget.views)
        self.light = LightMap()
        self.work_sphere, self.material_ids = WorkSphere(), GivenIds()
        self.middle: NDArray[np.float64] | None = None
        self._set_origin(np.zeros(3))
        self.frame_number, self.unchecked_until = 0, -1
        self.last_stamp_ns: int | None = None
        self.frame_id, self.world_frame_id = "", ""
        self._clock_ns: int | None = None

    def set_region(self, region: RegionSettings) -> None:
        """Begin a scan of another region.

        What was scanned is forgotten: F and B of the stored views belong to the old region.

        Args:
            region: The region of interest.
        """
        self.region_settings = region
        self.reset()

    def restart_clock(self) -> None:
        """Take any stamp next, as after a clock jump; what was scanned stays."""
        self._clock_ns = None

    @property
    def bounds(self) -> Region:
        """What bounds the scan, world frame: the region of interest, else the work sphere.

        Without either, as before the first frame and with masks, its shape is that of no region.
        """
        if self.region.shape is RegionShape.NONE and self.work_sphere.frames:
            return self.work_sphere.region(self.fusion).relative_to(-self.origin)
        return Region.from_settings(self.region_settings)

    @property
    def voxel_count(self) -> int:
        """Surface voxels in the store."""
        return self.store.count

    @property
    def observation_count(self) -> int:
        """Observations in the store."""
        return self.store.observation_count

    @property
    def view_count(self) -> int:
        """Stored views."""
        return self.views.stored

    @property
    def nbytes(self) -> int:
        """Bytes reserved by volume, store, views and light; at most ``memory_budget_mb``."""
        return self.volume.nbytes + self.store.nbytes + self.views.nbytes + self.light.nbytes

    @property
    def fill(self) -> float:
        """Share of the fullest of volume, store and views; near 1, old voxels give way to new."""
        return max(
            self.volume.count / self.volume.capacity,
            self.store.count / self.store.capacity,
            self.store.pool.taken / self.store.pool.capacity,
            self.views.stored / self.views.capacity,
        )

    def save(self, path: Path | str) -> None:
        """Write the scan to one file, replacing it whole or not at all.

        Args:
            path: The file.

        Raises:
            OutputError: The file cannot be written; it is as it was before.
        """
        header = {
            "fusion": dataclasses.asdict(self.fusion),
            "region": dataclasses.asdict(self.region_settings),
            "origin": self.origin.tolist(),
            "frame_number": self.frame_number,
            "unchecked_until": self.unchecked_until,
            "last_stamp_ns": self.last_stamp_ns,
            "frame_id": storable_name(self.frame_id),
            "world_frame_id": storable_name(self.world_frame_id),
            "exposure_gain": self.light.gain,
            "work_sphere": dataclasses.asdict(self.work_sphere),
            "middle": None if self.middle is None else self.middle.tolist(),
            "next_material_id": self.material_ids.next_id,
        }
        arrays = {
            f"{part}_{name}": array[: stage.count]
            for part, stage in self._stages()
            for name, array in stage.arrays.items()
        }
        arrays |= {f"light_{name}": array for name, array in self.light.arrays.items()}
        write_scan(Path(path), header, arrays | self.material_ids.arrays)

    @classmethod
    def load(cls, path: Path | str, own: FusionSettings | None = None) -> Self:
        """Read a saved scan; it continues exactly as the saved one would have.

        Args:
            path: The file.
            own: Settings of whoever loads it: their memory budget and threads hold, the rest is the
                scan's; None: all is the scan's.

        Returns:
            The scan.

        Raises:
            ScanFileError: The file is missing, damaged or of another version.
            MemoryBudgetError: The budget is too small for the scan, or too large for the machine.
        """
        path = Path(path)
        room = None if own is None else MemoryBudget.from_settings(own).check_size
        stored, arrays = read_scan(path, room)
        try:
            header = checked_header(stored)
            fusion = header.fusion
            if own is not None:
                fusion = dataclasses.replace(
                    fusion, memory_budget_mb=own.memory_budget_mb, threads=own.threads
                )
            budget = MemoryBudget.from_settings(fusion)
            if own is not None:
                budget.check_room(path, arrays)
            check_arrays(arrays, fusion, header.frame_number, budget.voxels)
            scan = cls(fusion, header.region)
            scan._set_origin(np.array(header.origin))
            counts = {
                part: restore_rows(f"{part}_", stage.arrays, arrays)
                for part, stage in scan._stages()
            }
            restore_rows("light_", scan.light.arrays, arrays)
            scan.light.gain = header.exposure_gain
            scan.views.count = counts["views"]
            scan.volume.restore(counts["volume"])
            is_view = scan.views.order[: counts["views"]] >= 0
            scan.store.restore(counts["store"], counts["chunks"], is_view)
            scan.frame_number = header.frame_number
            scan.unchecked_until = header.unchecked_until
            scan.last_stamp_ns = scan._clock_ns = header.last_stamp_ns
            scan.frame_id, scan.world_frame_id = header.frame_id, header.world_frame_id
            scan.work_sphere = WorkSphere.from_json(header.work_sphere)
            scan.middle = None if header.middle is None else np.array(header.middle)
            scan.material_ids = GivenIds.stored(stored, arrays)
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise damaged(path, error) from None
        return scan

    def _set_origin(self, origin: NDArray[np.float64]) -> None:
        self.origin = origin
        self.region = Region.from_settings(self.region_settings).relative_to(origin)

    def _stages(
        self,
    ) -> tuple[tuple[str, TsdfVolume | ObservationStore | ChunkPool | ViewTable], ...]:
        return (
            ("volume", self.volume),
            ("store", self.store),
            ("chunks", self.store.pool),
            ("views", self.views),
        )
