# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""tf2_msgs for tests: the installed one, else its one message built here (PyPI has none)."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

CMAKE = """\
cmake_minimum_required(VERSION 3.21)
project(tf2_msgs)
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
find_package(geometry_msgs REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME} "msg/TFMessage.msg" DEPENDENCIES geometry_msgs)
# The ROS wheels export include directories of the machine that built them.
get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
list(FILTER targets INCLUDE REGEX "__rosidl_generator_py$")
foreach(target IN LISTS targets ITEMS ${PROJECT_NAME}__rosidl_generator_py)
  set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "")
endforeach()
ament_package()
"""
MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>tf2_msgs</name>
  <version>0.0.0</version>
  <description>The message on /tf, for tests.</description>
  <maintainer email="reflest@users.noreply.github.com">The reflest developers</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>geometry_msgs</depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
</package>
"""
MESSAGE = "geometry_msgs/TransformStamped[] transforms\n"


def tf2_environment(folder: Path) -> dict[str, str]:
    """What a process needs in its environment to import tf2_msgs; builds it where it must."""
    if importlib.util.find_spec("tf2_msgs") is not None:
        return {}
    prefix = _built(folder)
    (python,) = prefix.glob("lib/python*/*-packages")
    libraries = [str(prefix / "lib"), os.environ.get("LD_LIBRARY_PATH", "")]
    return {"PYTHONPATH": str(python), "LD_LIBRARY_PATH": os.pathsep.join(libraries)}


def _built(folder: Path) -> Path:
    source, build, prefix = (folder / name for name in ("source", "build", "prefix"))
    (source / "msg").mkdir(parents=True)
    (source / "CMakeLists.txt").write_text(CMAKE)
    (source / "package.xml").write_text(MANIFEST)
    (source / "msg" / "TFMessage.msg").write_text(MESSAGE)
    environment = dict(os.environ)
    for variable in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
        environment[variable] = os.pathsep.join([sys.prefix, os.environ.get(variable, "")])
    environment["PATH"] = os.pathsep.join([f"{sys.prefix}/bin", os.environ["PATH"]])
    for arguments in (
        [
            "-S",
            source,
            "-B",
            build,
            f"-DCMAKE_INSTALL_PREFIX={prefix}",
            f"-DPython3_EXECUTABLE={sys.executable}",
        ],
        ["--build", build, "--parallel", "2"],
        ["--install", build],
    ):
        done = subprocess.run(
            ["cmake", *map(str, arguments)], env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stdout + done.stderr
    return prefix
