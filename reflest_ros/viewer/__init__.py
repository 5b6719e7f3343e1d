# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The page of ``reflest view`` for a node that runs: a process of its own, which slows no node."""
