# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""tf without tf2: chains, interpolation and refusals; nothing unknown becomes the identity."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from reflest_core.capture.messages import PoseMessage, TransformsMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.sync.transform_buffer import MOST_FRAMES, TransformBuffer

S = 10**9
floats = st.floats(-5, 5)
quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


def transform(parent, child, second=0.0, position=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0, 1.0)):
    return PoseMessage(round(second * S), parent, position, rotation, child)


def buffer_of(*transforms, static=()):
    buffer = TransformBuffer(longest_gap=1.0, jump=1.0)
    for one in transforms:
        assert buffer.add(TransformsMessage((one,)), False, "/tf") == []
    for one in static:
        assert buffer.add(TransformsMessage((one,)), True, "/tf_static") == []
    return buffer


def unit(quaternion):
    return tuple(np.array(quaternion) / np.linalg.norm(quaternion))


def scipys(position, quaternion):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat(quaternion).as_matrix()
    matrix[:3, 3] = position
    return matrix


@given(st.lists(st.tuples(st.tuples(floats, floats, floats), quaternions), min_size=4, max_size=4))
def test_a_chain_over_a_common_ancestor_is_the_product_of_scipys_matrices(links):
    names = [("map", "odom"), ("odom", "base"), ("base", "camera"), ("map", "tag")]
    links = [(position, unit(quaternion)) for position, quaternion in links]
    chain = [
        transform(*frames, position=position, rotation=rotation)
        for frames, (position, rotation) in zip(names, links, strict=True)
    ]
    odom, base, camera, tag = (scipys(*link) for link in links)
    found = buffer_of(chain[0], chain[1], static=chain[2:]).matrix("tag", "camera", 0)
    assert np.allclose(found, np.linalg.inv(tag) @ odom @ base @ camera, atol=1e-9)


@given(quaternions, quaternions, st.floats(0, 1))
def test_between_two_stamps_it_interpolates_as_scipy_does(first, last, share):
    first, last = unit(first), unit(last)
    buffer = buffer_of(
        transform("map", "camera", 1.0, (1.0, 2.0, 3.0), first),
        transform("map", "camera", 2.0, (2.0, 4.0, 6.0), last),
    )
    found = buffer.matrix("map", "camera", round((1.0 + share) * S))
    assert np.allclose(found[:3, 3], (1 + share) * np.array([1.0, 2.0, 3.0]), atol=1e-6)
    ends = Rotation.from_quat([first, last])
    expected = Slerp([0, 1], ends)(round(share * S) / S).as_matrix()
    turned = Rotation.from_matrix(expected.T @ found[:3, :3]).magnitude()
    opposite = abs(abs(np.dot(first, last))) < 1e-3  # half a turn has two shortest ways
    assert turned < 1e-5 or opposite


def test_a_pose_is_the_message_of_its_matrix():
    half = math.sqrt(0.5)
    buffer = buffer_of(transform("map", "camera", 1.0, (1.0, 2.0, 3.0), (0.0, 0.0, half, half)))
    pose = buffer.pose("map", "camera", S)
    assert pose.position == (1.0, 2.0, 3.0)
    assert np.allclose(np.abs(pose.orientation), (0.0, 0.0, half, half))
    assert (pose.stamp_ns, pose.frame_id, pose.child_frame_id) == (S, "map", "camera")


def test_only_what_can_no_longer_change_is_reached():
    buffer = buffer_of(
        transform("map", "odom", 1.0),
        transform("odom", "base", 2.0),
        static=[transform("base", "camera")],
    )
    assert buffer.has_reached("map", "camera", 1 * S)
    assert not buffer.has_reached("map", "camera", 2 * S), "odom has come to 1 s only"
    assert buffer.has_reached("odom", "camera", 2 * S), "odom is not on the way"
    assert buffer.has_reached("base", "camera", 99 * S), "static for good"
    assert not buffer.has_reached("map", "unheard_of", 0)


@pytest.mark.parametrize(
    ("target", "source", "second", "words"),
    [
        ("map", "camera", 0.5, ["camera", "begins at 1.000"]),
        ("map", "camera", 4.5, ["camera", "last one is of 4.000"]),
        ("map", "camera", 3.0, ["2.000 s apart", "max_transform_gap"]),
        ("map", "moon", 1.0, ["'moon'", "'map'", "camera, map", "does not join"]),
        ("map", "tag", 1.0, ["'tag'", "does not join"]),
    ],
)
def test_what_is_not_known_is_refused_by_name(target, source, second, words):
    buffer = buffer_of(
        *(transform("map", "camera", at) for at in (1.0, 2.0, 4.0)),
        static=[transform("wall", "tag")],
    )
    with pytest.raises(FrameRefused) as refusal:
        buffer.matrix(target, source, round(second * S))
    assert refusal.value.cause is RefusalCause.TRANSFORM_MISSING
    for word in words:
        assert word in str(refusal.value)


def test_an_empty_buffer_says_that_nothing_came():
    with pytest.raises(FrameRefused, match="holds nothing yet"):
        buffer_of().matrix("map", "camera", 0)


