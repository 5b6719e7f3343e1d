# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Each example runs as a user runs it, and gives what it promises."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"


def run(arguments, cwd, timeout=1100):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=timeout,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def test_from_numpy_finds_the_albedo_of_its_ball(tmp_path):
    lines = run([EXAMPLES / "from_numpy.py"], tmp_path).splitlines()
    truth, found, deviation = (np.array(re.findall(r"\d\.\d+", line), float) for line in lines)
    assert truth.shape == (3,)
    assert (np.abs(found - truth) < 2.0 * deviation + 0.02).all()


def test_from_bag_writes_the_material_and_the_light(tmp_path):
    printed = run(
        [EXAMPLES / "from_bag.py", ROOT / "captures" / "glossy-red", tmp_path], tmp_path.parent
    )
    assert f"wrote {tmp_path / 'material.gltf'}" in printed
    red, green, blue = (float(v) for v in re.search(r"rho_d (\S+) (\S+) (\S+)", printed).groups())
    assert abs(red - 0.45) < 0.05
    assert max(abs(green - 0.06), abs(blue - 0.04)) < 0.02
    material = json.loads((tmp_path / "material.gltf").read_text())
    assert material["materials"]
    light = cv2.imread(str(tmp_path / "light.hdr"), cv2.IMREAD_UNCHANGED)
    assert light.max() > 0.0


def test_the_notebook_runs_from_its_first_cell_to_its_last(tmp_path):
    notebook = json.loads((EXAMPLES / "explore_a_capture.ipynb").read_text())
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(not cell["outputs"] for cell in cells)
    script = tmp_path / "notebook.py"
    script.write_text("\n".join("".join(cell["source"]) for cell in cells))
    printed = run([script], ROOT)
    assert printed.count("views  rho_s") == 4
    assert "cm2" in printed


def test_training_on_my_environments_ends_with_an_estimate(tmp_path):
    folder = tmp_path / "environments"
    folder.mkdir()
    rng = np.random.default_rng(5)
    for name in "abcdef":
        sky = cv2.resize(rng.random((4, 8, 3), np.float32), (64, 32)) * 2.0
        cv2.imwrite(str(folder / f"{name}.hdr"), sky)
    arguments = ["--scenes", "4", "--views", "6", "--minibatches", "2"]
    capture = ["--capture", ROOT / "captures" / "glossy-red"]
    script = EXAMPLES / "train_on_my_environments.py"
    printed = run([script, folder, tmp_path / "out", *arguments, *capture], tmp_path)
    assert "rho_d" in printed.splitlines()[-1] or "rho_d" in printed
