# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The networks of section 3.3, their weights and how they look at a surface."""
