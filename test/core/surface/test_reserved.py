# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from reflest_core.surface.reserved import SMALL, reserved


def resident() -> int:
    """Bytes of this process that are in memory."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096


@pytest.mark.parametrize("shape", [0, 3, (5, 0), (SMALL // 4, 3)])
def test_zeros_of_the_shape(shape):
    found = reserved(shape, np.float32)
    expected = np.zeros(shape, np.float32)
    np.testing.assert_array_equal(found, expected)
    assert found.dtype == expected.dtype
    assert found.flags.c_contiguous
    assert found.flags.writeable
    assert found.flags.aligned


def test_pages_come_as_they_fill_and_go_again_also_after_others_went():
    size = 16 * SMALL  # which the C library takes from its heap once such arrays were given back
    for _ in range(3):
        before = resident()
        arrays = [reserved(size, np.uint8) for _ in range(4)]
        assert resident() - before < size // 2
        for array in arrays:
            array.fill(1)
        assert resident() - before > 3 * size
        del arrays, array
        assert resident() - before < size // 2


def test_more_than_there_is_is_a_memory_error():
    with pytest.raises(MemoryError):
        reserved(1 << 60, np.float64)
