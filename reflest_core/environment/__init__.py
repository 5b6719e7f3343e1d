# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The estimated light as a product: an equirectangular image in the world frame."""
