# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A domain for each test module, the node as a process, and what peers need."""

from __future__ import annotations

import re
import subprocess
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path

import domain_coordinator
import pytest
from feed import Feed
from own_process import ROOT, OwnProcess, participants
from ros_peer import RosPeer
from sphere_messages import write_sphere_bag

from test.waiting import wait_until

COMPILE_TIME = 600.0
"""Seconds in which the first start after installation is over, on a slow machine."""

LINTED = ("reflest_core", "reflest_ros", "launch", "scripts", "setup.py")
"""What is installed, and what builds it; ``make lint`` takes the tests and benchmarks too."""

SETTINGS = """\
/**:
  ros__parameters:
    input: {reliability: reliable, queue_size: 1000, settle: 0.5, diagnostics_period: 0.05}
    fusion: {voxel_size: 0.01}
    region: {shape: sphere, centre: [0.0, 0.0, 0.12], size: [0.35, 0.35, 0.35]}
    keyframe: {translation: 0.2}
"""


@pytest.fixture(scope="session", autouse=True)
def _one_machine() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        profile = ROOT / "config" / "fastdds_large_messages.xml"
        patch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(profile))
        yield


@pytest.fixture(scope="session")
def linters() -> Iterator[dict[str, subprocess.Popen[str]]]:
    """ROS' linters, as processes of low priority: they take a minute."""
    (pep257,) = re.findall(r"ament_pep257\(([^)]*)\)", (ROOT / "CMakeLists.txt").read_text())
    commands = (
        ("ament_flake8", "--config", ".ci/ament_flake8.ini", *LINTED),
        ("ament_pep257", *re.findall(r'"([^"]+)"', pep257), "--", *LINTED),
        # ament_lint_cmake is cmakelint with lines of up to 140 characters.
        ("cmakelint", "--linelength=140", "CMakeLists.txt"),
    )
    programs = Path(sysconfig.get_path("scripts"))
    started = {
        program: subprocess.Popen(
            ["nice", "-n", "10", str(programs / program), *arguments],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        for program, *arguments in commands
    }
    yield started
    for process in started.values():
        process.kill()
        process.wait()


@pytest.fixture(scope="session", autouse=True)
def _linters_run_beside_other_tests(request: pytest.FixtureRequest) -> None:
    """Start them with the first test, if they are asked for: tests of nodes mostly wait."""
    if any("linters" in getattr(item, "fixturenames", ()) for item in request.session.items):
        request.getfixturevalue("linters")


@pytest.fixture(scope="session")
def settings_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("settings") / "estimator.yaml"
    root = tmp_path_factory.getbasetemp()
    path.write_text(f"{SETTINGS}    files: {{root: {root}}}\n")
    return path


@pytest.fixture(scope="session")
def sphere_bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_sphere_bag(tmp_path_factory.mktemp("bags") / "sphere")


@pytest.fixture(scope="module")
def domain_id() -> Iterator[int]:
    """A domain of the module's own; no participant of this process may be left in it.

    The next module gets the same number. Clients would find a left node's services, which answer
    nothing, before those of the node that they are meant for.
    """
    with domain_coordinator.domain_id() as number:
        yield int(number)
    wait_until(lambda: not participants(), "a node of this module is left")


@pytest.fixture(scope="module")
def start(domain_id: int) -> Iterator[Callable[..., OwnProcess]]:
    """Start a module of the package; what still runs at the end is killed."""
    processes: list[OwnProcess] = []

    def started(module: str, *arguments: str, **environment: str) -> OwnProcess:
        processes.append(OwnProcess(module, list(map(str, arguments)), domain_id, environment))
        return processes[-1]

    yield started
    for process in processes:
        process.end()


@pytest.fixture(scope="module")
def node(start: Callable[..., OwnProcess], settings_file: Path) -> OwnProcess:
    """A node with the tests' settings that is ready."""
    process = start("reflest_ros.estimator", "--ros-args", "--params-file", settings_file)
    process.wait_for_line("listening to", COMPILE_TIME)
    return process


@pytest.fixture(scope="module")
def feed(node: OwnProcess, peer: RosPeer) -> Iterator[Feed]:
    """Views sent to the node; it must outlive the module's tests."""
    yield Feed(node, peer)
    assert node.is_running
    assert "Traceback" not in node.output


@pytest.fixture(scope="module")
def peer(domain_id: int) -> Iterator[RosPeer]:
    peer = RosPeer(domain_id)
    yield peer
    peer.close()
