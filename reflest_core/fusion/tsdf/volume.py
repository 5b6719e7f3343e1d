# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The truncated signed distance function: a sparse volume of 8 x 8 x 8 voxel blocks.

Its arrays have a fixed capacity and never move; the operating system hands out their pages as they
fill. When blocks run out, those unseen for longest are erased.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.foreground import FramePixels
from reflest_core.fusion.tsdf.frame_blocks import allocate_blocks, blocks_in_sight, pixel_stride
from reflest_core.fusion.tsdf.integration import integrate_blocks
from reflest_core.fusion.tsdf.surface_extraction import confirm_moves, extract_surface
from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks, erase_blocks, surface_keys
from reflest_core.fusion.work_sharing import share_out
from reflest_core.jit import kernel_array
from reflest_core.surface.key_index import BYTES_PER_ROW, KeyIndex, are_unique_keys
from reflest_core.surface.reserved import reserved
from reflest_core.surface.voxel_key import BLOCK_EDGE

BYTES_PER_BLOCK = BLOCK_EDGE**3 * (4 + 2 + 1) + 8 + 8 + BYTES_PER_ROW

ERASED_SHARE = 8
"""Room is made for this fraction (one eighth) of the capacity at a time."""

MOST_BESIDE = 8192
"""Blocks that a frame projects beyond those near its surface: a larger volume is gone through in
turns, so that a frame's cost does not grow with what was scanned before."""

LEAST_SHARE = 64
"""Fewer blocks than this are not worth waking another thread."""


@dataclass(frozen=True)
class SurfaceUpdate:
    """The surface in the blocks that a frame changed.

    Attributes:
        keys: (V,) int64 surface voxels.
        positions: (V, 3) float32, on the zero level, world frame, metres.
        normals: (V, 3) float32, unit, outward.
        left: (L,) int64 voxels that are no longer on the surface.
        left_to: (L,) int64 the surface voxel that each one's piece of surface moved to, ``NO_KEY``
            if none.
    """

    keys: NDArray[np.int64]
    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    left: NDArray[np.int64]
    left_to: NDArray[np.int64]


