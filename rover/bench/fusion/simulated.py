"""Drives of the simulated rover: ``roverlink fuse`` and robot_localization's equations get the same messages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from roverkit.driving.arcs import PlanarPose
from roverkit.driving.geodesy import Datum
from roverkit.fusion.planar_landmarks import planar_detections, surveyed_places

from rover.bench.fusion.filters import Estimate, RobotLocalization
from rover.tests.driving.field_drive import FieldDrive
from rover.tests.driving.simulated_tracker import MOUNT, field
from roverlink.runtime.interfaces import nav_msgs, sensor_msgs, vision_msgs

_CONFIG = Path(__file__).parents[2] / "navigation" / "config" / "ekf.yaml"
_PLANE = [0, 1, 5, 6, 7, 11, 12, 13]
"""States of robot_localization that do not stay zero on a plane."""
_SEEN_M, _METRES = 10.0, 40.0
_FAR_M = 100.0
_LARGE = 9.348
"""97.5 % quantile of chi squared with 3 degrees of freedom, from tables."""


def compared(seeds: Sequence[int], *, landmarks: bool, gps: bool) -> list[str]:
    """Return the means over drives of RMSE and NEES, of both; without landmarks, they are seen on the first metres."""
    scores = np.array([_scores(seed, landmarks, gps) for seed in seeds])
    sensors = " and ".join(name for name, has in (("landmarks", landmarks), ("GPS", gps)) if has) or "wheels alone"
    nearer = int((scores[:, 0] < scores[:, 2]).sum())
    return [
        sensors,
        f"{nearer} of {len(seeds)}",
        *(f"{one:.{3 - 2 * (index % 2)}f}" for index, one in enumerate(scores.mean(axis=0))),
    ]


def _scores(seed: int, landmarks: bool, gps: bool) -> list[float]:
    """Return RMSE and mean NEES of ``roverlink fuse`` and of robot_localization in one drive."""
    other = _other()
    surveyed = surveyed_places(field())
    misses: list[list[float]] = []

    def take(message: Any, now: float) -> None:
        if isinstance(message, nav_msgs.Odometry):
            twist, covariance = message.twist.twist, np.array(message.twist.covariance)[[0, 7, 35]]
            other.take(now, 3, np.array([twist.linear.x, 0.0, twist.angular.z]), np.diag(covariance), gated=False)
        elif isinstance(message, sensor_msgs.NavSatFix) and gps:
            position = np.array(Datum(*datum).planar(message.latitude, message.longitude))
            covariance = np.reshape(message.position_covariance, (3, 3))[:2, :2]
            other.take(now, 0, position, covariance, gated=True)
        elif isinstance(message, vision_msgs.Detection3DArray):
            seen = planar_detections(message, MOUNT, field())
            poses = [surveyed[name] @ place.inverse() for name, place in seen.items()]
            if poses:
                other.take(now, 0, *_mean([(_vector(one.pose), one.outer_covariance) for one in poses]), gated=True)

    def watch() -> None:
        if not (rover.fused and rover.is_current):
            return
        error, covariance = rover.error
        truth = _vector(rover.model.pose)
        pose, spread = other.estimate
        missed = truth - pose
        missed[2] = math.remainder(missed[2], 2 * math.pi)
        misses.append(
            [
                float(error[:2] @ error[:2]),
                float(error @ np.linalg.solve(covariance, error)),
                float(missed[:2] @ missed[:2]),
                float(missed @ np.linalg.solve(spread, missed)),
            ]
        )

    with ExitStack() as stack:
        rover = FieldDrive(seed, stack, gps=gps, change=take)
        origin = rover.model.settings.gps.datum
        datum = origin.latitude, origin.longitude
        rover.stand(10)
        rover.drive(_SEEN_M)
        rover.sees = landmarks
        rover.drive(_METRES, watch)
    ours, normalized, theirs, other_normalized = np.mean(misses, axis=0)
    return [math.sqrt(ours), normalized, math.sqrt(theirs), other_normalized]


def far(seeds: Sequence[int]) -> list[list[str]]:
    """Return the figures of drives of 100 m with landmarks: what was measured, and its value."""
    with ProcessPoolExecutor() as pool:
        rmse, alone, mean, end, alone_end = np.array(list(pool.map(_far, seeds))).T
    worse = int((alone > rmse).sum())
    return [
        ["RMSE of the position, cm: largest, mean", f"{100 * rmse.max():.1f}, {100 * rmse.mean():.1f}"],
        ["RMSE of the odometry alone, cm: mean; drives in which it is larger", f"{100 * alone.mean():.0f}; {worse}"],
        ["NEES of the pose: mean over the drives, mean at their ends", f"{mean.mean():.1f}, {end.mean():.1f}"],
        ["NEES of the odometry alone, mean at the ends", f"{alone_end.mean():.1f}"],
        [f"drives at whose end the NEES is above {_LARGE:.2f}", f"{int((end > _LARGE).sum())}"],
    ]


def _far(seed: int) -> list[float]:
    """Return both RMSE in metres, the mean NEES, and the NEES of both at the end, of one drive."""
    ours: list[float] = []
    alone: list[float] = []
    normalized: list[float] = []

    def watch() -> None:
        if rover.fused and rover.is_current:
            error, covariance = rover.error
            ours.append(float(error[:2] @ error[:2]))
            other, _ = rover.odometry_error
            alone.append(float(other[:2] @ other[:2]))
            normalized.append(float(error @ np.linalg.solve(covariance, error)))

    with ExitStack() as stack:
        rover = FieldDrive(seed, stack)
        rover.stand(2)
        rover.drive(_FAR_M, watch)
        error, covariance = rover.odometry_error
    squared = float(error @ np.linalg.solve(covariance, error))
    return [*np.sqrt([np.mean(ours), np.mean(alone)]), float(np.mean(normalized)), normalized[-1], squared]


def _other() -> RobotLocalization:
    nodes = yaml.safe_load(_CONFIG.read_text(encoding="utf-8"))
    parameters = nodes["/**/ekf_filter_node_map"]["ros__parameters"]
    process, start = (
        np.reshape(parameters[f"{name}_covariance"], (15, 15))[np.ix_(_PLANE, _PLANE)]
        for name in ("process_noise", "initial_estimate")
    )
    return RobotLocalization(process, start, parameters["pose0_rejection_threshold"])


def _vector(pose: PlanarPose) -> Any:
    return np.array([pose.x, pose.y, pose.yaw])


def _mean(poses: Sequence[Estimate]) -> Estimate:
    """Return the pose by several landmarks, as the tracker computes one from them."""
    first = poses[0][0]
    information = np.zeros((3, 3))
    pull = np.zeros(3)
    for pose, covariance in poses:
        apart = pose - first
        apart[2] = math.remainder(apart[2], 2 * math.pi)
        weight = np.linalg.inv(covariance)
        information += weight
        pull += weight @ apart
    covariance = np.linalg.inv(information)
    return first + covariance @ pull, covariance
