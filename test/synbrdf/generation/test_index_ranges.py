# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import pytest

from reflest_core.synbrdf.generation.index_ranges import IndexRangeError, parse_indices


@pytest.mark.parametrize(
    ("text", "expected"),
    [("3", [3]), ("0:3", [0, 1, 2]), ("0:10:4", [0, 4, 8]), ("5,1,0:2", [0, 1, 5])],
)
def test_selections(text, expected):
    assert parse_indices(text, 10, "scenes") == expected


@pytest.mark.parametrize(
    "text",
    ["", "x", "1:2:3:4", "0:5:0", "10", "-1", "3:3", "0:11", "1.5", "2,0:1000000000000000"],
)
def test_selections_that_name_nothing_are_refused(text):
    with pytest.raises(IndexRangeError, match="--scenes"):
        parse_indices(text, 10, "scenes")
