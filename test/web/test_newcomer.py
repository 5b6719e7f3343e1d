# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The first minutes with reflest: install the wheel, replay, look, click, export, validate, report.

The wheel goes into an empty virtual environment, whose libraries are those of these tests. Kernels
that were compiled before are copied, which a newcomer waits for.
"""

import fcntl
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import termios
import threading
import venv
from pathlib import Path

import pytest
from pxr import Usd

from reflest_core.jit import FIRST_RUN
from test.core.export.complaints import complaints
from test.web.browser import MODULES, WEB, opened, shown, still

ROOT = Path(__file__).parents[2]
CAPTURE = ROOT / "captures" / "glossy-red"
PATIENCE = 300_000
"""Milliseconds for the browser."""
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


@pytest.fixture(scope="module")
def reflest(tmp_path_factory):
    """The command that the wheel installs, and a folder to work in."""
    folder = tmp_path_factory.mktemp("newcomer")
    sources = shutil.copytree(
        ROOT / "reflest_core", folder / "source", ignore=shutil.ignore_patterns("__pycache__")
    )
    build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-q"]
    subprocess.run([*build, "-w", folder, sources], check=True, timeout=600)
    (wheel,) = folder.glob("*.whl")
    venv.create(folder / "env", with_pip=False)
    python = folder / "env" / "bin" / "python"
    install = [sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "-q"]
    subprocess.run([*install, wheel], check=True, timeout=600)
    asked = "import sysconfig; print(sysconfig.get_path('purelib'))"
    libraries = Path(subprocess.check_output([python, "-c", asked], text=True).strip())
    (libraries / "of_the_tests.pth").write_text(
        "\n".join(one for one in sys.path if "site-p" in one)
    )
    for one in (ROOT / "reflest_core").rglob("*.py"):
        installed = libraries / one.relative_to(ROOT)
        if installed.exists():
            shutil.copystat(one, installed)
    for one in (ROOT / "reflest_core").rglob("__pycache__/*.nb[ic]"):
        to = libraries / one.relative_to(ROOT)
        to.parent.mkdir(exist_ok=True)
        shutil.copy2(one, to)
    work = folder / "work"
    work.mkdir()
    return folder / "env" / "bin" / "reflest", work


def run(reflest, *words):
    """Run a command as a newcomer would; return what it printed."""
    command, work = reflest
    done = subprocess.run(
        [command, *map(str, words)],
        cwd=work,
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


def in_a_terminal(reflest, *words):
    """The same in a terminal of 110 columns."""
    command, work = reflest
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 110, 0, 0))
    process = subprocess.Popen(
        [command, *map(str, words)],
        cwd=work,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env=ENVIRONMENT,
    )
    os.close(theirs)
    printed = b""
    while True:
        try:
            read = os.read(ours, 4096)
        except OSError:  # as Linux says that the other end is closed
            break
        if not read:
            break
        printed += read
    os.close(ours)
    assert process.wait(600) == 0
    return printed.decode()


def test_the_whole_way_from_the_wheel_to_the_report(reflest):
    command, work = reflest
    where = subprocess.check_output(
        [command.with_name("python"), "-c", "import reflest_core; print(reflest_core.__file__)"],
        cwd=work,
        env=ENVIRONMENT,
        text=True,
    )
    assert str(command.parents[1]) in where

    # Replay: a bar with the rate and the time that remains, then the material.
    outputs = ("--json", "out.json", "--save-scan", "scan.npz", "--report", "report.html")
    printed = in_a_terminal(reflest, "replay", CAPTURE, *outputs)
    assert re.search(r"\d+/60 \[\d\d:\d\d<\d\d:\d\d, +[\d.]+(frame/s|s/frame)\]", printed)
    record = json.loads((work / "out.json").read_text())
    assert f"rho_s  {record['final']['rho_s']:.4f}" in printed

    look_and_click(reflest)

    # Export, validate, render.
    for name, file in (("glb", "blob.glb"), ("usd", "blob.usda")):
        assert run(reflest, "export", "scan.npz", "--format", name, "--out", file, "--faces", 3000)
    assert complaints(Usd.Stage.Open(str(work / "blob.usda"))) == []
    if MODULES.is_dir() and shutil.which("node"):
        validate = ["node", WEB / "validate_gltf.js", work / "blob.glb"]
        report = json.loads(subprocess.check_output(validate, timeout=600))
        assert report["numErrors"] == report["numWarnings"] == 0
        for file in ("blob.glb", "blob.usda"):
            assert (rendered(work, file).max(axis=2) > 0.05).mean() > 0.1

    # The report opens by itself and has the same values.
    with opened((work / "report.html").as_uri()) as (tab, problems):
        tab.locator("#model").wait_for(timeout=PATIENCE)
        estimate = record["materials"][0]["estimate"]
        assert f"{estimate['rho_s']:.3f}" in tab.locator("body").inner_text()
        assert problems == []


def look_and_click(reflest):
    """``reflest view``: click on the scan, read its material, end the command by Ctrl-C."""
    command, work = reflest
    view = subprocess.Popen(
        [command, "view", "scan.npz", "--port", "0"],
        cwd=work,
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell's background jobs, as these tests may be, ignore Ctrl-C.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    killer = threading.Timer(900.0, view.kill)
    try:
        killer.start()
        address = re.search(r"open (http://\S+)", view.stdout.readline())[1]
        with opened(address) as (tab, problems):
            tab.get_by_text("voxels").first.wait_for(timeout=PATIENCE)
            still(tab, is_red)
            tab.mouse.click(640, 430)
            tab.locator(".reflest-values").wait_for(timeout=PATIENCE)
            assert tab.get_by_text("Material 1").count()
            assert problems == []
        view.send_signal(signal.SIGINT)
        rest, errors = view.communicate(timeout=600)
    finally:
        killer.cancel()
        view.kill()
    assert view.returncode == 0
    # The first command that needs some of the kernels says that it compiles them.
    assert errors in ("", f"reflest: {FIRST_RUN}\n")
    assert "ended" in rest


def rendered(work, file):
    light = {"environment": "files/blob_environment.hdr"}
    return shown(
        "view_glb.html",
        work,
        work / "three.png",
        file=f"files/{file}",
        size=192,
        half=0.14,
        **light,
    )


def is_red(picture):
    """Whether a twentieth of an 8-bit picture is clearly redder than blue."""
    return (picture[..., 0] > picture[..., 2] + 25.5).mean() > 0.05