@pytest.mark.parametrize(
    ("bad", "word"),
    [
        (transform("map", "camera", position=(math.nan, 0.0, 0.0)), "NaN"),
        (transform("map", "camera", rotation=(0.0, 0.0, 0.0, 0.0)), "norm"),
        (transform("map", "map"), "joins no two frames"),
        (transform("", "camera"), "joins no two frames"),
        (transform("map", "/"), "joins no two frames"),
    ],
)
def test_a_bad_transform_is_refused_and_its_neighbours_are_taken(bad, word):
    buffer = buffer_of()
    good = transform("map", "lidar", position=(1.0, 0.0, 0.0))
    (refusal,) = buffer.add(TransformsMessage((bad, good)), False, "/tf")
    assert refusal.cause is RefusalCause.TRANSFORM_INVALID
    assert "/tf" in str(refusal)
    assert word in str(refusal)
    assert buffer.matrix("map", "lidar", 0)[0, 3] == 1.0
    assert not buffer.has_reached("map", "camera", 0)


def test_a_leading_slash_is_the_same_frame():
    buffer = buffer_of(transform("/map", "/camera", position=(1.0, 0.0, 0.0)))
    assert buffer.matrix("map", "/camera", 0)[0, 3] == 1.0


def test_a_loop_of_frames_ends_in_a_refusal():
    buffer = buffer_of(transform("a", "b"), transform("b", "a"))
    with pytest.raises(FrameRefused, match="does not join"):
        buffer.matrix("map", "a", 0)
    assert not buffer.has_reached("map", "b", 0)


def test_a_frame_that_moves_to_another_parent_follows_it():
    buffer = buffer_of(transform("map", "camera", 1.0), transform("odom", "camera", 2.0))
    assert not buffer.has_reached("map", "camera", S)
    assert buffer.has_reached("odom", "camera", S)


def test_after_a_clock_jump_static_transforms_stay():
    buffer = buffer_of(
        transform("map", "base", 9.0),
        transform("map", "ball", 1.0),
        static=[transform("base", "camera")],
    )
    buffer.forget_after(5 * S)
    assert buffer.has_reached("base", "camera", 0)
    assert not buffer.has_reached("map", "camera", 0)
    assert buffer.has_reached("map", "ball", 0), "it has jumped back already"


def test_a_frame_whose_clock_jumps_back_starts_again():
    buffer = buffer_of(*(transform("map", "camera", at) for at in (9.0, 10.0, 1.0, 1.5)))
    assert buffer.has_reached("map", "camera", round(1.4 * S))
    with pytest.raises(FrameRefused):
        buffer.matrix("map", "camera", 9 * S)


def test_memory_is_bounded_in_frames_and_in_time():
    buffer = buffer_of()
    many = tuple(transform("map", f"frame{index}") for index in range(MOST_FRAMES + 3))
    refusals = buffer.add(TransformsMessage(many), False, "/tf")
    assert [refusal.cause for refusal in refusals] == [RefusalCause.TRANSFORM_INVALID] * 3
    for step in range(400):
        buffer.add(TransformsMessage((transform("map", "frame0", step / 10),)), False, "/tf")
    with pytest.raises(FrameRefused, match="begins at"):
        buffer.matrix("map", "frame0", 20 * S)


names = st.sampled_from(["", "/", "map", "odom", "base", "camera", "x" * 300])
any_transform = st.builds(
    PoseMessage,
    stamp_ns=st.integers(-(2**62), 2**62),
    frame_id=names,
    position=st.tuples(*[st.floats()] * 3),
    orientation=st.one_of(
        st.tuples(*[st.floats()] * 4), st.just((0.0, 0.0, 0.0, 1.0)), quaternions.map(unit)
    ),
    child_frame_id=names,
)


@settings(max_examples=200)
@given(
    st.lists(st.tuples(st.lists(any_transform, max_size=5), st.booleans()), max_size=15),
    names,
    names,
    st.integers(-(2**62), 2**62),
)
def test_any_transforms_give_a_rigid_matrix_or_a_refusal(messages, target, source, stamp_ns):
    buffer = TransformBuffer(longest_gap=1.0, jump=1.0)
    for transforms, is_static in messages:
        buffer.add(TransformsMessage(tuple(transforms)), is_static, "/tf")
    try:
        matrix = buffer.matrix(target, source, stamp_ns)
    except FrameRefused as refusal:
        assert refusal.cause is RefusalCause.TRANSFORM_MISSING
        return
    assert np.allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-6)
    assert np.isfinite(matrix).all()


def test_a_static_transform_that_is_also_published_slowly_stays_usable():
    buffer = buffer_of(transform("base", "camera", 1.0), static=[transform("base", "camera")])
    buffer.add(TransformsMessage((transform("base", "camera", 3.0),)), False, "/tf")
    assert buffer.has_reached("base", "camera", 99 * S)
    assert np.array_equal(
        buffer.matrix("base", "camera", 2 * S), buffer.matrix("base", "camera", 50 * S)
    )


def test_a_frame_that_moves_away_from_its_static_place_moves():
    buffer = buffer_of(static=[transform("base", "camera")])
    moved = replace(transform("base", "camera", 3.0), position=(1.0, 0.0, 0.0))
    buffer.add(TransformsMessage((moved,)), False, "/tf")
    assert buffer.matrix("base", "camera", 3 * S)[0, 3] == 1.0
    assert not buffer.has_reached("base", "camera", 99 * S)