class TsdfVolume:
    """A block-hashed TSDF; ``count`` blocks are in use, the first ones of ``blocks``."""

    def __init__(self, voxel_size: float, truncation: float, capacity: int) -> None:
        """Reserve memory.

        Args:
            voxel_size: Metres.
            truncation: Voxels.
            capacity: Blocks.
        """
        self.voxel_size = voxel_size
        self.truncation = truncation * voxel_size
        self.capacity = capacity
        self.count = 0
        self._index = index = KeyIndex(capacity)
        shape = (capacity, BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE)
        self.blocks = TsdfBlocks(
            index_keys=index.keys,
            index_rows=index.rows,
            keys=reserved(capacity, np.int64),
            tsdf=reserved(shape, np.float32),
            weight=reserved(shape, np.uint16),
            on_surface=reserved(shape, np.bool_),
            last_seen=reserved(capacity, np.int64),
        )

    @property
    def nbytes(self) -> int:
        """Bytes reserved, whether filled or not."""
        return sum(array.nbytes for array in self.blocks)

    @property
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays that make up the volume, at full capacity."""
        fields = self.blocks._asdict().items()
        return {name: array for name, array in fields if not name.startswith("index_")}

    def restore(self, count: int) -> None:
        """Take the first rows of :attr:`arrays`, just filled, for the volume.

        Args:
            count: Rows that were filled.

        Raises:
            ValueError: Block keys repeat.
        """
        if not are_unique_keys(self.blocks.keys[:count]):
            raise ValueError("block keys repeat")
        self.count = count
        self._index.fill(self.blocks.keys[:count])

    def allocate(
        self, frame: Frame, pixels: FramePixels, frame_number: int
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Make sure of blocks around the surface that a frame shows.

        Blocks that this frame sees are never erased: what does not fit beside them is left out.

        Args:
            frame: The frame.
            pixels: What fusion takes of it.
            frame_number: Its number.

        Returns:
            The blocks' slots, and the keys of surface voxels that were erased to make room.
        """
        erased = [np.empty(0, np.int64)]
        if pixels.farthest == 0.0:
            return erased[0], erased[0]
        K = frame.intrinsics.matrix
        stride = pixel_stride(self.voxel_size, min(K[0, 0], K[1, 1]), pixels.farthest)
        T = kernel_array(frame.T_world_camera, np.float64)
        touched = np.empty(self.capacity, np.int64)
        touched_count = 0
        while True:
            self.count, touched_count, is_full = allocate_blocks(
                pixels.depth,
                pixels.surface,
                stride,
                T,
                K,
                self.voxel_size,
                self.blocks,
                self.count,
                frame_number,
                touched,
                touched_count,
            )
            if not is_full:
                break
            last_seen = self.blocks.last_seen[: self.count]
            unseen = np.flatnonzero(last_seen < frame_number)
            if len(unseen) == 0:
                break
            longest_first = unseen[np.argsort(last_seen[unseen], kind="stable")]
            slots = np.sort(longest_first[: max(1, self.capacity // ERASED_SHARE)])
            erased.append(surface_keys(slots, self.blocks))
            self.count = erase_blocks(slots, self.blocks, self.count)
            seen = np.flatnonzero(self.blocks.last_seen[: self.count] == frame_number)
            touched_count = len(seen)
            touched[:touched_count] = seen
        return touched[:touched_count].copy(), np.concatenate(erased)

    def remove(self, keys: NDArray[np.int64]) -> NDArray[np.int64]:
        """Erase blocks.

        Args:
            keys: (B,) packed keys of blocks, stored or not.

        Returns:
            The keys of the surface voxels that were in them.
        """
        slots = np.flatnonzero(np.isin(self.blocks.keys[: self.count], keys))
        erased = surface_keys(slots, self.blocks)
        self.count = erase_blocks(slots, self.blocks, self.count)
        return erased

    def in_sight(
        self, near: NDArray[np.int64], frame: Frame, max_depth: float, frame_number: int
    ) -> NDArray[np.int64]:
        """Add blocks that may appear in the image to those around the frame's surface.

        Args:
            near: Blocks around the surface that the frame shows (:meth:`allocate`).
            frame: The frame.
            max_depth: Metres beyond which no surface is fused.
            frame_number: Its number.

        Returns:
            Slots, ascending.
        """
        beside = blocks_in_sight(
            frame_number * MOST_BESIDE,
            MOST_BESIDE,
            self.blocks.keys[: self.count],
            self.blocks.last_seen,
            frame_number,
            _projection(frame),
            self.voxel_size,
            frame.intrinsics.width,
            frame.intrinsics.height,
            max_depth + self.truncation,
        )
        return np.sort(np.concatenate([near, beside]))

    def integrate(
        self,
        slots: NDArray[np.int64],
        frame: Frame,
        pixels: FramePixels,
        frame_number: int,
        threads: int,
    ) -> NDArray[np.int64]:
        """Fuse a frame's depth into blocks.

        Args:
            slots: Blocks.
            frame: The frame.
            pixels: What fusion takes of it.
            frame_number: Its number.
            threads: Threads that share the work.

        Returns:
            The blocks that changed.
        """
        changed = share_out(
            threads,
            len(slots),
            LEAST_SHARE,
            integrate_blocks,
            slots,
            pixels.depth,
            pixels.steepness,
            pixels.gain,
            pixels.free_depth,
            _projection(frame),
            self.voxel_size,
            self.truncation,
            self.blocks,
            frame_number,
        )
        return np.concatenate(changed)

    def extract(self, slots: NDArray[np.int64], threads: int) -> SurfaceUpdate:
        """Find the surface voxels in blocks.

        Args:
            slots: Blocks.
            threads: Threads that share the work.

        Returns:
            The surface in them.
        """
        parts = share_out(
            threads,
            len(slots),
            LEAST_SHARE,
            extract_surface,
            slots,
            self.voxel_size,
            self.truncation,
            self.blocks,
        )
        update = SurfaceUpdate(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
        confirm_moves(update.left_to, self.blocks)
        return update


def _projection(frame: Frame) -> NDArray[np.float64]:
    """(3, 4): world to homogeneous pixels."""
    return kernel_array(frame.intrinsics.matrix @ frame.T_camera_world[:3], np.float64)
