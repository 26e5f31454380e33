"""Recorded drives of other people, in the form in which all contestants get them.

Sources, none of which is part of this repository:

- MRCLAM: Leung and others, The UTIAS multi-robot cooperative localization and mapping dataset, 2011. Five robots drive
  among 15 landmarks with barcodes, and measure depths and bearings; cameras on the ceiling tell the truth.
- smartLoc: Reisdorf and others, The problem of comparable GNSS results, 2016. A car with the speed of its wheels, a
  gyroscope and the pseudoranges of a cheap GNSS receiver drives through a city; an expensive receiver tells the truth.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PERIOD_S = 0.1
"""Time between two messages of odometry."""
_WINDOW = 200
"""Messages of odometry in 20 s, over which motions are compared with the truth: errors are alike for many seconds."""
_SHORT = 10
"""Messages of odometry in one second: longer than any lead."""
_LASTING = 50
"""Number of fixes after which their errors are others: ten seconds."""
_FAR = 12.0
"""Median absolute deviations beyond which a value is a mistake: 8 standard deviations of a normal distribution."""


@dataclass(frozen=True)
class Noise:
    """Errors of the sensors, as the contestants know them."""

    slip: float
    """Standard deviation of the distance in metres, after one metre; so are the others, in metres and radians."""
    side_slip: float
    turn: float
    """After one metre, or one radian."""
    distance_scale: float = 1.0
    turn_scale: float = 1.0
    depth: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Measured "range" of a landmark: factors of its distances ahead and to the left, and metres to add.

    The ranges of MRCLAM are depths along the axis of a camera, which follow from the height of a barcode in the image.
    """
    depth_deviation: float = 1.0
    """Standard deviation of the depth, as a part of the true range."""
    bearing_offset: float = 0.0
    bearing_deviation: float = 1.0
    delay: float = 0.0
    """Time in seconds between an image and the stamp of its sightings."""
    lead: float = 0.0
    """Time in seconds by which the odometry is ahead of the motion: that of MRCLAM has the commands of the robots."""
    fix_variance: float = 1.0
    """Factor by which variances of fixes are too small: their errors are larger, and last for many fixes."""

    def covariance(self, distance: float, turn: float) -> Floats:
        """Return the covariance (3, 3) of a motion ahead, sideways and of the yaw."""
        way = abs(distance)
        return np.diag([self.slip**2 * way, self.side_slip**2 * way, self.turn**2 * (way + abs(turn))])


@dataclass(frozen=True)
class Fix:
    """Position by GNSS."""

    latitude: float
    longitude: float
    position: Floats
    """Metres (2,) to the east and north of the datum."""
    covariance: Floats


@dataclass(frozen=True)
class Drive:
    """Drive of one robot. Times are in seconds."""

    name: str
    robot: str
    odometry: Floats
    """Rows of time, speed in m/s and angular velocity in rad/s."""
    truth: Floats
    """Rows of time, x, y and yaw, which counts whole turns."""
    start: float
    landmarks: Mapping[int, Floats] = field(default_factory=dict)
    sightings: Mapping[float, Mapping[int, tuple[float, float]]] = field(default_factory=dict)
    """Depth (`Noise.depth`) and bearing by the landmark and the time."""
    fixes: Mapping[float, Fix] = field(default_factory=dict)
    datum: tuple[float, float] | None = None
    longest: float = math.inf
    """Time after which the drive ends."""

    @cached_property
    def _ways(self) -> Floats:
        """Distance and turn since the beginning of the odometry, at its times and at its end."""
        time, speed, rate = self.odometry.T
        seconds = np.diff(time)
        return np.array([time, np.r_[0, np.cumsum(speed[:-1] * seconds)], np.r_[0, np.cumsum(rate[:-1] * seconds)]])

    @cached_property
    def _truth(self) -> Floats:
        """Columns of the truth, each in one piece of memory: interpolation would copy them otherwise."""
        return np.ascontiguousarray(self.truth.T)

    def motion(self, since: float | Floats, until: float | Floats) -> Floats:
        """Return the distance and the turn between two times, by odometry; both may be arrays."""
        times, *ways = self._ways
        return np.array([np.interp(until, times, way) - np.interp(since, times, way) for way in ways])

    def true_pose(self, time: float) -> Floats:
        """Return the true pose (3,) at a time."""
        times, *axes = self._truth
        return np.array([np.interp(time, times, axis) for axis in axes])

    @property
    def true_steps(self) -> Floats:
        """True motions (3, n) ahead, to the left and of the yaw between the times of odometry.

        They are in the axes of the middle of each motion, so that an error of the yaw is not one of the position.
        """
        times, *axes = self._truth
        x, y, turn = np.diff([np.interp(self.times, times, axis) for axis in axes])
        yaw = np.interp(self.times[:-1], times, axes[2]) + turn / 2
        return np.array([np.cos(yaw) * x + np.sin(yaw) * y, np.cos(yaw) * y - np.sin(yaw) * x, turn])

    def timed(self, delay: float, lead: float) -> Drive:
        """Return the drive with stamps of the sightings and of the odometry that are those of the motion."""
        sightings = {time - delay: seen for time, seen in self.sightings.items()}
        return replace(self, sightings=sightings, odometry=np.add(self.odometry, [lead, 0, 0]))

    def with_fix_variance(self, factor: float) -> Drive:
        """Return the drive with the variances of fixes times a factor."""
        fixes = {time: replace(fix, covariance=fix.covariance * factor) for time, fix in self.fixes.items()}
        return replace(self, fixes=fixes)

    @property
    def times(self) -> Floats:
        """Times of odometry, from the start on."""
        end = min(self.odometry[-1, 0], self.truth[-1, 0], self.start + self.longest)
        return np.arange(self.start, end, PERIOD_S)


