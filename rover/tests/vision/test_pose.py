"""Poses: how they compose, both solutions of a marker, and transforms between frames at a time."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from itertools import chain

import cv2
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from roverkit.gating import gate_limit
from roverkit.vision.markers.marker_set import square
from roverkit.vision.poses.pnp import Corners, Solution, solve, square_poses, with_all_errors
from roverkit.vision.poses.pose import Pose, predict, rotation_of
from roverkit.vision.poses.transform_tree import KEPT_NS, NEAR_NS, TransformError, TransformTree

FACING = np.diag([1.0, -1.0, -1.0])
vectors = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array)
changes = st.tuples(*[st.floats(-0.9, 0.9)] * 6).map(np.array)


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    """A marker before the camera, turned by up to 60 degrees."""
    tilt = draw(st.floats(0, 1.0)) * np.array([np.cos(a := draw(st.floats(0, 6.3))), np.sin(a), 0])
    turn = rotation_of(tilt) @ FACING @ rotation_of(np.array([0, 0, draw(st.floats(0, 6.3))]))
    distance = draw(st.floats(0.3, 3))
    return Pose(turn, np.array([draw(st.floats(-0.4, 0.4)), draw(st.floats(-0.3, 0.3)), 1.0]) * distance)


def seen_at(pose: Pose, points: np.ndarray, noise: float, rng: np.random.Generator) -> Corners:
    """Corners with noise in the plane z = 1."""
    rays, _ = predict(pose, points)
    return Corners(points, rays + rng.normal(0, noise, rays.shape), np.eye(rays.size) * noise**2)


def solved(seen: Corners) -> list[Solution]:
    """The solutions of one marker."""
    (solutions,) = solve([seen], square_poses(seen.points[None], seen.rays[None]))
    return solutions


@pytest.mark.slow
@settings(max_examples=40)
@given(poses(), poses(), changes, vectors)
@example(Pose(FACING, np.array([0, 0, 1.0])), Pose(FACING, np.zeros(3)), np.array([0, 0, 0, 0, 0, 1e-7]), np.zeros(3))
def test_composition_is_one_after_the_other(first: Pose, second: Pose, change: np.ndarray, point: np.ndarray) -> None:
    """A product applies its right side first, the inverse takes a pose back, and `change_to` finds what `moved` did."""
    assert (second @ first).apply(point) == pytest.approx(second.apply(first.apply(point)), abs=1e-12)
    assert (first.inverse() @ first).apply(point) == pytest.approx(point, abs=1e-12)
    assert first.change_to(first.moved(change)) == pytest.approx(change, abs=1e-9)


def test_landmarks_are_solved_together_as_each_alone() -> None:
    """Whatever their numbers of corners, beside one without a start, without a covariance, or behind the camera."""
    rng = np.random.default_rng(5)
    seen, starts = [], []
    for number in range(12):
        pose = Pose(rotation_of(rng.normal(0, 0.3, 3)) @ FACING, rng.uniform((-0.3, -0.3, 0.6), (0.3, 0.3, 2)))
        squares = [square(0.1) + np.array([0.2 * place, 0, 0]) for place in range(1 + number % 3)]
        corners = seen_at(pose, np.concatenate(squares), 3e-4, rng)
        seen.append(corners)
        starts.append([*chain(*square_poses(np.stack(squares), corners.rays.reshape(-1, 4, 2)))])
    starts[3] = []
    starts[4] = [Pose(FACING, np.array([0, 0, -1.0])), *starts[4]]
    seen[5] = replace(seen[5], covariance=np.zeros_like(seen[5].covariance))
    together = solve(seen, starts)
    assert (together[3], together[5]) == ([], [])
    assert all(solutions for number, solutions in enumerate(together) if number not in (3, 5))
    for solutions, corners, own in zip(together, seen, starts):
        (alone,) = solve([corners], [own])
        assert len(alone) == len(solutions)
        for one, other in zip(alone, solutions):
            assert one.pose.change_to(other.pose) == pytest.approx(np.zeros(6), abs=1e-9)
            assert one.chi2 == pytest.approx(other.chi2, rel=1e-6)
    assert solve([], []) == square_poses(np.empty((0, 4, 3)), np.empty((0, 4, 2))) == []


def test_a_marker_has_the_two_poses_that_opencv_finds() -> None:
    """The corners have noise, so no pose fits exactly. Corners without area have no pose, and disturb no other one."""
    rng, seen = np.random.default_rng(7), [np.zeros((4, 2)), np.full((4, 2), np.nan), np.outer(range(4), (0.1, 0.2))]
    for tilt in np.linspace(0.1, 1.2, 20):
        pose = Pose(
            rotation_of(np.array([tilt, tilt / 2, tilt])) @ FACING, rng.uniform((-0.3, -0.3, 0.4), (0.3, 0.3, 2))
        )
        seen.append(seen_at(pose, square(0.1), 5e-4, rng).rays)
    nothing, unknown, line, *both = square_poses(np.stack([square(0.1)] * len(seen)), np.stack(seen))
    assert nothing == unknown == line == []
    for found, rays in zip(both, seen[3:]):
        known = cv2.solvePnPGeneric(square(0.1), rays[:, None], np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
        others = [Pose(cv2.Rodrigues(turn)[0], shift.ravel()) for turn, shift in zip(*known[1:3])]
        for other in others:
            nearest = min(found, key=other.angle_to)
            assert nearest.change_to(other) == pytest.approx(np.zeros(6), abs=1e-6)


@pytest.mark.slow
def test_the_covariance_is_honest() -> None:
    """Over many draws the squared error in its units is 6 on average: the mean of 400 stays within 4 sigma."""
    rng, nees = np.random.default_rng(5), []
    for _ in range(400):
        tilt = rng.uniform(0.3, 1.0) * np.array([np.cos(a := rng.uniform(0, 6.3)), np.sin(a), 0])
        pose = Pose(rotation_of(tilt) @ FACING, np.append(rng.uniform(-0.3, 0.3, 2), 1) * 0.8)
        seen = seen_at(pose, square(0.05), 2e-5, rng)
        solution = min(solved(seen), key=lambda one: one.pose.angle_to(pose))
        error = solution.pose.change_to(pose)
        nees.append(error @ np.linalg.solve(solution.covariance, error))
    assert np.mean(nees) == pytest.approx(6, abs=4 * (12 / 400) ** 0.5)


def test_a_fit_that_cannot_be_chance_widens_the_covariance() -> None:
    """Corners that no square has say that something is wrong; the covariance says so, too."""
    pose = Pose(rotation_of(np.array([0.6, 0.2, 0])) @ FACING, np.array([0.1, 0.05, 0.8]))
    seen = seen_at(pose, square(0.05), 1e-5, np.random.default_rng(0))
    seen.rays[0] += 2e-3
    solutions = solved(seen)
    ((wider, doubtful),) = with_all_errors([seen], [solutions])
    assert doubtful[0].covariance.trace() > 10 * solutions[0].covariance.trace()
    assert wider.covariance[0, 0] > 10 * seen.covariance[0, 0]


@pytest.mark.parametrize(("freedom", "limit"), [(1, 10.828), (8, 26.124), (100, 149.449)])
def test_the_limit_is_chi_squared_s_quantile(freedom: int, limit: float) -> None:
    """99.9 %, as in printed tables."""
    assert gate_limit(freedom) == pytest.approx(limit, abs=1e-3)


_S = 1_000_000_000
_numbers = st.floats(-3, 3)
_poses = st.tuples(*[_numbers] * 6).map(lambda given: Pose(rotation_of(np.array(given[:3])), np.array(given[3:])))
_STILL = Pose(np.eye(3), np.zeros(3))


def _same(one: Pose, other: Pose) -> bool:
    pairs = (one.rotation, other.rotation), (one.translation, other.translation)
    return all(np.allclose(*pair, atol=1e-9) for pair in pairs)


def _is_known(tree: TransformTree, target: str, source: str, stamp: int) -> bool:
    with contextlib.suppress(TransformError):
        tree.look_up(target, source, stamp)
        return True
    return False


@pytest.mark.slow
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


@pytest.mark.slow
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
    assert all(_is_known(tree, "odom", "base", 5 * _S + near) for near in (-NEAR_NS, NEAR_NS))
    with pytest.raises(TransformError, match=r"from .base. to .odom. is not known now: the newest one is 2\.0 s older"):
        tree.look_up("odom", "base", 7 * _S)
    with pytest.raises(TransformError, match="the transforms are newer"):
        tree.look_up("odom", "base", _S)
    tree.add("base", "camera", 0, _STILL, static=True)
    assert _is_known(tree, "base", "camera", 99 * _S)


def test_what_is_old_is_forgotten_and_time_may_begin_again() -> None:
    """Ten seconds are kept. A stamp far in the past is a recording that is repeated."""
    tree = TransformTree()
    for second in range(30):
        tree.add("odom", "base", second * _S, Pose(np.eye(3), np.array([second, 0.0, 0.0])))
    assert not _is_known(tree, "odom", "base", 29 * _S - KEPT_NS - _S)
    tree.add("odom", "base", 0, _STILL)
    assert _same(tree.look_up("odom", "base", 0), _STILL)
    assert not _is_known(tree, "odom", "base", 29 * _S)
