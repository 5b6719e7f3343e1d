"""Names the packages: this file lies in the package that it installs."""

from setuptools import find_packages, setup

subpackages = find_packages(exclude=["build*"])
setup(
    package_dir={"reflest_core": "."},
    packages=["reflest_core", *(f"reflest_core.{name}" for name in subpackages)],
)
