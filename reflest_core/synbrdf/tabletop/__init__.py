# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes of many materials: objects on a table or in the corner of a room."""
