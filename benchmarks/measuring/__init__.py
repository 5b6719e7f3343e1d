# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Clocks, memory, fresh processes and a description of the machine."""
