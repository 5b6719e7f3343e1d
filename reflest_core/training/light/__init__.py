# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training of ``lightnet`` on simulated scans, each with the light that its views show."""
