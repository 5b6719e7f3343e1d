# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes relit by other environments, and their light as a scan sees it."""
