# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The data card's figures and pictures, made from a generated set."""
