# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training of networks that see the surface alone."""
