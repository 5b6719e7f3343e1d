# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Names the packages: this file lies in the package that it installs."""

from setuptools import find_namespace_packages, setup

# Folders of data, such as the weights', count as packages too.
subpackages = find_namespace_packages(exclude=["build*", "*__pycache__*", "*.egg-info"])
setup(
    package_dir={"reflest_core": "."},
    packages=["reflest_core", *(f"reflest_core.{name}" for name in subpackages)],
)