def calibrated(others: list[Drive]) -> Noise:
    """Return the errors of the sensors by other drives, whose truth is known."""
    motions, sightings, lead = [], [], _lead(others)
    others = [drive.timed(0.0, lead) for drive in others]
    for drive in others:
        steps = drive.true_steps
        steps = steps[:, : len(steps.T) // _WINDOW * _WINDOW]
        by_odometry = drive.motion(drive.times[:-1], drive.times[1:])[:, : len(steps.T)]
        motions += [np.vstack([steps, by_odometry, abs(by_odometry)]).reshape(7, -1, _WINDOW).sum(axis=2)]
        for time, seen in drive.sightings.items():
            rate = drive.motion(time - PERIOD_S, time + PERIOD_S)[1] / (2 * PERIOD_S)
            for landmark, (depth, bearing) in seen.items():
                distance, angle = range_bearing(drive.true_pose(time), drive.landmarks[landmark])
                beside = math.remainder(bearing - angle, 2 * math.pi)
                sightings.append([depth / distance, math.cos(angle), math.sin(angle), 1 / distance, beside, rate])
    ahead, aside, turned, distance, turn, way, turning = np.hstack(motions)
    scale, turn_scale = (float(true @ found / (found @ found)) for true, found in ((ahead, distance), (turned, turn)))
    errors = (ahead - scale * distance, way), (aside, way), (turned - turn_scale * turn, way + turning)
    slip, side_slip, turn_noise = (math.sqrt(missed @ missed / sizes.sum()) for missed, sizes in errors)
    motion = slip, side_slip, turn_noise, scale, turn_scale
    if not sightings:
        return Noise(*motion, lead=lead, fix_variance=_fix_variance(others))
    sighted = np.array(sightings)
    sighted = sighted[_no_mistakes(sighted[:, 0] / sighted[:, 1]) & _no_mistakes(sighted[:, 4])]
    depths, places, (besides, rates) = sighted[:, 0], sighted[:, 1:4], sighted[:, 4:].T
    factors = np.linalg.lstsq(places, depths)[0]
    delay, offset = np.polyfit(rates, besides, 1)
    return Noise(
        *motion,
        tuple(factors.tolist()),
        *map(float, (np.std(depths - places @ factors), offset, np.std(besides - delay * rates), delay, lead)),
    )


def _lead(drives: list[Drive]) -> float:
    """Return the time in seconds by which the odometry is ahead of the motion: that with which its turns fit best."""

    def missed(lead: float) -> float:
        whole = 0.0
        for drive in drives:
            since = drive.times[_SHORT:-_SHORT]
            until = since + PERIOD_S
            times, _, _, yaws = drive._truth
            turns = np.interp(until, times, yaws) - np.interp(since, times, yaws)
            whole += float(((turns - drive.motion(since - lead, until - lead)[1]) ** 2).sum())
        return whole

    return min((float(lead) for lead in np.arange(-_SHORT, _SHORT + 1) * PERIOD_S / 2), key=missed)


def _fix_variance(drives: list[Drive]) -> float:
    """Return the variance of the sum of successive normalized errors of fixes, over the number of fixes.

    It is the factor for errors that last: a filter that takes them for independent ones needs it. It follows from the
    median, because filters leave out mistakes.
    """
    factors = []
    for drive in drives:
        missed = [
            np.linalg.solve(np.linalg.cholesky(fix.covariance), fix.position - drive.true_pose(time)[:2])
            for time, fix in drive.fixes.items()
        ]
        for start in range(0, len(missed) - _LASTING, _LASTING):
            whole = np.sum(missed[start : start + _LASTING], axis=0)
            factors.append(whole @ whole / 2 / _LASTING)
    return float(np.median(factors)) / math.log(2) if factors else 1.0


def _no_mistakes(values: Floats) -> NDArray[np.bool_]:
    """Return which values are errors of a sensor and no mistakes, such as a wrong number."""
    distances = np.abs(values - np.median(values))
    which: NDArray[np.bool_] = distances < _FAR * np.median(distances)
    return which


def moved(pose: Floats, distance: float, turn: float) -> Floats:
    """Return a pose after an arc."""
    middle = pose[2] + turn / 2
    way: Floats = np.array([distance * math.cos(middle), distance * math.sin(middle), turn])
    return pose + way


def apart(start: Floats, end: Floats) -> Floats:
    """Return the pose ``end`` in the frame of ``start``."""
    x, y, turn = end - start
    cosine, sine = math.cos(start[2]), math.sin(start[2])
    return np.array([cosine * x + sine * y, cosine * y - sine * x, turn])


def range_bearing(pose: Floats, place: Floats) -> tuple[float, float]:
    """Return the range and the bearing of a place from a pose."""
    x, y = place[:2] - pose[:2]
    return math.hypot(x, y), math.remainder(math.atan2(y, x) - pose[2], 2 * math.pi)


# --- MRCLAM -------------------------------------------------------------------------------------------------------


def mrclam(folder: Path) -> Iterator[Drive]:
    """Yield the drives of a folder such as MRCLAM_Dataset6."""
    barcodes = {int(code): int(subject) for subject, code in np.loadtxt(folder / "Barcodes.dat")}
    places = {int(row[0]): row[1:3] for row in np.loadtxt(folder / "Landmark_Groundtruth.dat")}
    for path in sorted(folder.glob("Robot*_Groundtruth.dat")):
        robot = path.name.partition("_")[0]
        truth = np.loadtxt(path)
        truth[:, 3] = np.unwrap(truth[:, 3])
        sightings: dict[float, dict[int, tuple[float, float]]] = defaultdict(dict)
        for time, code, distance, bearing in np.loadtxt(folder / f"{robot}_Measurement.dat"):
            if (subject := barcodes.get(int(code))) in places and truth[0, 0] < time < truth[-1, 0]:
                sightings[time][subject] = distance, bearing
        odometry = np.loadtxt(folder / f"{robot}_Odometry.dat")
        start = max(min(sightings), odometry[0, 0])
        yield Drive(
            f"{folder.name.removeprefix('MRCLAM_')} {robot}",
            robot,
            odometry,
            truth,
            start,
            places,
            dict(sorted(sightings.items())),
        )


# --- smartLoc -----------------------------------------------------------------------------------------------------

_SEMI_MAJOR_M, _FLATTENING, _EARTH_RAD_S, _LIGHT_M_S = 6_378_137.0, 1 / 298.257223563, 7.2921151467e-5, 299_792_458.0
_FEWEST = 2
"""Satellites beyond those that are needed."""
_ROBUST = 2.0
"""Standard deviations from which a pseudorange counts less: reflections at buildings are long."""


def smartloc(path: Path) -> Iterator[Drive]:
    """Yield the drive of a file such as Berlin_Potsdamer_Platz_RTK_Input.txt, whose truth is beside it."""
    odometry, ranges = [], defaultdict(list)
    for line in path.read_text(encoding="utf-8").splitlines():
        kind, *words = line.split()
        values = [float(word) for word in words]
        if kind == "odom3":
            odometry.append([values[0], values[1], values[6]])
        else:
            ranges[values[0]].append(values[1:8])
    lines = path.with_name(path.name.replace("_Input", "_GT")).read_text(encoding="utf-8").splitlines()
    ecef = np.array([[float(word) for word in line.split()[1:5]] for line in lines])
    latitude, longitude, _ = geodetic(ecef[0, 1:])
    to_plane = _to_plane(latitude, longitude)
    positions = (ecef[:, 1:] - ecef[0, 1:]) @ to_plane.T
    speeds = np.gradient(positions[:, :2], ecef[:, 0], axis=0)
    moves = np.hypot(*speeds.T) > 2
    yaws = np.interp(ecef[:, 0], ecef[moves, 0], np.unwrap(np.arctan2(speeds[moves, 1], speeds[moves, 0])))
    fixes, place = {}, ecef[0, 1:]
    for time, rows in sorted(ranges.items()):
        if (found := _solved(np.array(rows), place)) is None:
            continue
        place, covariance = found
        east_north = to_plane @ (place - ecef[0, 1:])
        fixes[time] = Fix(*geodetic(place)[:2], east_north[:2], (to_plane @ covariance @ to_plane.T)[:2, :2])
    start = float(ecef[np.argmax(moves), 0])
    truth = np.column_stack([ecef[:, 0], positions[:, :2], yaws])
    yield Drive(
        path.stem.removesuffix("_Input"),
        "car",
        np.array(odometry),
        truth,
        start,
        fixes=fixes,
        datum=(latitude, longitude),
    )


def _solved(rows: Floats, place: Floats) -> tuple[Floats, Floats] | None:
    """Return the position (3,) by pseudoranges, and its covariance; None if there are too few satellites."""
    measured, variance, satellites, systems = rows[:, 0], rows[:, 1], rows[:, 2:5], rows[:, 6]
    clocks = (systems[:, None] == np.unique(systems)).astype(float)
    state = np.r_[place, np.zeros(clocks.shape[1])]
    if len(rows) < len(state) + _FEWEST:
        return None
    weights = 1 / variance
    for _ in range(15):
        ways = satellites - state[:3]
        distances = np.linalg.norm(ways, axis=1)
        rotation = _EARTH_RAD_S / _LIGHT_M_S * (satellites[:, 0] * state[1] - satellites[:, 1] * state[0])
        missed = measured - distances - rotation - clocks @ state[3:]
        derivative = np.hstack([-ways / distances[:, None], clocks])
        information = derivative.T @ (derivative * weights[:, None])
        step = np.linalg.solve(information, derivative.T @ (weights * missed))
        state = state + step
        normalized = np.abs(missed - derivative @ step) / np.sqrt(variance)
        weights = np.minimum(1, _ROBUST / np.maximum(normalized, 1e-9)) / variance
    spread = max(1.0, float((weights * (missed - derivative @ step) ** 2).sum() / (len(rows) - len(state))))
    return state[:3], (np.linalg.inv(information) * spread)[:3, :3]


def geodetic(place: Floats) -> tuple[float, float, float]:
    """Return the latitude and longitude in degrees, and the height in metres, of a place (3,) in the frame of Earth."""
    squared = _FLATTENING * (2 - _FLATTENING)
    x, y, z = place
    across = math.hypot(x, y)
    latitude = math.atan2(z, across * (1 - squared))
    for _ in range(8):
        radius = _SEMI_MAJOR_M / math.sqrt(1 - squared * math.sin(latitude) ** 2)
        height = across / math.cos(latitude) - radius
        latitude = math.atan2(z, across * (1 - squared * radius / (radius + height)))
    return math.degrees(latitude), math.degrees(math.atan2(y, x)), height


def _to_plane(latitude: float, longitude: float) -> Floats:
    """Return the matrix (3, 3) from the frame of Earth to east, north and up."""
    (sine, turn), (cosine, along) = np.sin(np.radians([latitude, longitude])), np.cos(np.radians([latitude, longitude]))
    return np.array([[-turn, along, 0], [-sine * along, -sine * turn, cosine], [cosine * along, cosine * turn, sine]])
