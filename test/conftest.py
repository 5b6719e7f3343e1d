# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What holds for every test."""

import os
import signal

from hypothesis import HealthCheck, settings

# Machines that run the tests are shared: a pause there says nothing about the code. Every run tries
# the same examples, so that a change alone can turn a test red; ``make stress`` draws new ones.
settings.register_profile(
    "reflest",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=not os.environ.get("REFLEST_STRESS"),
)
settings.load_profile("reflest")

# A shell's background jobs ignore Ctrl-C, and the programs that tests start would inherit that.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
