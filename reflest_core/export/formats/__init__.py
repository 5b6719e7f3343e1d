# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One module for each file format: an asset to files by name, the main file first."""
