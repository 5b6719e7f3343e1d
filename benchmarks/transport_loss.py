# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks.transport_loss``: images lost between two processes over Fast DDS.

Best-effort VGA colour and depth at camera speed, as drivers send and the estimator requests them by
default: with Fast DDS as installed, and with the shared-memory profile in config/.
"""

from __future__ import annotations

import argparse
import array
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from std_msgs.msg import Empty

from benchmarks.measuring.machine import ROOT, describe_machine
from reflest_ros.inputs.publication_gaps import PublicationGaps, with_message_info
from reflest_ros.inputs.qos import OUTPUT_QOS, input_qos
from reflest_ros.process import PROFILE, PROFILE_VARIABLE

STREAMS = {"rgb": ("rgb8", 3), "depth": ("16UC1", 2)}  # encoding, bytes of a pixel
WIDTH, HEIGHT = 640, 480
MATCH_LIMIT = 60.0
"""Seconds in which the two processes must have found each other."""


class Publisher(Node):
    """A camera: sends both images at a rate, then a message that it has ended."""

    def __init__(self) -> None:
        super().__init__("loss_publisher")
        qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._outputs = {name: self.create_publisher(Image, name, qos) for name in STREAMS}
        self._end = self.create_publisher(Empty, "end", OUTPUT_QOS)

    def run(self, seconds: float, rate: float) -> None:
        """Wait for the receiver, then send.

        Args:
            seconds: Duration.
            rate: Hz.
        """
        images = {name: _image(*kind) for name, kind in STREAMS.items()}
        outputs = [*self._outputs.values(), self._end]
        deadline = time.monotonic() + MATCH_LIMIT
        while not all(output.get_subscription_count() for output in outputs):
            if time.monotonic() > deadline:
                sys.exit("the receiver was not found")
            rclpy.spin_once(self, timeout_sec=0.05)
        started = time.monotonic()
        for number in range(round(seconds * rate)):
            time.sleep(max(started + number / rate - time.monotonic(), 0.0))
            for name, output in self._outputs.items():
                output.publish(images[name])
        self._end.publish(Empty())
        self._end.wait_for_all_acked()


class Receiver(Node):
    """Counts what the estimator's subscriptions would receive."""

    def __init__(self) -> None:
        super().__init__("loss_receiver")
        self.received = dict.fromkeys(STREAMS, 0)
        self.reported_lost = 0
        self.has_ended = False
        for name in STREAMS:
            self.create_subscription(Image, name, self._counting(name), input_qos("best_effort"))
        self.create_subscription(Empty, "end", self._on_end, OUTPUT_QOS)

    def run(self) -> None:
        """Receive messages until the publisher has ended and none is in transit."""
        while not self.has_ended:
            rclpy.spin_once(self, timeout_sec=1.0)
        count = -1
        while count != sum(self.received.values()):
            count = sum(self.received.values())
            rclpy.spin_once(self, timeout_sec=0.5)

    def _counting(self, name: str) -> Callable[..., None]:
        gaps = PublicationGaps()

        def take(_: Image, info: dict[str, Any]) -> None:
            self.received[name] += 1
            number = info["publication_sequence_number"]
            self.reported_lost += gaps.lost_before(number, time.monotonic(), 1)

        return with_message_info(take)

    def _on_end(self, _: Empty) -> None:
        self.has_ended = True


def measure(profile: Path | None, seconds: float, rate: float, domain_id: int) -> dict[str, Any]:
    """Run both processes once.

    Args:
        profile: Fast DDS profile, or None for the default.
        seconds: Duration.
        rate: Hz.
        domain_id: The ROS domain.

    Returns:
        Numbers of images sent, received and lost.
    """
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain_id),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    environment.pop(PROFILE_VARIABLE, None)
    if profile is not None:
        environment[PROFILE_VARIABLE] = str(profile)
    command = [sys.executable, "-m", "benchmarks.transport_loss"]
    timing = ["--seconds", str(seconds), "--rate", str(rate)]
    receiver = subprocess.Popen(
        [*command, "receive"], cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True
    )
    try:
        subprocess.run([*command, "publish", *timing], cwd=ROOT, env=environment, check=True)
        output, _ = receiver.communicate(timeout=MATCH_LIMIT)
    finally:
        receiver.kill()
    came = json.loads(output)
    sent = len(STREAMS) * round(seconds * rate)
    received = sum(came["received"].values())
    return {
        "profile": profile.name if profile else None,
        "sent": sent,
        "received": received,
        "lost": 1.0 - received / sent,
        **came,
    }


def _image(encoding: str, pixel_bytes: int) -> Image:
    step = WIDTH * pixel_bytes
    image = Image(height=HEIGHT, width=WIDTH, encoding=encoding, step=step)
    image.data = array.array("B", bytes(HEIGHT * step))
    return image


def _run_role(role: str, seconds: float, rate: float) -> None:
    rclpy.init()
    if role == "publish":
        Publisher().run(seconds, rate)
    else:
        receiver = Receiver()
        receiver.run()
        print(json.dumps({"received": receiver.received, "reported_lost": receiver.reported_lost}))
    rclpy.try_shutdown()


def main() -> None:
    """Measure each set-up several times in turn, and print a line for each run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("role", nargs="?", choices=("publish", "receive"), help="one side alone")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=30.0, help="frames a second")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    if options.role:
        _run_role(options.role, options.seconds, options.rate)
        return
    print(json.dumps(describe_machine()))
    for run in range(options.runs):
        for turn, profile in enumerate((None, PROFILE)):
            domain_id = 100 + (os.getpid() + 2 * run + turn) % 100
            result = measure(profile, options.seconds, options.rate, domain_id)
            print(json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
