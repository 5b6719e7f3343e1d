# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import hypothesis.strategies as st
from hypothesis import given

from reflest_core.surface.voxel_key import NO_KEY, VOXEL_LIMIT, pack_key, unpack_key

coordinate = st.integers(-VOXEL_LIMIT, VOXEL_LIMIT)
voxel = st.tuples(coordinate, coordinate, coordinate)


@given(voxel)
def test_unpacking_inverts_packing(ijk):
    key = pack_key(*ijk)
    assert key > NO_KEY
    assert unpack_key(key) == ijk


@given(voxel, voxel)
def test_keys_order_as_coordinates_do(one, other):
    assert (pack_key(*one) < pack_key(*other)) == (one < other)
