# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shapes of SynBRDF's objects: procedural ones, and meshes from files."""
