# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a BRDF: a sphere under an environment or a point light. Not on the live path."""
