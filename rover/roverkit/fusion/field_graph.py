"""Graph of poses on the field: odometry between them, landmarks that were seen from them, and GPS positions.

GTSAM's iSAM2 (Kaess and others, 2012) solves it anew with each image. A landmark is a variable, too: it has its place
by the survey with the survey's accuracy. So the error of a survey is estimated, and does not count as a new error in
each image. Landmarks that do not agree with the others have no place by the survey: somebody has moved them.

A sighting passes the gate if it agrees with the landmark's place, which is that of the survey before the first
sighting. If it does not, and agrees with that of another landmark, its number is wrong. Else the landmark may have
been moved. Several such sightings that agree with each other are of a moved landmark, which becomes a new variable. All
other sightings are left out.

The errors of the odometry (`slipping_motion`) are parts of each pose's variable, because they go on from
one motion to the next one. So a motion of the graph is short, also while nothing is seen (`follow`).

Errors of sightings that last are in the covariance, but are not estimated (`lasting_errors`). Sightings from nearly one
place have the same errors. They are used only if they tell the motion since the last one better than the odometry. So
the graph grows with the way of the rover, and not while it stands.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from statistics import median
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.field_factors import detection_factor, motion_factor, pose2, state_factor
from roverkit.fusion.gtsam_library import gtsam
from roverkit.fusion.landmark_agreement import agreeing
from roverkit.fusion.lasting_errors import PASSING, UNKNOWN, corrected, lasting_error, sighted
from roverkit.fusion.odometry_track import OdometryPoint
from roverkit.fusion.planar_gaussian import (
    Floats,
    PlanarGaussian,
    adjoint,
    is_covariance,
    rotation,
    squared_distance,
    squared_way,
)
from roverkit.fusion.slipping_motion import ERRORS, pose_of, state_of
from roverkit.gating import Reasons, RecentInnovations, gate_limit

_ALIKE_M = 0.25
_ALIKE_RAD = 0.15
"""Distance, or turn of the rover, below which sightings of a landmark have the same errors.

