"""Follows markers from frame to frame.

The whole frame is scanned at half resolution now and then, and at full resolution rarely. Between, the markers of the
frame before are fitted where they should be by their speed; where that does not fit, the region around is searched, and
where that finds nothing, the whole frame. Every marker is fitted at full resolution, so that the way it was found does
not matter to its pose.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.camera.camera_model import CameraParameters, Floats
from roverlink.vision.markers.detection import Detection, Detector, Image, Region, to_grey
from roverlink.vision.markers.edges import FIRST_BLUR, Fit, Guess, fit_edges
from roverlink.vision.markers.flips import Flips
from roverlink.vision.markers.marker_set import MarkerSet, TargetId
from roverlink.vision.poses.pnp import Corners, Solution, doubted, solve, square_poses
from roverlink.vision.poses.pose import Pose

SCAN_EVERY = 6
"""Frames from one scan of the whole frame to the next."""
FULL_EVERY = 5
"""Every so many scans is at full resolution, and so is the first."""
FORGOTTEN_S = 0.5
"""How long a marker that is not found is looked for where it should be."""
EXPLAINED = 0.75
"""The part of the pixels' variance that a marker's pattern must explain; what passes for one by chance stays below."""
CONTRAST = 8.0
"""Grey levels that white must be brighter than black."""
NEAR = 1.0
"""Pixels that corners may be from where they should be: from farther the fit may have begun at the wrong pixels."""
_MARGIN = 0.3  # of a marker's size, around where it should be
_LEAST_MARGIN = 10  # pixels


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """A marker or board that was seen, and where it is in the camera's optical frame (x right, y down, z forward)."""

    id: TargetId
    """The marker's number, or the board's name."""
    stamp: int
    """Nanoseconds, as given with the image."""
    corners: Floats
    """(N, 2) in pixels of the image, 4 for each marker that was seen, in OpenCV's order; refined."""
    pose: Pose
    """Takes points of the landmark's frame to the camera's, in metres."""
    covariance: Floats
    """Of the pose (6, 6), in the order x y z rotX rotY rotZ and about the camera's axes; see `vision/poses/pose.py`."""
    ambiguity: float
    """Reprojection error of the other pose over that of this one; infinite where there is no other.

    Near 1 one frame cannot tell which is true; below 1 the frames before decided against what this one shows.
    """
    error: float
    """Reprojection error: root of the mean squared distance in pixels from the corners to the pose's."""
    seen: Corners
    """What the pose was computed from."""
    solutions: tuple[Solution, ...]
    """All poses that were found, the best fitting first."""


@dataclass(slots=True, eq=False)
class _Track:
    """A marker of earlier frames."""

    corners: Floats
    velocity: Floats
    """Of the corners (4, 2) in pixels a second."""
    stamp: int
    blur: float


