# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Builds the ROS interfaces with CMake, so that pip installs a package that a node can run from.

``pip install --no-build-isolation .`` needs requirements/build.txt installed beforehand. An
editable installation leaves the Python code in the checkout and installs the interfaces only.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

# setuptools provides distutils, and comes first.
from setuptools import Command, Distribution, setup
from distutils.command.install_data import install_data

from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent
PACKAGE = "reflest_ros"


class BuildInterfaces(Command):
    """Generate, compile and stage msg/ and srv/ under build/interfaces."""

    description = "generate the ROS interfaces with CMake"
    user_options: list[tuple[str, str, str]] = []

    def initialize_options(self) -> None:
        self.work = ROOT / "build" / "interfaces" / sysconfig.get_config_var("SOABI")
        self.stage = self.work / "stage"

    def finalize_options(self) -> None:
        self.work.mkdir(parents=True, exist_ok=True)

    def run(self) -> None:
        shutil.rmtree(self.stage, ignore_errors=True)
        environment = dict(os.environ)
        for variable in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
            known = environment.get(variable)
            environment[variable] = os.pathsep.join([sys.prefix, *([known] if known else [])])
        environment["PATH"] = os.pathsep.join([f"{sys.prefix}/bin", environment["PATH"]])
        build = self.work / "cmake"
        for arguments in (
            [
                "-S",
                ROOT,
                "-B",
                build,
                f"-DCMAKE_INSTALL_PREFIX={self.stage}",
                f"-DPython3_EXECUTABLE={sys.executable}",
                "-DREFLEST_INTERFACES_ONLY=ON",
            ],
            ["--build", build, "--parallel", str(os.cpu_count() or 1)],
            ["--install", build],
        ):
            subprocess.run(["cmake", *map(str, arguments)], env=environment, check=True)

    @property
    def python_files(self) -> list[Path]:
        """The staged files of the Python package that messages are imported from."""
        (package,) = self.stage.glob(f"lib/python*/*-packages/{PACKAGE}")
        files = [path for path in package.rglob("*") if path.suffix in (".py", ".so")]
        return [path for path in files if path.parent != package or path.name != "__init__.py"]

    @property
    def prefix_files(self) -> list[Path]:
        """The staged files that belong below the prefix: libraries, headers, the ament index."""
        inside_python = self.stage / "lib" / f"python{sysconfig.get_python_version()}"
        files = [path for path in self.stage.rglob("*") if path.is_file()]
        return [path for path in files if inside_python not in path.parents]


class BuildPy(build_py):
    """Adds the generated half of reflest_ros."""

    def run(self) -> None:
        self.run_command("build_interfaces")
        super().run()
        if not self.editable_mode:
            for path in self.get_finalized_command("build_interfaces").python_files:
                self.copy_file(str(path), str(self._in_package(path)))

    def _in_package(self, path: Path) -> Path:
        inside = path.parts[path.parts.index(PACKAGE, len(path.parts) - 3) :]
        target = Path(self.build_lib).joinpath(*inside)
        target.parent.mkdir(parents=True, exist_ok=True)
        return target


class InstallData(install_data):
    """Installs what belongs below the prefix, where ROS looks for it."""

    def run(self) -> None:
        self.run_command("build_interfaces")
        interfaces = self.get_finalized_command("build_interfaces")
        files = list(interfaces.prefix_files)
        self.data_files = list(self.data_files or [])
        if self.get_finalized_command("build_py").editable_mode:
            files += interfaces.python_files
            package = Path(sysconfig.get_path("platlib")).relative_to(sys.prefix) / PACKAGE
            self.data_files.append((str(package), [f"{PACKAGE}/__init__.py"]))
        for path in files:
            folder = path.relative_to(interfaces.stage).parent
            self.data_files.append((str(folder), [str(path)]))
        super().run()


class InterfaceDistribution(Distribution):
    """A distribution with compiled interfaces: its wheel fits one Python on one platform."""

    def has_ext_modules(self) -> bool:
        return True

    def has_data_files(self) -> bool:
        return True

    # The name by which setuptools asks in an editable installation.
    has_data = has_data_files


setup(
    distclass=InterfaceDistribution,
    cmdclass={
        "build_interfaces": BuildInterfaces,
        "build_py": BuildPy,
        "install_data": InstallData,
    },
)