It is also the longest motion of the graph: a turn bends the way on which later errors of the yaw act.
"""
_GPS_APART_M = 1.0
"""Least distance between two GPS positions: the errors of successive ones are nearly the same."""
_SEVERAL = 3
"""Sightings that must agree with each other before they contradict what is known about a landmark."""
_UNLIKELY = 1e-5
"""Probability of the last innovations from which chance does not explain them: a long drive has many sightings."""
_ANY_YAW = math.pi**2 / 3
"""Variance of a direction that may be any. A larger one in a sighting says that nobody has measured the direction."""
CAUSES = (
    "the wheels slip more than `slip` says, the rover was pushed, the gyroscope has another bias or scale, or the "
    "mount of a camera is wrong"
)
"""Causes of a pose that several landmarks contradict."""
_ENOUGH = 2
"""Landmarks that must agree before there is a pose, if the survey has more: a single one may have been moved."""
_HELD = gtsam.noiseModel.Isotropic.Sigma(3, 1e-3)
"""Uncertainty of the first pose while landmarks are compared: without the survey, nothing else holds the graph."""
_ANY_ERRORS = gtsam.noiseModel.Unit.Create(ERRORS)
"""Uncertainty of the errors of the odometry at the first pose, in their standard deviations."""
_ROUNDS = 3
"""Steps in which the solution converges after all has moved."""

T = TypeVar("T")
"""Number of a marker, or name of a board."""


class _Sighting(NamedTuple):
    """Place of a landmark in the frame of the rover, from a pose of the graph."""

    key: int
    point: OdometryPoint
    place: PlanarGaussian


class _Misfit(NamedTuple):
    """Sighting of a landmark elsewhere, with its normalized squared innovation."""

    sighting: _Sighting
    squared: float


class FieldGraph(Generic[T]):
    """Poses of a rover on a field with landmarks."""

    def __init__(
        self, surveyed: Mapping[T, PlanarGaussian], reasons: Reasons, supposed: PlanarGaussian | None = None
    ) -> None:
        """Begin without a pose, or with one that is supposed at the first sighting.

        ``surveyed`` has the places of the landmarks by the survey.
        """
        self._surveyed, self._reasons, self._supposed = surveyed, reasons, supposed
        self._trusted: frozenset[T] = frozenset()
        self._measured = gtsam.NonlinearFactorGraph()
        self._solver = _solver()
        self._keys: dict[T, int] = {}
        self._landmarks = 0
        self._seen: Counter[T] = Counter()
        self._strange: dict[T, list[_Sighting]] = {}
        self._misfits: dict[T, list[_Misfit]] = {}
        self._recent = RecentInnovations()
        self._is_unlikely = False
        self._last: OdometryPoint | None = None
        self._last_seen: frozenset[T] = frozenset()
        self._used: dict[T, OdometryPoint] = {}
        self._last_gps: OdometryPoint | None = None
        self._poses = 0
        self._lasting = np.zeros((3, 3))
        """Derivative of the last pose, in its axes, by the errors of sightings that last."""

    @property
    def moved(self) -> Mapping[T, float]:
        """Landmarks that somebody has moved, with their distance in metres from the place of the survey.

        They agree with no other landmark, while at least two others agree.
        """
        if len(self._trusted) < _ENOUGH:
            return {}
        return {
            landmark: self._surveyed[landmark].pose.distance_to(self._place(key))
            for landmark, key in self._keys.items()
            if landmark not in self._trusted and self._seen[landmark] >= _SEVERAL
        }

    @property
    def is_lost(self) -> bool:
        """True if several images contradict the pose, and no trusted landmark has fitted since the first of them.

        They show several landmarks, or two landmarks several times.
        """
        images = {one.sighting.key for found in self._misfits.values() for one in found}
        repeated = sum(len(found) >= _SEVERAL for found in self._misfits.values())
        return len(images) >= _SEVERAL and (len(self._misfits) >= _SEVERAL or repeated >= _ENOUGH)

    def begun_again(self, point: OdometryPoint) -> FieldGraph[T]:
        """Return a graph of a rover that is lost, from a point of the odometry on.

        Its first pose is the last one, whose covariance grows by the factor by which the sightings contradict it.
        """
        last = [found[-1] for found in self._misfits.values()]
        supposed = self.pose(point)
        if supposed is not None:
            factor = 1 + median(one.squared for one in last) / 3
            supposed = PlanarGaussian(supposed.pose, factor * supposed.covariance)
        graph = FieldGraph(self._surveyed, self._reasons, supposed)
        motions = [one.sighting.point.motion_to(point).gaussian.inverse() for one in last]
        places = [motion @ one.sighting.place for motion, one in zip(motions, last)]
        graph.see(dict(zip(self._misfits, places)), point)
        return graph

    @property
    def unknown(self) -> str:
        """Reason why there is no pose; empty if there is one."""
        if self._last is None:
            return "no landmark of the survey has been seen; GPS alone does not tell the direction"
        if len(self._trusted) >= (needed := min(_ENOUGH, len(self._surveyed) - 1)):
            return ""
        seen = ", ".join(sorted(map(str, self._keys.keys() | self._strange.keys())))
        return (
            f"{needed} landmarks must agree with the survey, and with the motion by odometry, and {len(self._trusted)} "
            f"does; seen were {seen}. Drive past more of them, and check the survey, the mounts and the IMU"
        )

    def pose(self, point: OdometryPoint) -> PlanarGaussian | None:
        """Return the pose on the field at the time of a point of the odometry; None while it is `unknown`.

        One landmark is enough if the survey has only one or two. The point must not be older than the last image that
        was added.
        """
        if self.unknown:
            return None
        expected = self._expected(self._predicted(point), point)
        return PlanarGaussian(expected.pose, self._recent.variance_factor * expected.covariance)

    def see(self, detections: Mapping[T, PlanarGaussian], point: OdometryPoint) -> None:
        """Add an image: the places of landmarks in the frame of the rover, and the odometry at its time.

        Does nothing if the image is older than the last one, shows nothing new, or shows no surveyed landmark.
        """
        detections = {landmark: place for landmark, place in detections.items() if self._is_new(landmark, place, point)}
        if not detections:
            return
        self._used.update(dict.fromkeys(detections, point))
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        if self._last is None:
            # The landmark that is seen best is believed until others contradict.
            best = min(detections, key=lambda landmark: float(np.trace(detections[landmark].covariance)))
            self._trusted = frozenset({best})
            predicted = self._supposed or self._surveyed[best] @ detections[best].inverse()
            prior = self._supposed.covariance if self._supposed else UNKNOWN
            start = state_of(predicted.pose, np.zeros(ERRORS))
            factors.add(state_factor(first := gtsam.symbol("x", 0), 3, start[3:], _ANY_ERRORS))
            if self._supposed:
                noise = gtsam.noiseModel.Gaussian.Covariance(self._supposed.outer_covariance)
                factors.add(state_factor(first, 0, start[:3], noise))
        else:
            predicted = self._predicted(point)
            prior = predicted.covariance
            start = self._follow(point, factors)
        key = self._add_pose(point, start, values)
        lasting = self._lasting
        grown = False
        for landmark, place in detections.items():
            sighting, sight = _Sighting(key, point, place), sighted(predicted, lasting, place)
            if self._fits(landmark, sight, 3 if place.covariance[2, 2] < _ANY_YAW else 2):
                self._strange.pop(landmark, None)
                if landmark in self._trusted:
                    self._misfits.clear()
                if landmark not in self._keys:
                    self._add_landmark(landmark, predicted.pose @ place.pose, values)
                sightings = [sighting]
                spread = PASSING * place.covariance + self._surveyed[landmark].covariance
                by_pose = -adjoint(place.pose.inverse())
                prior, self._lasting = corrected(prior, self._lasting, by_pose, spread, lasting_error(place))
            elif self._is_other(landmark, sight):
                continue
            elif len(sightings := self._agreeing(landmark, sighting, sight)) >= _SEVERAL:
                del self._strange[landmark]
                self._trusted -= {landmark}
                self._add_landmark(landmark, predicted.pose @ place.pose, values)
                grown = True
            else:
                continue
            self._seen[landmark] += len(sightings)
            for one in sightings:
                noise = _robust(one.place.covariance, PASSING)
                factors.add(detection_factor(one.key, self._keys[landmark], one.place.pose, noise))
            # Each doubling of what is known about a landmark is a reason to ask again.
            grown |= _is_power_of_two(self._seen[landmark])
        self._solve(factors, values)
        self._last_seen = frozenset(detections)
        if grown:
            self._judge()

    def _known(self, landmark: T) -> PlanarGaussian:
        """Return the place of a landmark on the field, as far as it is known."""
        if (key := self._keys.get(landmark)) is None:
            return self._surveyed[landmark]
        return PlanarGaussian(self._place(key), self._solver.marginalCovariance(key))

    def _is_other(self, landmark: T, sight: PlanarGaussian) -> bool:
        """Return true if a place by a sighting is that of another landmark, so that the number is wrong.

        Only the position counts: the yaw is the rotation since the survey of the landmark with this number.
        """
        others = (self._known(other) for other in self._trusted & self._keys.keys() if other != landmark)
        return any(squared_way(other, sight) < gate_limit(2) for other in others)

    def _fits(self, landmark: T, sight: PlanarGaussian, freedom: int) -> bool:
        """Return true if a place on the field by a sighting is that of the landmark."""
        known = self._known(landmark)
        squared = squared_distance(known, sight)
        fits = self._reasons.passes(
            f"sighting of landmark {landmark} left out: its number may be wrong, or it or the rover was moved",
            squared / self._recent.variance_factor,
            freedom,
            f"it is {known.pose.distance_to(sight.pose):.2f} m beside its place",
        )
        self._recent.add(squared, freedom, fits)
        was_unlikely, self._is_unlikely = self._is_unlikely, self._recent.probability < _UNLIKELY
        if self._is_unlikely and not was_unlikely:
            self._reasons.tell(f"the last sightings fit worse than chance allows: {CAUSES}")
        return fits

    def _agreeing(self, landmark: T, sighting: _Sighting, sight: PlanarGaussian) -> list[_Sighting]:
        """Return the sightings that do not fit what is known, and that agree with the last one by the odometry.

        ``sight`` is the place on the field by the last one.
        """
        misfit = _Misfit(sighting, squared_distance(self._known(landmark), sight))
        self._misfits.setdefault(landmark, []).append(misfit)
        agreeing = [
            one
            for one in self._strange.get(landmark, ())
            if squared_distance(one.place, one.point.motion_to(sighting.point).gaussian @ sighting.place)
            < gate_limit(3)
        ]
        self._strange[landmark] = [*agreeing, sighting]
        return self._strange[landmark]

    def _add_landmark(self, landmark: T, place: PlanarPose, values: Any) -> None:
        """Add a variable for a landmark; one that was moved gets another one."""
        self._keys[landmark] = gtsam.symbol("l", self._landmarks)
        self._landmarks += 1
        self._seen[landmark] = 0
        values.insert(self._keys[landmark], pose2(place))

    def _predicted(self, point: OdometryPoint) -> PlanarGaussian:
        """Return the pose at the time of a point of the odometry, from the last pose of the graph."""
        assert self._last is not None  # noqa: S101  # callers have checked it
        last = gtsam.symbol("x", self._poses - 1)
        state, covariance = self._solver.calculateEstimateVector(last), self._solver.marginalCovariance(last)
        return self._last.motion_to(point).pose_after(state, covariance)

    def _expected(self, predicted: PlanarGaussian, point: OdometryPoint) -> PlanarGaussian:
        """Return a pose that was predicted at a point of the odometry with the errors of sightings that last."""
        lasting = self._carried(point)
        return PlanarGaussian(predicted.pose, predicted.covariance + lasting @ lasting.T)

    def _carried(self, point: OdometryPoint) -> Floats:
        """Return the derivative of the pose at a point of the odometry by the errors that last."""
        assert self._last is not None  # noqa: S101  # callers have checked it
        carried: Floats = adjoint(point.pose.inverse() @ self._last.pose) @ self._lasting
        return carried

    def locate(self, position: Floats, covariance: Floats, point: OdometryPoint) -> None:
        """Add a GPS position (2,) on the field in metres, with its covariance (2, 2) in the axes of the field.

        ``point`` is the odometry at its time. Does nothing before the first landmark is seen, or near the last GPS
        position.
        """
        if self._last is None or point.stamp <= self._last.stamp:
            return
        if self._last_gps is not None and self._last_gps.pose.distance_to(point.pose) < _GPS_APART_M:
            return
        predicted = self._predicted(point)
        expected, prior = self._expected(predicted, point), predicted.covariance
        missed = position - (expected.pose.x, expected.pose.y)
        spread = self._recent.variance_factor * expected.outer_covariance[:2, :2] + covariance
        if not self._reasons.passes(
            "GPS position left out: it does not fit the pose",
            float(missed @ np.linalg.solve(spread, missed)),
            2,
            f"it is {math.hypot(*missed):.1f} m beside it",
        ):
            return
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        key = self._add_pose(point, self._follow(point, factors), values)
        factors.add(state_factor(key, 0, position, _robust(covariance)))
        by_pose = rotation(expected.pose.yaw)[:2]
        _, self._lasting = corrected(prior, self._lasting, by_pose, covariance, np.zeros((2, 3)))
        self._last_gps = point
        self._solve(factors, values)

    def follow(self, point: OdometryPoint) -> None:
        """Add a pose on the way if the last one is far behind; inputs that are older are not used from now on."""
        if self._last is None or point.stamp <= self._last.stamp or not _is_apart(self._last, point):
            return
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        self._add_pose(point, self._follow(point, factors), values)
        self._solve(factors, values)

    def _is_new(self, landmark: T, place: PlanarGaussian, point: OdometryPoint) -> bool:
        """Return true if a sighting at a point of the odometry tells something new about a surveyed landmark.

        It does at another place of the rover, where its errors are others. It also does if the odometry since the last
        one is less exact, in any direction, than the difference of the two, which has the passing errors of both: then
        it tells how far the rover has moved.
        """
        if landmark not in self._surveyed or (self._last is not None and point.stamp <= self._last.stamp):
            return False
        if (used := self._used.get(landmark)) is None or _is_apart(used, point):
            return True
        by_pose = adjoint(place.pose.inverse())
        moved = by_pose @ used.motion_to(point).gaussian.covariance @ by_pose.T
        return not is_covariance(2 * PASSING * place.covariance - moved)

    def _follow(self, point: OdometryPoint, factors: Any) -> Floats:
        """Add the motion since the last pose to the factors, and return the state that follows from it."""
        assert self._last is not None  # noqa: S101  # callers have checked it
        motion = self._last.motion_to(point)
        last = gtsam.symbol("x", self._poses - 1)
        factors.add(motion_factor(last, last + 1, motion))
        return motion.state_after(self._solver.calculateEstimateVector(last))

    def _add_pose(self, point: OdometryPoint, start: Floats, values: Any) -> int:
        key: int = gtsam.symbol("x", self._poses)
        values.insert(key, start)
        if self._last is not None:
            self._lasting = self._carried(point)
        self._last = point
        self._poses += 1
        return key

    def _solve(self, factors: Any, values: Any) -> None:
        first = self._measured.size() == 0
        self._measured.push_back(factors)
        if first:
            self._restart(values)
        else:
            self._solver.update(factors, values)
            self._solver.update()

    def _judge(self) -> None:
        """Find the landmarks that agree with each other, and trust these from now on."""
        if len(self._keys) < 2:
            return
        values = self._solver.calculateEstimate()
        held = gtsam.NonlinearFactorGraph(self._measured)
        first = gtsam.symbol("x", 0)
        held.add(state_factor(first, 0, values.atVector(first)[:3], _HELD))
        joint = gtsam.Marginals(held, values).jointMarginalCovariance(list(self._keys.values()))
        trusted = agreeing(
            {landmark: self._place(key) for landmark, key in self._keys.items()},
            lambda landmark, other: joint.at(self._keys[landmark], self._keys[other]),
            self._surveyed,
            self._last_seen,
        )
        if trusted == self._trusted:
            return
        anchor = next(landmark for landmark in self._keys if landmark in (trusted & self._trusted or trusted))
        move = self._surveyed[anchor].pose @ self._place(self._keys[anchor]).inverse()
        for key in self._keys.values():
            values.update(key, pose2(move @ self._place(key)))
        for number in range(self._poses):
            state = values.atVector(key := gtsam.symbol("x", number))
            values.update(key, state_of(move @ pose_of(state), state[3:]))
        self._trusted = trusted
        self._restart(values)

    def _restart(self, values: Any) -> None:
        """Solve all anew, with the surveyed places of the trusted landmarks."""
        factors = gtsam.NonlinearFactorGraph(self._measured)
        for landmark in self._keys:
            if landmark in self._trusted:
                place = self._surveyed[landmark]
                noise = gtsam.noiseModel.Gaussian.Covariance(place.covariance)
                factors.add(gtsam.PriorFactorPose2(self._keys[landmark], pose2(place.pose), noise))
        self._solver = _solver()
        self._solver.update(factors, values)
        for _ in range(_ROUNDS):
            self._solver.update()

    def _place(self, landmark: int) -> PlanarPose:
        place = self._solver.calculateEstimatePose2(landmark)
        return PlanarPose(place.x(), place.y(), place.theta())


def _solver() -> Any:
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.01)
    parameters.relinearizeSkip = 1
    return gtsam.ISAM2(parameters)


def _is_apart(before: OdometryPoint, after: OdometryPoint) -> bool:
    """Return true if the rover has moved or turned so far that errors of sightings are others."""
    turn = abs(math.remainder(after.pose.yaw - before.pose.yaw, 2 * math.pi))
    return after.pose.distance_to(before.pose) >= _ALIKE_M or turn >= _ALIKE_RAD


def _robust(covariance: Floats, passing: float = 1.0) -> Any:
    """Return the noise of an input: Gaussian up to the limit of the gate, beyond which the input counts less and less.

    ``passing`` is the part of the covariance that is not the same in all inputs.
    Source: Agarwal and others, Robust Map Optimization using Dynamic Covariance Scaling, 2013.
    """
    noise, limit = gtsam.noiseModel.Gaussian.Covariance(passing * covariance), gate_limit(len(covariance)) / passing
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.DCS.Create(limit), noise)


def _is_power_of_two(number: int) -> bool:
    return number & (number - 1) == 0
