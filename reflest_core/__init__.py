# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""reflest_core: on-the-fly reflectance estimation, without ROS.

Stages, in the order in which data flows and in which they may import one another:
``brdf`` <- ``capture`` <- ``fusion`` <- ``features`` <- ``models`` <- ``estimation`` <- ``cli``.
``rendering``, ``synbrdf`` and ``training`` stand beside them; the live path never imports these.
"""

__version__ = "0.1.0"
