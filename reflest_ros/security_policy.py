# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes the SROS2 policy of the estimator from a node that runs.

``python -m reflest_ros.security_policy > config/sros2_policy.xml``; then
``ros2 security create_permission KEYSTORE /reflest_estimator config/sros2_policy.xml``.
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree

from reflest_ros.demo.playback import use_private_domain
from reflest_ros.node import EstimatorNode
from reflest_ros.process import ros_process
from reflest_ros.settings import NODE_NAME

HEADER = """\
<?xml version="1.0" encoding="UTF-8"?>
<!--
  Copyright 2026 The reflest developers
  SPDX-License-Identifier: Apache-2.0
  What the estimator publishes, subscribes to and answers with its default parameters, and nothing
  else. Written by reflest_ros.security_policy; change the input topics to those of your camera.
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
    return policy(published, subscribed, answered)


def policy(published: Iterable[str], subscribed: Iterable[str], answered: Iterable[str]) -> str:
    """Write a policy.

    Args:
        published: Full names of topics.
        subscribed: Full names of topics.
        answered: Full names of services.

    Returns:
        The policy as XML.
    """
    root = ElementTree.Element("policy", version="0.2.0")
    enclave = ElementTree.SubElement(
        ElementTree.SubElement(root, "enclaves"), "enclave", path=f"/{NODE_NAME}"
    )
    profile = ElementTree.SubElement(
        ElementTree.SubElement(enclave, "profiles"), "profile", ns="/", node=NODE_NAME
    )
    for group, kind, access, names in (
        ("topics", "topic", {"publish": "ALLOW"}, published),
        ("topics", "topic", {"subscribe": "ALLOW"}, subscribed),
        ("services", "service", {"reply": "ALLOW"}, answered),
    ):
        listed = ElementTree.SubElement(profile, group, access)
        for name in sorted(set(names)):
            ElementTree.SubElement(listed, kind).text = name.removeprefix("/")
    ElementTree.indent(root)
    return HEADER + ElementTree.tostring(root, encoding="unicode") + "\n"


if __name__ == "__main__":
    print(security_policy(), end="")
