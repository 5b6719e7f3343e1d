# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Write the table of licences of every package that the lock files install.

    python scripts/licence_table.py > docs/reference/licences.md

Run it in the environment that ``make set-up`` makes: licences are read from the metadata of the
installed packages, and the table must name those of ``requirements/lock``.
"""

from __future__ import annotations

import argparse
import re
import sys
import xml.etree.ElementTree as ElementTree
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

LOCK = Path(__file__).resolve().parents[1] / "requirements" / "lock"
OTHERS = {
    "openexr": "BSD-3-Clause",
    "ros-fastcdr": "Apache-2.0",
    "ros-fastrtps": "Apache-2.0",
    "setuptools": "MIT",
}
"""Of packages whose metadata name none; from their licence file."""
LONGEST = 60
"""Characters of a licence; some packages put the whole text there."""
HEAD = """\
# Licences of what is installed

Written by `python scripts/licence_table.py`, from the metadata of the installed packages. "run"
is what the node and `make demo` install (`requirements/lock/run.txt`); "all" comes on top for
tests, training and documentation (`requirements/lock/all.txt`). PyTorch is pinned by its version
alone, for it has several builds; its licence is BSD-3-Clause, and its builds for CUDA bring
NVIDIA's libraries under NVIDIA's own terms.

One wheel, `ros_wheels_bootstrapper`, brings a file that Python runs at each start of the
environment's interpreter (`ros_wheels_bootstrapper.pth`): it sets the paths by which ROS finds
its shared libraries and message types (`AMENT_PREFIX_PATH`, `LD_LIBRARY_PATH`). An installation
from apt has no such file.

| package | version | licence | installed for |
| --- | --- | --- | --- |
"""


def locked(path: Path) -> dict[str, str]:
    """Return the versions in a lock file by package.

    Args:
        path: As ``make lock`` wrote it.
    """
    return dict(re.findall(r"^([a-z0-9-]+)==([^\s;]+)", path.read_text(), re.MULTILINE))


def licence(package: str) -> str:
    """Return what a package's metadata say of its licence, shortened.

    Args:
        package: An installed package.

    Raises:
        PackageNotFoundError: It is not installed.
    """
    about = metadata(package)
    if expression := about.get("License-Expression"):
        return str(expression)
    named = [
        line.rsplit("::", 1)[1].strip()
        for line in about.get_all("Classifier", [])
        if line.startswith("License ::") and line.count("::") > 1
    ]
    text = ", ".join(named) or next(iter((about.get("License") or "").strip().splitlines()), "")
    return text[:LONGEST] or _of_ros(package) or OTHERS.get(package, "not stated")


def _of_ros(package: str) -> str:
    """The licences in the manifest that a wheel of a ROS package brings, or ""."""
    name = re.sub("^ros-(jazzy-)?", "", package).replace("-", "_")
    manifest = Path(sys.prefix) / "share" / name / "package.xml"
    if not manifest.is_file():
        return ""
    return ", ".join(str(one.text) for one in ElementTree.parse(manifest).iter("license"))


def main() -> int:
    """Print the table.

    Returns:
        0, or 1 where a package of the lock is not installed.
    """
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    run, everything = locked(LOCK / "run.txt"), locked(LOCK / "all.txt")
    rows = []
    for package, version in sorted((run | everything).items()):
        try:
            found = licence(package)
        except PackageNotFoundError:
            print(f"{package} is not installed: make set-up docs", file=sys.stderr)
            return 1
        rows.append(f"| {package} | {version} | {found} | {'run' if package in run else 'all'} |")
    print(HEAD + "\n".join(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
