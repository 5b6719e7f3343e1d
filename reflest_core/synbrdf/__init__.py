# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""SynBRDF: physically-based synthetic scans with known materials. Not on the live path."""
