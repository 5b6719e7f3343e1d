# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rooms that stand about an object at arm's length: light that depends on the place in it."""
