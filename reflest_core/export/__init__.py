# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate as a material that other programs read: glTF, USD, Mitsuba."""
