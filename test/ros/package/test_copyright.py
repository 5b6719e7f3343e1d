# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Every source file states its copyright and its licence (REP 2004, 3.iv)."""

from __future__ import annotations

import subprocess

from own_process import ROOT


def test_every_source_file_begins_with_the_statement():
    missing = subprocess.run(
        [ROOT / ".ci" / "add_copyright", "--check"], cwd=ROOT, capture_output=True, text=True
    )
    assert missing.returncode == 0, f"run .ci/add_copyright for:\n{missing.stdout}"