class Tracker:
    """Finds and follows the markers of one camera. Not to be shared between threads."""

    def __init__(
        self,
        camera: CameraParameters,
        markers: MarkerSet,
        *,
        scan_every: int = SCAN_EVERY,
        full_every: int = FULL_EVERY,
    ) -> None:
        """`scan_every` 1 scans every frame; `full_every` 1 makes every scan one at full resolution."""
        self._camera, self._markers = camera, markers
        self._detector = Detector(markers)
        self._scan_every, self._full_every = scan_every, full_every
        self.reset()

    def reset(self) -> None:
        """Forget what was seen, as at a jump in time."""
        self._tracks: dict[int, _Track] = {}
        self._flips: dict[TargetId, Flips] = {}
        self._frames = self._scans = 0
        self._stamp = 0

    def track(self, image: Image, stamp: int) -> tuple[Sighting, ...]:
        """The landmarks in an image, grey (H, W) or BGR (H, W, 3), taken at `stamp` in nanoseconds.

        Raises `SetupError` for an image whose size is not the one that the camera was calibrated with.
        """
        grey = self._grey(image)
        if stamp < self._stamp:
            self.reset()
        self._stamp = stamp
        self._forget(stamp)
        fits = self._find(grey, stamp)
        targets = self._by_target(fits)
        seen = [self._seen(numbers, fits) for numbers in targets.values()]
        found = solve(seen, self._starts(targets.values(), fits))
        return tuple(
            self._sight(target, numbers, corners, solutions, stamp)
            for (target, numbers), corners, solutions in zip(targets.items(), seen, found)
            if solutions
        )

    def _grey(self, image: Image) -> Image:
        height, width = image.shape[:2]
        if self._camera.size not in (None, (width, height)):
            raise SetupError(
                "the camera was calibrated with images of {}x{} pixels, and this one has {}x{}; calibrate at this "
                "size, or give parameters scaled to it".format(*(self._camera.size or ()), width, height)
            )
        if image.dtype != np.uint8 or image.ndim not in (2, 3):
            raise SetupError(f"an image has 8 bits, (H, W) or (H, W, 3); this is {image.dtype} of {image.shape}")
        return to_grey(image)

    def _forget(self, stamp: int) -> None:
        self._tracks = {
            number: track for number, track in self._tracks.items() if stamp - track.stamp < FORGOTTEN_S * 1e9
        }

    # --- finding ---

    def _find(self, grey: Image, stamp: int) -> dict[int, Fit]:
        """Look where it is due; scan also where a marker is lost and nothing was scanned."""
        due = self._frames % self._scan_every == 0
        self._frames += 1
        found = self._scan(grey) if due else {}
        expected = {
            number: Detection(number, _predicted(track, stamp)[0])
            for number, track in self._tracks.items()
            if number not in found
        }
        fits = self._fit_all(grey, {**found, **expected}, stamp, expected)
        if lost := [track for number, track in self._tracks.items() if number not in fits]:
            found = {}
            for track in lost:
                self._keep(found, self._detector.look(grey, _region(_predicted(track, stamp), grey.shape)))
            if not due and len(found) < len(lost):
                self._keep(found, self._detector.scan_half(grey))
            fits |= self._fit_all(grey, {number: one for number, one in found.items() if number not in fits}, stamp)
        return fits

    def _scan(self, grey: Image) -> dict[int, Detection]:
        full = self._scans % self._full_every == 0
        self._scans += 1
        found: dict[int, Detection] = {}
        self._keep(found, self._detector.scan(grey) if full else self._detector.scan_half(grey))
        return found

    def _keep(self, found: dict[int, Detection], more: Iterable[Detection]) -> None:
        """Add what was found; of two with one number the larger."""
        for one in more:
            old = found.get(one.number)
            if old is None or _extent(one) > _extent(old):
                found[one.number] = one

    # --- fitting ---

    def _fit_all(
        self, grey: Image, found: Mapping[int, Detection], stamp: int, expected: Container[int] = ()
    ) -> dict[int, Fit]:
        """Fit each; those that were only `expected` have to be near where they were."""
        fits = {}
        guesses = [self._guess(detection) for detection in found.values()]
        fitted = {
            number: fit
            for number, fit in zip(found, fit_edges(grey, self._camera, guesses))
            if fit and fit.explained > EXPLAINED and fit.contrast > CONTRAST
        }
        all_rays = np.array([fit.rays for fit in fitted.values()]).reshape(-1, 4, 2)
        for (number, fit), corners in zip(fitted.items(), self._camera.distort(all_rays)):
            if number not in expected or np.abs(corners - found[number].corners).max() <= NEAR:
                fits[number] = fit
                self._tracks[number] = _followed(self._tracks.get(number), corners, stamp, fit.blur)
        return fits

    def _guess(self, detection: Detection) -> Guess:
        track = self._tracks.get(detection.number)
        pattern = self._markers.pattern(detection.number)
        return Guess(pattern, detection.corners, track.blur if track else FIRST_BLUR)

    def _by_target(self, fits: Mapping[int, Fit]) -> dict[TargetId, list[int]]:
        targets: dict[TargetId, list[int]] = {}
        for number in sorted(fits):
            targets.setdefault(self._markers.target(number), []).append(number)
        return targets

    def _seen(self, numbers: list[int], fits: Mapping[int, Fit]) -> Corners:
        """What was seen of a landmark."""
        points = [self._markers.points(number) for number in numbers]
        covariance = np.zeros((8 * len(numbers), 8 * len(numbers)))
        for place, number in enumerate(numbers):
            covariance[8 * place : 8 * place + 8, 8 * place : 8 * place + 8] = fits[number].covariance
        return Corners(np.concatenate(points), np.concatenate([fits[number].rays for number in numbers]), covariance)

    def _starts(self, landmarks: Iterable[list[int]], fits: Mapping[int, Fit]) -> list[list[Pose]]:
        """The poses of each landmark, given by its markers' numbers, that one of its markers has alone."""
        if not fits:
            return []
        points = np.stack([self._markers.points(number) for number in fits])
        poses = dict(zip(fits, square_poses(points, np.stack([fit.rays for fit in fits.values()]))))
        return [[pose for number in numbers for pose in poses[number]] for numbers in landmarks]

    def _sight(
        self, target: TargetId, numbers: list[int], seen: Corners, solutions: Sequence[Solution], stamp: int
    ) -> Sighting:
        seen, solutions = doubted(seen, solutions[:2])
        chosen = self._flips.setdefault(target, Flips()).decide(solutions, stamp)
        best, focal = solutions[chosen], math.sqrt(self._camera.focal[0] * self._camera.focal[1])
        other = solutions[1 - chosen].error if len(solutions) == 2 else math.inf
        return Sighting(
            id=target,
            stamp=stamp,
            corners=np.concatenate([self._tracks[number].corners for number in numbers]),
            pose=best.pose,
            covariance=best.covariance,
            ambiguity=other / max(best.error, 1e-12),
            error=best.error * focal,
            seen=seen,
            solutions=tuple(solutions),
        )


def _extent(detection: Detection) -> float:
    return float(np.ptp(detection.corners, axis=0).sum())


def _followed(old: _Track | None, corners: Floats, stamp: int, blur: float) -> _Track:
    """A marker's track with a new place."""
    if old is None or stamp <= old.stamp:
        return _Track(corners, np.zeros((4, 2)), stamp, blur)
    return _Track(corners, (corners - old.corners) / ((stamp - old.stamp) / 1e9), stamp, blur)


def _predicted(track: _Track, stamp: int) -> tuple[Floats, float]:
    """Where a marker's corners should be, and how far off they may be in pixels."""
    seconds = (stamp - track.stamp) / 1e9
    return track.corners + track.velocity * seconds, float(np.abs(track.velocity).max()) * seconds / 2


def _region(predicted: tuple[Floats, float], shape: tuple[int, ...]) -> Region:
    corners, doubt = predicted
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = max(_MARGIN * float(np.max(high - low)), _LEAST_MARGIN) + doubt
    left, top = np.floor(np.maximum(low - margin, 0)).astype(int)
    right, bottom = np.ceil(np.minimum(high + margin, (shape[1], shape[0]))).astype(int)
    return Region(int(left), int(top), max(int(right), 0), max(int(bottom), 0))
