# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""reflest_ros: the ROS 2 node around reflest_core.

The generated ``reflest_ros.msg`` and ``reflest_ros.srv`` are installed apart from a checkout;
extending the path lets both halves meet in one package.
"""

from pkgutil import extend_path

__path__ = extend_path(__path__, __name__)
