# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The node's name, under which its services and diagnostics are found."""

NODE_NAME = "reflest_estimator"
