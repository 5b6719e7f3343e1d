# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan that checks its poses: do depth maps meet, and if not, under which convention."""
