# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Every field of every message damaged: no crash, no frame of nonsense, the store unharmed.

Messages go the whole way, through the assembler into the scan. Each example damages some fields of
some frames' messages; all examples together have more than 2,500 damaged frames.
"""

import zlib
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import (
    CompressedImageMessage,
    PoseMessage,
    Role,
    TransformsMessage,
)
from reflest_core.capture.refusal import FrameRefused
from reflest_core.capture.settings import CaptureSettings
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.capture.images.test_rvl import message as rvl_message
from test.core.capture.recording import (
    PERIOD_NS,
    START_NS,
    camera_pose,
    colour_of,
    depth_message,
    depth_of,
    info_message,
    pose_message,
    rgb_message,
)
from test.core.fusion.scan_state import state_of

CAMERA = "camera_color_optical_frame"
DEPTH_CAMERA = "camera_depth_optical_frame"
CLOCK_JUMP_PERIODS = 4
GOOD_BEFORE_FUSED = 6 + CLOCK_JUMP_PERIODS
"""Wrong stamps may cost the frames of one clock jump: those before a stamp that was ahead, or those
that look like the time before a jump that two wrong stamps agreed on."""

any_float = st.one_of(
    st.floats(), st.sampled_from([0.0, 1.0, -1.0, 1e-320, 1e300, float("inf"), float("nan")])
)
uint32 = st.one_of(
    st.integers(0, 2**32 - 1), st.sampled_from([0, 1, 2, 36, 48, 72, 96, 192, 2**31, 2**32 - 1])
)
stamps = st.one_of(
    st.integers(-(2**31) * 10**9, 2**31 * 10**9),
    st.integers(START_NS - 10**9, START_NS + 10**9),
    st.sampled_from([0, -1, 2**31 * 10**9 - 1, -(2**31) * 10**9]),
)
frames = st.sampled_from(
    ["", "/", CAMERA, f"/{CAMERA}", DEPTH_CAMERA, "map", "base", "\0", "é" * 99]
)
header = {"stamp_ns": stamps, "frame_id": frames}
encodings = st.one_of(
    st.sampled_from(["rgb8", "bgr8", "rgba8", "mono8", "16UC1", "32FC1", "8UC1", "mono16", ""]),
    st.text(max_size=8),
)
pixels = st.one_of(
    st.binary(max_size=64),
    st.sampled_from([96 * 72, 2 * 96 * 72, 3 * 96 * 72, 4 * 96 * 72]).map(bytes),
    st.integers(0, 2**32).map(lambda seed: np.random.default_rng(seed).bytes(4 * 96 * 72)),
)
image = {
    **header,
    "height": uint32,
    "width": uint32,
    "encoding": encodings,
    "is_bigendian": st.booleans(),
    "step": uint32,
    "data": pixels,
}
info = {
    **header,
    "width": uint32,
    "height": uint32,
    "k": st.lists(any_float, min_size=9, max_size=9).map(tuple),
    "d": st.lists(any_float, max_size=15).map(tuple),
    "distortion_model": st.sampled_from(
        ["", "plumb_bob", "rational_polynomial", "equidistant", "fisheye", "x"]
    ),
    "p": st.lists(any_float, min_size=12, max_size=12).map(tuple),
    "binning": st.tuples(uint32, uint32),
    "roi": st.tuples(uint32, uint32, uint32, uint32),
}
pose = {
    **header,
    "position": st.tuples(any_float, any_float, any_float),
    "orientation": st.tuples(any_float, any_float, any_float, any_float),
    "child_frame_id": frames,
}
FIELDS = {
    Role.RGB: image,
    Role.DEPTH: image,
    Role.CAMERA_INFO: info,
    Role.DEPTH_INFO: info,
    Role.POSE: pose,
}
damages = st.lists(
    st.one_of(
        *(
            st.tuples(st.just(role), st.just(name), values)
            for role, fields in FIELDS.items()
            for name, values in fields.items()
        )
    ),
    min_size=1,
    max_size=3,
)
damaged_frames = st.lists(damages, min_size=3, max_size=3)


def good_messages(index, stamp_ns):
    """One frame's messages; stamps are ``stamp_ns``, the view is one of twelve."""
    made = {
        Role.CAMERA_INFO: info_message(index % 12),
        Role.DEPTH_INFO: replace(info_message(index % 12), frame_id=DEPTH_CAMERA),
        Role.POSE: pose_message(index % 12),
        Role.RGB: rgb_message(index % 12),
        Role.DEPTH: depth_message(index % 12),
    }
    return {role: replace(message, stamp_ns=stamp_ns) for role, message in made.items()}


def digest(scan):
    """A checksum of every array that the scan would save."""
    return tuple(zlib.crc32(np.ascontiguousarray(array)) for array in state_of(scan).values())


