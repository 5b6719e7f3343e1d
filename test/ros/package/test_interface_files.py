# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Every field of every interface says what it holds; the message says it in full."""

from __future__ import annotations

import re

import pytest
from own_process import ROOT

from reflest_ros import msg, srv
from reflest_ros.node_reference.interface_file import read_interface

MESSAGES = sorted((ROOT / "msg").glob("*.msg"))
SERVICES = sorted((ROOT / "srv").glob("*.srv"))


@pytest.mark.parametrize("path", [*MESSAGES, *SERVICES], ids=lambda path: path.name)
def test_every_field_has_a_comment_of_its_own(path):
    for section in read_interface(path):
        for field in section.fields:
            assert field.comment, f"{field.name} has none"


@pytest.mark.parametrize("path", [*MESSAGES, *SERVICES], ids=lambda path: path.name)
def test_every_interface_says_what_it_is_for(path):
    assert read_interface(path)[0].comment


@pytest.mark.parametrize("path", MESSAGES, ids=lambda path: path.name)
def test_the_files_are_what_was_generated(path):
    (section,) = read_interface(path)
    fields = [field.name for field in section.fields if not field.value]
    assert fields == list(getattr(msg, path.stem).get_fields_and_field_types())


@pytest.mark.parametrize("path", SERVICES, ids=lambda path: path.name)
def test_requests_and_responses_are_what_was_generated(path):
    generated = getattr(srv, path.stem)
    for section, half in zip(
        read_interface(path), (generated.Request, generated.Response), strict=True
    ):
        fields = [field.name for field in section.fields if not field.value]
        assert fields == list(half.get_fields_and_field_types())


@pytest.mark.parametrize("path", MESSAGES, ids=lambda path: path.name)
def test_numbers_have_unit_range_and_unknown_value(path):
    (section,) = read_interface(path)
    numbers = [f for f in section.fields if re.match(r"float|u?int", f.kind) and not f.value]
    assert numbers
    for field in numbers:
        if field.name not in ("schema_version", "status"):
            assert re.search(r"Unit(, colour space)?: ", field.comment), field.name
        assert re.search(r"Range: |One of ", field.comment), field.name
        assert re.search(
            r"Unknown( \([^)]*\))?: (NaN|0|STATUS_UNKNOWN)|Always known", field.comment
        ), field.name


@pytest.mark.parametrize("path", MESSAGES, ids=lambda path: path.name)
def test_arrays_and_strings_are_bounded(path):
    (section,) = read_interface(path)
    for field in section.fields:
        assert not field.kind.endswith("[]"), field.name
        assert field.kind != "string", field.name


def test_colours_name_their_space():
    (section,) = read_interface(ROOT / "msg" / "BrdfEstimate.msg")
    for field in section.fields:
        if field.kind == "float64[3]":
            assert re.search("colour space: ", field.comment, re.I), field.name
