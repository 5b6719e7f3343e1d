# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes ``docs/node.md`` from the code and from a node that runs."""
