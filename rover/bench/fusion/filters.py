"""Filters beside which ``roverlink fuse`` is judged. They share no code with it."""

from __future__ import annotations

import math

import numpy as np

from rover.bench.fusion.drives import Drive, Fix, Floats, Noise, moved, range_bearing

_GATES = {1: 10.828, 2: 13.816, 3: 16.266}
"""99.9 % quantiles of chi squared by the degrees of freedom, from tables."""
START = np.diag([0.05, 0.05, 0.05]) ** 2
"""Covariance (3, 3) of the first pose, which both know."""

Estimate = tuple[Floats, Floats]
"""Pose (3,) and its covariance (3, 3), in the axes of the field."""


class GatedFilter:
    """Extended Kalman filter of x, y and yaw that leaves out what it does not expect."""

    def __init__(self, pose: Floats, noise: Noise) -> None:
        """Begin at a pose that is known by `START`."""
        self.pose, self.covariance, self._noise = pose.copy(), START.copy(), noise

    def move(self, distance: float, turn: float) -> None:
        """Predict the pose after an arc by odometry."""
        noise = self._noise
        distance, turn = distance * noise.distance_scale, turn * noise.turn_scale
        before, self.pose = self.pose, moved(self.pose, distance, turn)
        x, y, _ = self.pose - before
        carried = np.array([[1, 0, -y], [0, 1, x], [0, 0, 1]])
        turned = _turn(self.pose[2])
        own = turned @ noise.covariance(distance, turn) @ turned.T
        self.covariance = carried @ self.covariance @ carried.T + own

    def see(self, place: Floats, depth: float, bearing: float) -> None:
        """Take the depth and the bearing of a landmark."""
        noise = self._noise
        expected, angle = range_bearing(self.pose, place)
        x, y = expected * math.cos(angle), expected * math.sin(angle)
        by_ahead, by_left, offset = noise.depth
        sine, cosine = math.sin(self.pose[2]), math.cos(self.pose[2])
        by_pose = np.array([[-cosine, -sine, y], [sine, -cosine, -x]])  # of the place (x, y) in the frame of the robot
        derivative = np.array([[by_ahead, by_left], [-y / expected**2, x / expected**2]]) @ by_pose
        bearing = math.remainder(bearing - noise.bearing_offset - angle, 2 * math.pi)
        missed = np.array([depth - by_ahead * x - by_left * y - offset, bearing])
        self._correct(missed, derivative, np.diag([noise.depth_deviation * expected, noise.bearing_deviation]) ** 2)

    def locate(self, fix: Fix) -> None:
        """Take a position by GNSS."""
        self._correct(fix.position - self.pose[:2], np.eye(2, 3), fix.covariance)

    def _correct(self, missed: Floats, derivative: Floats, covariance: Floats) -> None:
        spread = derivative @ self.covariance @ derivative.T + covariance
        if missed @ np.linalg.solve(spread, missed) > _GATES[len(missed)]:
            return
        gain = np.linalg.solve(spread, derivative @ self.covariance).T
        self.pose = self.pose + gain @ missed
        kept = np.eye(3) - gain @ derivative
        self.covariance = kept @ self.covariance @ kept.T + gain @ covariance @ gain.T


def filtered(drive: Drive, noise: Noise) -> dict[float, Estimate]:
    """Return what the gated filter makes of a drive, by the time."""
    found, last = {}, drive.start
    own = GatedFilter(drive.true_pose(drive.start), noise)
    inputs = sorted([(time, 0) for time in drive.sightings] + [(time, 1) for time in drive.fixes])
    inputs = [one for one in inputs if one[0] > drive.start]
    for now in drive.times:
        while inputs and inputs[0][0] <= now:
            time, kind = inputs.pop(0)
            own.move(*drive.motion(last, time))
            last = time
            if kind:
                own.locate(drive.fixes[time])
            else:
                for landmark, seen in drive.sightings[time].items():
                    own.see(drive.landmarks[landmark], *seen)
        own.move(*drive.motion(last, now))
        last = now
        found[now] = own.pose, own.covariance
    return found


class RobotLocalization:
    """Stand-in for robot_localization's filter on a plane, by the equations of its ``ekf.cpp`` and ``filter_base.cpp``.

    The state is x, y, yaw, their velocities in the frame of the rover, and the accelerations ahead and sideways. The
    numbers are those of ``rover/navigation/config/ekf.yaml``.
    """

    def __init__(self, process: Floats, start: Floats, threshold: float) -> None:
        """``process`` (8, 8) is the process noise of a second, ``start`` (8, 8) the covariance of the first state."""
        self._state, self._covariance = np.zeros(8), start
        self._process, self._threshold, self._now = process, threshold, math.nan

    @property
    def estimate(self) -> Estimate:
        """Pose and covariance."""
        return self._state[:3], self._covariance[:3, :3]

    def take(self, now: float, first: int, values: Floats, covariance: Floats, *, gated: bool) -> None:
        """Take values of successive states, from the ``first`` one."""
        if now > self._now:
            self._predict(now - self._now)
        self._now = now if math.isnan(self._now) else max(now, self._now)
        which = slice(first, first + len(values))
        missed = values - self._state[which]
        if first == 0 and len(values) == 3:
            missed[2] = math.remainder(missed[2], 2 * math.pi)
        mixed = self._covariance[:, which]
        inverse = np.linalg.inv(mixed[which] + covariance)
        if gated and missed @ inverse @ missed >= self._threshold**2:
            return
        gain = mixed @ inverse
        self._state = self._state + gain @ missed
        kept = np.eye(8)
        kept[:, which] -= gain
        self._covariance = kept @ self._covariance @ kept.T + gain @ covariance @ gain.T

    def _predict(self, seconds: float) -> None:
        _, _, yaw, *velocity, ahead, aside = self._state
        turned = _turn(yaw)[:2, :2]
        transfer = np.eye(8)
        transfer[:2, 3:5], transfer[:2, 6:] = turned * seconds, turned * seconds**2 / 2
        transfer[2, 5] = seconds
        transfer[3:5, 6:] = np.eye(2) * seconds
        derivative = transfer.copy()
        way = np.array(velocity[:2]) * seconds + np.array([ahead, aside]) * seconds**2 / 2
        derivative[:2, 2] = turned @ [-way[1], way[0]]
        process = self._process.copy()
        process[:3, :3] *= sum(one**2 for one in velocity)  # dynamic_process_noise_covariance
        self._state = transfer @ self._state
        self._covariance = derivative @ self._covariance @ derivative.T + process * seconds


def _turn(yaw: float) -> Floats:
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
