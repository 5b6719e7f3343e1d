# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Files of arrays made to harm: nothing is unpickled, and no declared size is believed."""

from __future__ import annotations

import contextlib
import pickle
import struct
import tracemalloc
import zipfile

import numpy as np
import pytest

from reflest_core.array_file import MOST_BYTES, array_names, read_array, read_member


class Harmful:
    """Would raise where it is unpickled."""

    def __reduce__(self):
        return (exec, ("raise SystemExit('it was unpickled')",))


def declared(shape, dtype="<f4", data=b""):
    """An ``.npy`` file that declares an array of any size."""
    header = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}}}".encode()
    header += b" " * (-(len(header) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + data


@contextlib.contextmanager
def traced_memory():
    """Yield a function that returns the most bytes that Python took in the block."""
    tracemalloc.start()
    try:
        yield lambda: tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def collection(path, content, compression=zipfile.ZIP_STORED):
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr("a.npy", content)
    return path


def test_arrays_are_read_as_numpy_reads_them(tmp_path):
    arrays = {
        "a/v": np.arange(12, dtype=np.uint16).reshape(3, 4),
        "b": np.asfortranarray(np.random.default_rng(0).normal(size=(5, 7))),
        "none": np.empty((0, 3)),
        "one": np.float32(2),
    }
    for name, save in (("plain", np.savez), ("packed", np.savez_compressed)):
        path = tmp_path / f"{name}.npz"
        save(path, **arrays)
        assert array_names(path) == sorted(arrays)
        for key, array in arrays.items():
            read = read_member(path, key)
            assert read.dtype == array.dtype
            np.testing.assert_array_equal(read, array)
    np.save(tmp_path / "b.npy", arrays["b"])
    np.testing.assert_array_equal(read_array(tmp_path / "b.npy"), arrays["b"])


CONTENTS = {
    "10 PB": declared("(1000000000, 1000000, 3)"),
    "negative": declared("(-1, 3)"),
    "more than there is": declared("(1000,)", data=b"\0" * 10),
    "objects": declared("(1,)", "|O", pickle.dumps([Harmful()])),
    "a pickle": pickle.dumps(Harmful()),
    "a header that is code": b"\x93NUMPY\x01\x00\x0a\x00__import__",
    "a header that ends in a bracket": declared("(\n("),
    "nothing": b"",
}


@pytest.mark.parametrize("content", CONTENTS.values(), ids=CONTENTS)
def test_a_hostile_array_is_refused(tmp_path, content):
    path = tmp_path / "a.npy"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"\w"):
        read_array(path)
    with pytest.raises(ValueError, match=r"\w"):
        read_member(collection(tmp_path / "a.npz", content), "a")


def test_zeros_that_pack_a_gigabyte_into_a_megabyte_are_refused(tmp_path):
    path, block = tmp_path / "a.npz", bytes(1 << 24)
    length = MOST_BYTES + len(block)
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("a.npy", "w", force_zip64=True) as member,
    ):
        member.write(declared(f"({length},)", "|u1"))
        for _ in range(length // len(block)):
            member.write(block)
    assert path.stat().st_size < 10_000_000
    with traced_memory() as most, pytest.raises(ValueError, match="more than 1024 MB"):
        read_member(path, "a")
    assert most() < 10e6


def test_files_that_are_no_collections(tmp_path):
    path = tmp_path / "a.npz"
    for content in (b"", b"PK nonsense", b"PK\x05\x06" + b"\xff" * 18, pickle.dumps(Harmful())):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"\w"):
            array_names(path)
    np.savez(path, here=np.zeros(3))
    with pytest.raises(ValueError, match="gone"):
        read_member(path, "gone")
    damaged = bytearray(path.read_bytes())
    damaged[150] ^= 0xFF
    path.write_bytes(damaged)
    with pytest.raises(ValueError, match=r"\w"):
        read_member(path, "here")
