"""Transforms between frames at a time. Products of random transforms are the judge."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roverlink.vision.poses.pose import Pose, rotation_of
from roverlink.vision.poses.transform_tree import KEPT_NS, NEAR_NS, TransformError, TransformTree

_S = 1_000_000_000
_numbers = st.floats(-3, 3)
_poses = st.tuples(*[_numbers] * 6).map(lambda given: Pose(rotation_of(np.array(given[:3])), np.array(given[3:])))
_STILL = Pose(np.eye(3), np.zeros(3))


def _same(one: Pose, other: Pose) -> bool:
    return np.allclose(one.rotation, other.rotation, atol=1e-9) and np.allclose(
        one.translation, other.translation, atol=1e-9
    )


@given(st.lists(_poses, min_size=1, max_size=6), st.data())
def test_a_transform_is_the_product_of_those_on_its_way(poses: list[Pose], data: st.DataObject) -> None:
    """Between any two frames of any tree, in both directions, whatever the root is."""
    tree, to_root = TransformTree(), {"0": _STILL}
    for index, pose in enumerate(poses, 1):
        parent = data.draw(st.sampled_from(sorted(to_root)))
        tree.add(parent, str(index), 0, pose, static=data.draw(st.booleans()))
        to_root[str(index)] = to_root[parent] @ pose
    source, target = (data.draw(st.sampled_from(sorted(to_root))) for _ in range(2))
    assert _same(tree.look_up(target, source, 0), to_root[target].inverse() @ to_root[source])
    assert _same(tree.look_up(source, target, 0), tree.look_up(target, source, 0).inverse())


@given(_poses, _numbers, _numbers, st.floats(0, 1), st.permutations([0, 1, 2]))
def test_between_two_stamps_motion_is_even(start: Pose, turn: float, way: float, part: float, order: list[int]) -> None:
    """Transforms that arrive in any order give the pose of a body that moves evenly."""

    def at(time: float) -> Pose:
        angles = np.array([0.0, 0.0, turn / 3 * time])
        return Pose(rotation_of(angles) @ start.rotation, start.translation + time * np.array([way, 0, 0]))

    tree = TransformTree()
    for index in order:
        tree.add("odom", "base", index * _S, at(index))
    assert _same(tree.look_up("odom", "base", round((1 + part) * _S)), at(round((1 + part) * _S) / _S))


def test_a_transform_is_known_for_a_moment_before_and_after() -> None:
    """Longer than that it is unknown, and the error says how old the newest one is."""
    tree = TransformTree()
    tree.add("odom", "base", 5 * _S, _STILL)
    for stamp in (5 * _S - NEAR_NS, 5 * _S + NEAR_NS):
        tree.look_up("odom", "base", stamp)
    with pytest.raises(TransformError, match=r"from .base. to .odom. is not known now: the newest one is 2\.0 s older"):
        tree.look_up("odom", "base", 7 * _S)
    with pytest.raises(TransformError, match="the transforms are newer"):
        tree.look_up("odom", "base", _S)
    tree.add("base", "camera", 0, _STILL, static=True)
    tree.look_up("base", "camera", 99 * _S)


@pytest.mark.parametrize(
    ("edges", "words"),
    [
        ([], "no transforms connect 'camera' with 'base'; no transforms have come"),
        ([("base_link", "camera")], "there is no frame 'base'; did you mean 'base_link'?"),
        ([("base", "arm"), ("lens", "camera")], "no transforms connect 'camera' with 'base'; both are known"),
    ],
)
def test_frames_that_are_not_connected_are_told(edges: list[tuple[str, str]], words: str) -> None:
    """With the frame that is missing, and the one that was perhaps meant."""
    tree = TransformTree()
    for parent, child in edges:
        tree.add(parent, child, 0, _STILL)
    with pytest.raises(TransformError) as caught:
        tree.look_up("base", "camera", 0)
    assert words in str(caught.value)


def test_what_is_old_is_forgotten_and_time_may_begin_again() -> None:
    """Ten seconds are kept. A stamp far in the past is a recording that is repeated."""
    tree = TransformTree()
    for second in range(30):
        tree.add("odom", "base", second * _S, Pose(np.eye(3), np.array([second, 0.0, 0.0])))
    with pytest.raises(TransformError):
        tree.look_up("odom", "base", 29 * _S - KEPT_NS - _S)
    tree.add("odom", "base", 0, _STILL)
    assert _same(tree.look_up("odom", "base", 0), _STILL)
    with pytest.raises(TransformError):
        tree.look_up("odom", "base", 29 * _S)


def test_a_frame_can_get_another_parent_and_a_loop_ends() -> None:
    """The last parent counts; frames that are their own ancestors are not connected to anything else."""
    tree = TransformTree()
    tree.add("arm", "camera", 0, _STILL)
    tree.add("mast", "camera", 0, _STILL)
    tree.look_up("mast", "camera", 0)
    with pytest.raises(TransformError):
        tree.look_up("arm", "camera", 0)
    for parent, child in pairwise(["camera", "mast", "camera"]):
        tree.add(parent, child, 0, _STILL)
    with pytest.raises(TransformError):
        tree.look_up("base", "camera", 0)
