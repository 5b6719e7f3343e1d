# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The Ward BRDF, its perceptual twin Lab/c,d, and the losses on both."""
