# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan as one HTML file that needs nothing else: to mail, and to open without a network."""
