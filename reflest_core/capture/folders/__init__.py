# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Folders of images, depth maps and poses, as data sets and phone scanners write them."""
