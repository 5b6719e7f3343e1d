# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the first frame would have to wait for is there before it."""

import subprocess
import sys

SCRIPT = """
from reflest_core.capture.images import decode
from reflest_core.capture.settings import CaptureSettings
from reflest_core.capture.warm_up import warm_up
warm_up()
before = decode._metres_by_unit.cache_info()
decode._metres_by_unit(CaptureSettings().depth_unit(), False)
after = decode._metres_by_unit.cache_info()
assert (after.misses, after.hits) == (before.misses, before.hits + 1)
"""


def test_the_table_of_metres_is_filled():
    """In a process of its own, where no other test has filled it."""
    subprocess.run([sys.executable, "-c", SCRIPT], check=True)
