# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Plays a bag over DDS where there is no ``ros2 bag``: ``reflest-bag-player BAG [--rate 1.0]``.

Every message is published reliably as it was recorded, ``/tf_static`` latched. The player waits
until each topic has a subscriber, and at the end until the reliable ones have acknowledged all.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.utilities import remove_ros_args

from reflest_core.capture.formats.bag import READERS_BY_SUFFIX
from reflest_core.capture.formats.bag_file import BagFile, BagTopic, RawMessage
from reflest_core.capture.refusal import CaptureError
from reflest_core.cli.parser import Parser
from reflest_core.errors import ReflestError
from reflest_ros.process import ignore_signals, ros_process

WRITER_DEPTH = 400
"""Messages that a writer keeps for readers which have not acknowledged them."""

FIXED_TOPICS = ("/tf", "/tf_static", "/clock", "/rosout", "/parameter_events")
"""Topics that have the same name in every namespace."""


class BagPlayer(Node):
    """Publishes the messages of bag files on their topics."""

    def __init__(self, files: list[BagFile], topics: list[str]) -> None:
        """Advertise ``topics`` of the bag, all where none is named.

        Args:
            files: opened recordings.
            topics: to play; all if empty.
        """
        super().__init__("reflest_bag_player")
        self._files = files
        known = {topic.name: topic for file in files for topic in file.topics}
        missing = [name for name in topics if name not in known]
        if missing:
            raise CaptureError(f"the bag has no topic {missing[0]}; it has {', '.join(known)}")
        self._outputs = {name: self._advertise(known[name]) for name in topics or known}

    def _advertise(self, topic: BagTopic) -> Publisher:
        package, _, name = topic.message_type.split("/")
        try:
            message_type = getattr(importlib.import_module(f"{package}.msg"), name)
        except (ImportError, AttributeError) as error:
            raise CaptureError(
                f"{topic.name} is {topic.message_type}, which is not installed; leave it out by "
                "naming the others with --topics"
            ) from error
        is_latched = topic.name.endswith("/tf_static")
        qos = QoSProfile(
            depth=WRITER_DEPTH,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=(
                DurabilityPolicy.TRANSIENT_LOCAL if is_latched else DurabilityPolicy.VOLATILE
            ),
        )
        return self.create_publisher(message_type, topic.name, qos)

    def wait_for_subscribers(self, timeout: float) -> None:
        """Return once every topic has a subscriber.

        Args:
            timeout: seconds.

        Raises:
            CaptureError: A topic has none when they are over.
        """
        deadline = time.monotonic() + timeout
        executor = SingleThreadedExecutor()
        executor.add_node(self)
        while unheard := self._unheard():
            if time.monotonic() > deadline:
                raise CaptureError(
                    f"nobody subscribes to {', '.join(unheard)} after {timeout:g} s; start the "
                    "estimator, or play fewer topics with --topics"
                )
            # Discovery changes the graph, which wakes the executor.
            executor.spin_once(timeout_sec=0.05)
        executor.remove_node(self)

    def play(self, rate: float) -> int:
        """Publish every message.

        Args:
            rate: times the recorded speed.

        Returns:
            The number of messages.
        """
        count = 0
        first_ns = None
        started = time.monotonic()
        for raw in self._messages():
            first_ns = raw.log_time_ns if first_ns is None else first_ns
            due = started + (raw.log_time_ns - first_ns) / 1e9 / rate
            time.sleep(max(due - time.monotonic(), 0.0))
            self._outputs[raw.topic].publish(raw.cdr)
            count += 1
        return count

    def wait_for_acknowledgement(self, timeout: float) -> None:
        """Return once reliable subscribers have acknowledged everything.

        Args:
            timeout: seconds for all topics together.

        Raises:
            CaptureError: One has not when they are over.
        """
        deadline = time.monotonic() + timeout
        for topic, output in self._outputs.items():
            # In slices, between which a signal is heard.
            while not output.wait_for_all_acked(Duration(seconds=0.1)):
                if time.monotonic() > deadline:
                    raise CaptureError(
                        f"a subscriber of {topic} did not acknowledge every message in "
                        f"{timeout:g} s"
                    )

    @property
    def damage(self) -> str | None:
        """What of the bag could not be read."""
        return "; ".join(file.damage for file in self._files if file.damage) or None

    def _messages(self) -> Iterator[RawMessage]:
        for file in self._files:
            yield from file.messages(list(self._outputs))

    def _unheard(self) -> list[str]:
        return [n for n, p in self._outputs.items() if p.get_subscription_count() == 0]


def open_bag_files(path: Path) -> list[BagFile]:
    """Open the files of a bag in recorded order.

    Args:
        path: one .mcap or .db3 file, or a directory of them.

    Raises:
        CaptureError: It holds no such file, or one that cannot be read.
    """
    paths = sorted(path.iterdir()) if path.is_dir() else [path]
    files = [READERS_BY_SUFFIX[one.suffix](one) for one in paths if one.suffix in READERS_BY_SUFFIX]
    if not files:
        raise CaptureError(f"{path} is no bag: expected an .mcap or .db3 file, or their directory")
    return files


def namespace_remaps(bag: Path, namespace: str) -> list[str]:
    """Move a bag's topics into the namespace of the node that listens to them.

    Args:
        bag: A rosbag2 folder or file.
        namespace: Of the node, with or without a leading slash.

    Returns:
        One ``from:=to`` for each topic, for ``ros2 bag play --remap``.

    Raises:
        CaptureError: The bag cannot be read.
    """
    prefix = namespace.strip("/")
    names = {topic.name for file in open_bag_files(bag) for topic in file.topics}
    moved = sorted(names - set(FIXED_TOPICS)) if prefix else []
    return [f"{name}:=/{prefix}{name}" for name in moved]


def parse_arguments(arguments: list[str]) -> argparse.Namespace:
    """The command line without its ROS arguments.

    Args:
        arguments: the words of the command.
    """
    parser = Parser(prog="reflest-bag-player", description=__doc__)
    parser.add_argument("bag", type=Path, help=".mcap or .db3 file, or rosbag2 directory")
    parser.add_argument("--rate", type=float, default=1.0, help="times the recorded speed")
    parser.add_argument(
        "--topics", nargs="+", default=[], help="play these topics alone; default: all"
    )
    parser.add_argument("--wait", type=float, default=30.0, help="seconds to wait for subscribers")
    options = parser.parse_args(arguments)
    if not options.rate > 0:
        parser.error("--rate must be above 0")
    return options


def main(args: list[str] | None = None) -> int:
    """Play and exit; 2 for a user's mistake.

    Args:
        args: the words of the command; None takes those of the process.
    """
    arguments = sys.argv if args is None else [sys.argv[0], *args]
    options = parse_arguments(remove_ros_args(arguments)[1:])
    try:
        with ros_process(arguments):
            _play(options)
    except (ReflestError, OSError) as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    return 0


def _play(options: argparse.Namespace) -> None:
    player = BagPlayer(open_bag_files(options.bag), options.topics)
    try:
        player.wait_for_subscribers(options.wait)
        count = player.play(options.rate)
        player.wait_for_acknowledgement(options.wait)
        print(f"played {count} messages of {options.bag}")
        if player.damage:
            print(f"reflest: warning: {player.damage}", file=sys.stderr)
    finally:
        ignore_signals()
        player.destroy_node()


if __name__ == "__main__":
    sys.exit(main())
