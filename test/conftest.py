# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What holds for every test."""

from hypothesis import settings

# Machines that run the tests are shared: a pause there says nothing about the code.
settings.register_profile("reflest", deadline=None)
settings.load_profile("reflest")
