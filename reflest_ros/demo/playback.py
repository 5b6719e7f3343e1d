# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimator and bag player as processes of their own, and a listener to what comes of them."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rclpy
from builtin_interfaces.msg import Time
from numpy.typing import NDArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.msg import MaterialMap
from reflest_ros.outputs.estimate_message import estimate_from_message
from reflest_ros.outputs.material_message import POINT
from reflest_ros.outputs.material_output import TOPIC
from reflest_ros.process import use_private_domain
from reflest_ros.settings import NODE_NAME
from reflest_ros.srv import Estimate, SaveScan

ESTIMATOR = [
    "-m",
    "reflest_ros.estimator",
    "--ros-args",
    "--log-level",
    "reflest_estimator:=info",
    "-p",
    "input.reliability:=reliable",
    "-p",
    "input.queue_size:=2000",
]
SCAN = "scan.npz"
"""What the node saves, in the demo's output folder."""
START_LIMIT = 240.0
"""Seconds; the first start after installation compiles."""
ESTIMATE_LIMIT = 60.0


class DemoError(ReflestError):
    """A process of the demo ended early or did not answer."""


@dataclass(frozen=True)
class Played:
    """What the node published of a whole capture.

    Attributes:
        estimate: The BRDF of the middle of the view.
        materials: Estimates of all materials, by id.
        voxels: (N,) the material cloud's records.
        scan: File that the node saved the scan to.
    """

    estimate: BrdfEstimate
    materials: dict[int, BrdfEstimate]
    voxels: NDArray[np.void]
    scan: Path


class EstimateListener(Node):
    """Prints what is published at keyframes, and keeps the latest materials.

    Attributes:
        materials: The latest map.
        cloud: The latest cloud of materials.
    """

    def __init__(self, context: Context) -> None:
        """Subscribe.

        Args:
            context: of rclpy.
        """
        super().__init__("reflest_demo", context=context)
        self.create_subscription(
            BrdfEstimateMessage, "/reflectance/brdf", self._on_estimate, OUTPUT_QOS
        )
        self.materials, self.cloud = MaterialMap(), PointCloud2()
        self.create_subscription(MaterialMap, f"/{TOPIC}", self._on_materials, OUTPUT_QOS)
        self.create_subscription(
            PointCloud2, "/reflectance/material_cloud", self._on_cloud, OUTPUT_QOS
        )
        self.estimate_now = self.create_client(Estimate, f"/{NODE_NAME}/estimate")
        self.save_scan = self.create_client(SaveScan, f"/{NODE_NAME}/save")

    def has_materials_of(self, stamp: Time) -> bool:
        """Whether map and cloud are those of a keyframe.

        Args:
            stamp: of the keyframe's image.
        """
        return bool(self.materials.header.stamp == stamp == self.cloud.header.stamp)

    def _on_cloud(self, message: PointCloud2) -> None:
        self.cloud = message

    def _on_materials(self, message: MaterialMap) -> None:
        self.materials = message
        if message.materials:
            print(
                f"  /reflectance/materials  {len(message.materials)} materials on "
                f"{message.voxel_count:,} voxels",
                flush=True,
            )

    def _on_estimate(self, message: BrdfEstimateMessage) -> None:
        estimate = estimate_from_message(message)
        if estimate.status is EstimateStatus.UNKNOWN:
            return  # a new scan begins
        red, green, blue = estimate.rho_d
        print(
            f"  /reflectance/brdf  rho_d {red:.3f} {green:.3f} {blue:.3f}  rho_s "
            f"{estimate.rho_s:.3f}  alpha {estimate.alpha:.3f}  from {estimate.view_count:3d} views"
            f", {1000 * estimate.latency:.0f} ms after its image",
            flush=True,
        )


def play_over_dds(bag: Path, output: Path) -> Played:
    """Play ``bag`` to an estimator process; what it publishes of the whole scan.

    Args:
        bag: the recording.
        output: folder that the node may write to.

    Raises:
        DemoError: A process fails or takes too long.
    """
    output.mkdir(parents=True, exist_ok=True)
    use_private_domain()
    context = Context()
    rclpy.init(context=context)
    listener = EstimateListener(context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(listener)
    try:
        files = ["-p", f"files.root:={output.resolve()}"]
        with running([*ESTIMATOR, *files]) as estimator:
            _wait_for_start(listener, executor, estimator)
            with running(["-m", "reflest_ros.bag_player", str(bag)]) as player:
                while player.poll() is None:
                    executor.spin_once(timeout_sec=0.1)
                if player.returncode != 0:
                    raise DemoError(f"the bag player ended with exit code {player.returncode}")
            estimate = _final_estimate(listener, executor, estimator)
            _save(listener, executor)
        if estimator.returncode != 0:
            raise DemoError(f"the estimator ended with exit code {estimator.returncode}")
        materials = {
            int(one.id): estimate_from_message(one.estimate) for one in listener.materials.materials
        }
        voxels = np.frombuffer(listener.cloud.data, POINT)
        return Played(estimate, materials, voxels, output / SCAN)
    finally:
        listener.destroy_node()
        executor.shutdown()
        context.try_shutdown()


@contextlib.contextmanager
def running(arguments: list[str]) -> Iterator[subprocess.Popen[bytes]]:
    """A Python process for the block; SIGINT ends it, and what ignores that is killed.

    Args:
        arguments: the words of the command.
    """
    process = subprocess.Popen([sys.executable, *arguments])
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            process.wait(20.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait_for_start(
    listener: EstimateListener,
    executor: SingleThreadedExecutor,
    estimator: subprocess.Popen[bytes],
) -> None:
    deadline = listener.get_clock().now().nanoseconds + START_LIMIT * 1e9
    while not listener.estimate_now.service_is_ready():
        executor.spin_once(timeout_sec=0.1)
        if estimator.poll() is not None:
            raise DemoError(f"the estimator ended with exit code {estimator.returncode}")
        if listener.get_clock().now().nanoseconds > deadline:
            raise DemoError(f"the estimator did not start in {START_LIMIT:g} s")


def _final_estimate(
    listener: EstimateListener,
    executor: SingleThreadedExecutor,
    estimator: subprocess.Popen[bytes],
) -> BrdfEstimate:
    answer = listener.estimate_now.call_async(Estimate.Request())
    executor.spin_until_future_complete(answer, ESTIMATE_LIMIT)
    response = answer.result()
    if response is None:
        raise DemoError(f"the estimator (exit code {estimator.poll()}) did not answer in time")
    if not response.success:
        raise DemoError(f"there is no estimate: {response.message}")
    deadline = listener.get_clock().now().nanoseconds + ESTIMATE_LIMIT * 1e9
    while not listener.has_materials_of(response.estimate.header.stamp):
        executor.spin_once(timeout_sec=0.1)
        if listener.get_clock().now().nanoseconds > deadline:
            raise DemoError(f"no materials came within {ESTIMATE_LIMIT:g} s of the last estimate")
    return estimate_from_message(response.estimate)


def _save(listener: EstimateListener, executor: SingleThreadedExecutor) -> None:
    answer = listener.save_scan.call_async(SaveScan.Request(path=SCAN))
    executor.spin_until_future_complete(answer, ESTIMATE_LIMIT)
    response = answer.result()
    if response is None or not response.success:
        reason = "no answer in time" if response is None else response.message
        raise DemoError(f"the scan was not saved: {reason}")