class Pipeline:
    """Messages to the scan, as the node's fusion thread and the replay do it."""

    def __init__(self, **values):
        self.scan = Scan(
            FusionSettings(voxel_size=0.02, memory_budget_mb=16.0),
            RegionSettings("box", (0.0, 0.0, 0.0), (0.4, 0.4, 0.4)),
        )
        jump = CLOCK_JUMP_PERIODS * PERIOD_NS * 1e-9
        given = {"queue_size": 6, "pose_queue_size": 6, "clock_jump": jump, **values}
        self.settings = CaptureSettings(**given)
        self.stamp_ns = START_NS
        self.begin()
        assert all(self.fused(self.next_messages()) for _ in range(3))

    def begin(self):
        """A new assembler that has seen one good frame, and so the world's name; the scan stays."""
        self.assembler = FrameAssembler(
            self.settings, on_clock_jump=lambda _: self.scan.restart_clock()
        )
        for role, message in self.next_messages().items():
            self.assembler.add(role, message)
        self.scan.restart_clock()

    def next_messages(self):
        self.stamp_ns += PERIOD_NS
        return good_messages(self.stamp_ns // PERIOD_NS, self.stamp_ns)

    def fused(self, messages):
        """Add messages; return how many frames were fused; a refusal must change nothing."""
        count = 0
        for role, message in messages.items():
            for frame in self.assembler.add(role, message):
                assert np.isfinite(frame.T_world_camera).all()
                assert frame.depth.shape == frame.rgb.shape[:2]
                assert np.isfinite(frame.depth).all()
                before = digest(self.scan)
                try:
                    self.scan.fuse(frame)
                    count += 1
                except FrameRefused as refusal:
                    assert digest(self.scan) == before
                    self.assembler.refuse(refusal)
        return count

    def recovers(self):
        """After whatever came, good frames come out again, and the last is fused."""
        for _ in range(GOOD_BEFORE_FUSED):
            for role, message in self.next_messages().items():
                self.assembler.add(role, message)
        return self.fused(self.next_messages()) == 1


@pytest.fixture(scope="module")
def pipeline():
    return Pipeline()


def fuzzed(examples):
    return settings(
        max_examples=examples,
        suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
    )


@fuzzed(500)
@given(damaged_frames)
def test_damaged_fields_never_crash_nor_harm_the_store(pipeline, damaged):
    pipeline.begin()
    for changes in damaged:
        messages = pipeline.next_messages()
        for role, field, value in changes:
            messages[role] = replace(messages[role], **{field: value})
        before = digest(pipeline.scan)
        if pipeline.fused(messages) == 0:
            assert digest(pipeline.scan) == before
    assert pipeline.recovers()


GREY = cv2.imencode(".png", colour_of(0))[1].tobytes()
COMPRESSED = {
    Role.RGB: [("jpeg", cv2.imencode(".jpg", colour_of(0))[1].tobytes()), ("png", GREY)],
    Role.DEPTH: [
        (
            "16UC1; png",
            cv2.imencode(".png", np.round(depth_of(0) * 1000).astype("<u2"))[1].tobytes(),
        ),
        (
            "16UC1; compressedDepth rvl",
            rvl_message(np.round(depth_of(0) * 1000).astype("<u2")).data,
        ),
    ],
}
edits = st.lists(st.tuples(st.integers(0, 2**20), st.integers(0, 255)), max_size=8)


@fuzzed(400)
@given(
    st.sampled_from([(role, *one) for role, known in COMPRESSED.items() for one in known]),
    edits,
    st.one_of(st.none(), st.integers(0, 2**20)),
    st.one_of(st.none(), st.text(max_size=30), st.sampled_from(["32FC1; compressedDepth rvl"])),
)
def test_damaged_compressed_images_never_crash(pipeline, image, edits, length, form):
    role, real_form, data = image
    data = bytearray(data)
    for place, value in edits:
        data[place % len(data)] = value
    data = bytes(data[: None if length is None else length % (len(data) + 1)])
    pipeline.begin()
    messages = pipeline.next_messages()
    messages[role] = CompressedImageMessage(
        messages[role].stamp_ns, CAMERA, real_form if form is None else form, data
    )
    pipeline.fused(messages)
    assert pipeline.recovers()


transforms = st.lists(
    st.builds(
        PoseMessage,
        stamp_ns=stamps,
        frame_id=frames,
        position=pose["position"],
        orientation=st.one_of(pose["orientation"], st.just((0.0, 0.0, 0.0, 1.0))),
        child_frame_id=frames,
    ),
    max_size=4,
).map(lambda some: TransformsMessage(tuple(some)))


@pytest.fixture(scope="module")
def unregistered():
    """Depth in its own camera's frame, poses in tf: every message depends on transforms."""
    return Pipeline(depth_to_rgb=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))


@fuzzed(200)
@given(damaged_frames)
def test_damaged_fields_of_unregistered_depth_never_crash(unregistered, damaged):
    unregistered.begin()
    for changes in damaged:
        messages = unregistered.next_messages()
        messages[Role.DEPTH] = replace(messages[Role.DEPTH], frame_id=DEPTH_CAMERA)
        for role, field, value in changes:
            messages[role] = replace(messages[role], **{field: value})
        unregistered.fused(messages)
    assert unregistered.recovers()


@fuzzed(200)
@given(st.lists(st.tuples(st.sampled_from([Role.TF, Role.TF_STATIC]), transforms), max_size=4))
def test_damaged_transforms_never_crash_nor_move_a_frame(pipeline, messages):
    """Poses come on their topic; whatever tf says of other frames changes nothing."""
    pipeline.begin()
    for role, message in messages:
        pipeline.fused({role: message})
    messages = pipeline.next_messages()
    (frame,) = [
        frame
        for role, message in messages.items()
        for frame in pipeline.assembler.add(role, message)
    ]
    assert np.allclose(frame.T_world_camera, camera_pose(pipeline.stamp_ns // PERIOD_NS % 12))
