# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes the SROS2 policies of estimator and viewer from nodes that run.

``python -m reflest_ros.security_policy > config/sros2_policy.xml``; then
``ros2 security create_permission KEYSTORE /reflest_estimator config/sros2_policy.xml``. With the
word ``viewer``: config/sros2_viewer_policy.xml, for ``/reflest_viewer``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from xml.etree import ElementTree

from reflest_ros.node import EstimatorNode
from reflest_ros.process import ros_process, use_private_domain
from reflest_ros.settings import NODE_NAME
from reflest_ros.viewer.__main__ import ViewerNode
from reflest_ros.viewer.live_source import LiveSource

HEADER = """\
<?xml version="1.0" encoding="UTF-8"?>
<!--
  Copyright 2026 The reflest developers
  SPDX-License-Identifier: Apache-2.0
  What the estimator publishes, subscribes to and answers with its default parameters, and nothing
  else. Written by reflest_ros.security_policy; change the input topics to those of your camera.
-->
"""
VIEWER_HEADER = """\
<?xml version="1.0" encoding="UTF-8"?>
<!--
  Copyright 2026 The reflest developers
  SPDX-License-Identifier: Apache-2.0
  What the viewer subscribes to and asks the estimator for, and nothing else. Leave out services
  that its visitors may not call. Written by reflest_ros.security_policy.
-->
"""

SYSTEM_TOPICS = ("/clock", "/parameter_events")
"""Topics that rclpy subscribes to for the node."""


def security_policy() -> str:
    """Ask a node that runs what it uses.

    Returns:
        The policy as XML.
    """
    use_private_domain()
    with ros_process(["--ros-args", "--log-level", "error"]):
        node = EstimatorNode()
        try:
            node.bring_up()
            published = {one.topic_name for one in node.publishers} | {"/rosout"}
            subscribed = {one.topic_name for one in node.subscriptions} | set(SYSTEM_TOPICS)
            # Poses come from one of these; the transforms are needed by most robots.
            subscribed |= {"/tf", "/tf_static", node.resolve_topic_name("odom")}
            answered = {one.service_name for one in node.offered.all}
        finally:
            node.destroy_node()
    return HEADER + policy(NODE_NAME, published, subscribed, answered, ())


def viewer_policy() -> str:
    """Ask a viewer that runs what it uses.

    Returns:
        The policy as XML.
    """
    use_private_domain()
    with ros_process(["--ros-args", "--log-level", "error"]):
        node = ViewerNode()
        try:
            source = LiveSource(node, NODE_NAME, node.up)
            published = {one.topic_name for one in node.publishers} | {"/rosout"}
            subscribed = {one.topic_name for one in node.subscriptions} | set(SYSTEM_TOPICS)
            answered = {one.service_name for one in node.services}
            called = {node.resolve_service_name(name) for name in source.services}
            name = node.get_name()
        finally:
            node.destroy_node()
    return VIEWER_HEADER + policy(name, published, subscribed, answered, called)


def policy(
    node: str,
    published: Iterable[str],
    subscribed: Iterable[str],
    answered: Iterable[str],
    called: Iterable[str],
) -> str:
    """Write a policy.

    Args:
        node: Name of the node and its enclave.
        published: Full names of topics.
        subscribed: Full names of topics.
        answered: Full names of services.
        called: Full names of services.

    Returns:
        The policy as XML.
    """
    root = ElementTree.Element("policy", version="0.2.0")
    enclave = ElementTree.SubElement(
        ElementTree.SubElement(root, "enclaves"), "enclave", path=f"/{node}"
    )
    profile = ElementTree.SubElement(
        ElementTree.SubElement(enclave, "profiles"), "profile", ns="/", node=node
    )
    for group, kind, access, names in (
        ("topics", "topic", {"publish": "ALLOW"}, published),
        ("topics", "topic", {"subscribe": "ALLOW"}, subscribed),
        ("services", "service", {"reply": "ALLOW"}, answered),
        ("services", "service", {"request": "ALLOW"}, called),
    ):
        if not names:
            continue
        listed = ElementTree.SubElement(profile, group, access)
        for name in sorted(set(names)):
            ElementTree.SubElement(listed, kind).text = name.removeprefix("/")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


if __name__ == "__main__":
    print(viewer_policy() if sys.argv[1:] == ["viewer"] else security_policy(), end="")
