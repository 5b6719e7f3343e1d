# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A fingerprint follows every import, and nothing else."""

import shutil

import pytest

from reflest_core.source_fingerprint import ROOT, imported_sources, source_fingerprint
from reflest_core.training.light.scan_plan import SOURCES

MODULES = {
    "entry": "from reflest_core.near import value\n",
    "near": "def value():\n    from reflest_core import late\n    return late\n",
    "late": "import reflest_core.folder.inner\n",
    "folder/__init__": "",
    "folder/inner": "import numpy\n",
    "types": "",
    "beside": "",
    "__init__": "",
}


@pytest.fixture
def root(tmp_path):
    """A small package: entry -> near -> late (in a function) -> folder.inner; two not imported."""
    for name, text in MODULES.items():
        path = tmp_path / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    (tmp_path / "entry.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import reflest_core.types\n"
        + MODULES["entry"]
    )
    return tmp_path


def names(root, *modules):
    return {
        path.relative_to(root).with_suffix("").as_posix()
        for path in imported_sources(*modules, root=root)
    }


def test_imports_are_followed_through_others_functions_and_packages(root):
    assert names(root, "reflest_core.entry") == MODULES.keys() - {"types", "beside"}
    assert names(root, "reflest_core.late") == {
        "late",
        "folder/__init__",
        "folder/inner",
        "__init__",
    }


@pytest.mark.parametrize("changed", sorted(MODULES))
def test_a_change_of_what_is_imported_changes_the_fingerprint(root, changed):
    source_fingerprint.cache_clear()
    before = source_fingerprint("reflest_core.entry", root=root)
    path = root / f"{changed}.py"
    path.write_text(path.read_text() + "# changed\n")
    source_fingerprint.cache_clear()
    is_other = source_fingerprint("reflest_core.entry", root=root) != before
    assert is_other == (changed not in ("types", "beside"))


def test_a_module_that_there_is_not_is_named(root):
    with pytest.raises(ValueError, match=r"no module reflest_core\.missing"):
        imported_sources("reflest_core.missing", root=root)


def test_changing_any_file_that_simulated_scans_import_changes_their_key(tmp_path):
    copy = tmp_path / "reflest_core"
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns("__pycache__", "*.safetensors"))
    source_fingerprint.cache_clear()
    before = source_fingerprint(*SOURCES, root=copy)
    assert before == source_fingerprint(*SOURCES)
    sources = imported_sources(*SOURCES, root=copy)
    assert {copy / "surface/voxel_choice.py", copy / "light/completion.py"} <= set(sources)
    assert copy / "models/hemicnn/live.py" not in sources
    for path in sources:
        text = path.read_text()
        path.write_text(text + "# changed\n")
        source_fingerprint.cache_clear()
        assert source_fingerprint(*SOURCES, root=copy) != before, path
        path.write_text(text)
