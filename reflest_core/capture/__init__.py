# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Frames from topics, bags and folders: messages matched in time, decoded and checked."""
