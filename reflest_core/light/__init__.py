# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light around a surface: maps of it, how they are seen, exposed, completed and known."""
