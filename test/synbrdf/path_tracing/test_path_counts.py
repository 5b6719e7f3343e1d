# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import pytest

from reflest_core.cli.main import main
from reflest_core.synbrdf.path_tracing.mitsuba_scene import mi
from reflest_core.synbrdf.path_tracing.path_counts import PathCountError, check_paths


@pytest.mark.parametrize("paths", [1, 2, 5, 8, 12, 16, 32, 36, 50, 64, 100])
def test_counts_are_refused_where_mitsuba_would_take_another(paths):
    sampler = mi.load_dict({"type": "multijitter", "sample_count": paths})
    if sampler.sample_count() == paths:
        check_paths(paths)
    else:
        with pytest.raises(PathCountError, match=f"--samples is {paths}"):
            check_paths(paths)


def test_the_nearest_counts_are_named():
    with pytest.raises(PathCountError, match="choose 30 or 35"):
        check_paths(32)
    with pytest.raises(PathCountError, match="choose 120 or 140"):
        check_paths(128, rays=4)


def test_generating_with_such_a_count_ends_in_one_sentence(tmp_path, capsys):
    command = ["synbrdf", "generate", "--out", str(tmp_path / "set"), "--unseen", "1"]
    assert main([*command, "--samples", "32"]) != 0
    sentence = capsys.readouterr().err.strip()
    assert "choose 30 or 35" in sentence
    assert "\n" not in sentence
    assert not (tmp_path / "set").exists()
