# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""PLY files are those of another writer, to the byte, and damaged ones are refused."""

from __future__ import annotations

import io

import numpy as np
import plyfile
import pytest

from reflest_core.ply_file import TYPES, read_vertices, write_ply

RNG = np.random.default_rng(3)


def vertices(count=7):
    records = np.zeros(count, [(f"p_{kind}", f"<{kind}") for kind in TYPES])
    for name in records.dtype.names:
        records[name] = RNG.integers(0, 100, count)
    return records


def faces(count=5):
    records = np.zeros(count, [("vertex_indices", "<i4", (3,)), ("material", "<u2")])
    records["vertex_indices"] = RNG.integers(0, 7, (count, 3))
    return records


def written(elements, comments=()):
    content = io.BytesIO()
    write_ply(content, elements, comments)
    return content.getvalue()


def test_files_are_those_of_another_writer(tmp_path):
    elements = {"vertex": vertices(), "face": faces()}
    comments = ["metres, z up", "frame map"]
    described = [plyfile.PlyElement.describe(array, name) for name, array in elements.items()]
    expected = io.BytesIO()
    plyfile.PlyData(described, byte_order="<", comments=comments).write(expected)
    assert written(elements, comments) == expected.getvalue()


def test_a_comment_stays_one_line(tmp_path):
    path, records = tmp_path / "a.ply", vertices()
    path.write_bytes(written({"vertex": records}, ["frame a\nend_header\r\x0b\u2028x\0\ud800"]))
    np.testing.assert_array_equal(read_vertices(path), records)
    assert plyfile.PlyData.read(path).comments == ["frame a?end_header???x??"]


def test_vertices_come_back(tmp_path):
    path, records = tmp_path / "a.ply", vertices()
    path.write_bytes(written({"vertex": records, "face": faces()}, ["a comment"]))
    np.testing.assert_array_equal(read_vertices(path), records)
    np.testing.assert_array_equal(plyfile.PlyData.read(path)["vertex"].data, records)
    path.write_bytes(path.read_bytes().replace(b"property float ", b"property float32 "))
    np.testing.assert_array_equal(read_vertices(path), records)


GOOD = written({"vertex": vertices()})


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"ply",
        GOOD[:-1],
        GOOD.replace(b"vertex 7", b"vertex 8"),
        GOOD.replace(b"vertex 7", b"vertex 999999999999"),
        GOOD.replace(b"vertex 7", b"vertex -1"),
        GOOD.replace(b"end_header", b"end_headed"),
        GOOD.replace(b"little", b"big"),
        GOOD.replace(b"property float p_f4", b"property half p_f4"),
        GOOD.replace(b"p_f4", b"p_f8"),
        GOOD.replace(b"property float p_f4", b"property list uchar float p_f4"),
    ],
)
def test_damaged_files_are_refused(tmp_path, content):
    (tmp_path / "a.ply").write_bytes(content)
    with pytest.raises(ValueError, match=r"\w"):
        read_vertices(tmp_path / "a.ply")
