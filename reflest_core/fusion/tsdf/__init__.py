# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The truncated signed distance volume and the surface extracted from it."""
