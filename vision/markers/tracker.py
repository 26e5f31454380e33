"""Tracking of markers from frame to frame.

Every few frames, the whole frame is searched at half resolution, and rarely at full resolution. In all other frames,
each marker is fitted at its predicted position. If that fails, the region around this position is searched, and then
the whole frame. Every marker is fitted at full resolution, so the accuracy of its pose does not depend on how it was
found.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.camera.camera_model import CameraParameters, Floats
from roverlink.vision.camera.uncertainty import Uncertainty, camera_roots, pixels_to_rays, rays_by_camera
from roverlink.vision.markers.detection import Detection, Detector, Image, Region, to_grey
from roverlink.vision.markers.edges import FIRST_BLUR, Fit, Guess, fit_edges
from roverlink.vision.markers.flips import Flips
from roverlink.vision.markers.marker_set import MarkerSet, TargetId
from roverlink.vision.poses.pnp import Corners, Solution, side_shifts, solve, square_poses, with_all_errors
from roverlink.vision.poses.pose import Pose

# At 30 frames a second, a new marker is seen after 0.2 s. Below 25 pixels it waits for a search at full resolution,
# which comes once a second.
SCAN_EVERY = 6
"""Number of frames between searches of the whole frame."""
FULL_EVERY = 5
"""Number of searches of the whole frame of which one, the first, uses full resolution; the others use half."""
FORGOTTEN_S = 0.5
"""Time in seconds for which a lost marker is still searched at its predicted position."""
EXPLAINED = 0.75
"""Least share of the pixels' variance that a marker's pattern must explain; patterns that are no markers stay below."""
CONTRAST = 8.0
"""Least difference between white and black of a marker, in grey levels."""
NEAR = 1.0
"""Largest distance in pixels between fitted and predicted corners.

A fit that ends farther away may have started with wrong pixels.
"""
_MARGIN = 0.3  # border around the predicted position, as a fraction of the marker's size
_LEAST_MARGIN = 10  # pixels


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """Landmark (marker or board) that was found in an image, with its pose.

    The pose is in the camera's optical frame: x right, y down, z forward.
    """

    id: TargetId
    """Number of the marker, or name of the board."""
    stamp: int
    """Time in nanoseconds, as given with the image."""
    corners: Floats
    """Refined corners (N, 2) in pixels, 4 for each visible marker, in OpenCV's order."""
    pose: Pose
    """Transform from the landmark's frame to the camera's, in metres."""
    covariance: Floats
    """Covariance (6, 6) of the pose: x y z rotX rotY rotZ, about the camera's axes; see `vision/poses/pose.py`."""
    ambiguity: float
    """Ratio of the rejected pose's reprojection error to that of `pose`; infinity if there is only one pose.

    A flat marker has two possible poses. If the ratio is near 1, one frame cannot decide between them. If it is below
    1, the rejected pose fits this frame better, but `pose` was chosen because it fitted the earlier frames better.
    """
    error: float
    """Reprojection error: root mean square distance in pixels between observed and projected corners."""
    seen: Corners
    """Corners from which the pose was computed, as points of the landmark and as rays."""
    solutions: tuple[Solution, ...]
    """All possible poses that were found, the best fitting first; `pose` is one of them."""


@dataclass(slots=True, eq=False)
class _Track:
    """Marker that was seen in earlier frames: its last corners in pixels, and their velocity."""

    corners: Floats
    velocity: Floats
    """Velocity (4, 2) of the corners in pixels per second."""
    stamp: int
    blur: float


class Tracker:
    """Finds the markers in the frames of one camera, and computes their poses. Not thread-safe."""

    def __init__(
        self,
        camera: CameraParameters,
        markers: MarkerSet,
        *,
        scan_every: int = SCAN_EVERY,
        full_every: int = FULL_EVERY,
        uncertainty: Uncertainty = Uncertainty(),  # noqa: B008  # it is frozen
    ) -> None:
        """Create a tracker that searches the whole frame every `scan_every` frames.

        Every `full_every`-th of these searches uses full resolution; the others use half resolution. `uncertainty`
        tells the errors beside the noise of the image, which the covariances contain.
        """
        self._camera, self._markers, self._uncertainty = camera, markers, uncertainty
        self._roots = camera_roots(camera)
        self._detector = Detector(markers)
        self._scan_every, self._full_every = scan_every, full_every
        self.reset()

    def reset(self) -> None:
        """Forget all markers of earlier frames. Called when the time of the frames jumps back."""
        self._tracks: dict[int, _Track] = {}
        self._flips: dict[TargetId, Flips] = {}
        self._frames = self._scans = 0
        self._stamp = 0

    def track(self, image: Image, stamp: int) -> tuple[Sighting, ...]:
        """Return the landmarks in an image, grey (H, W) or BGR (H, W, 3), that was taken at `stamp`, in nanoseconds.

        Raises `SetupError` if the image does not have the size of the images of the camera's calibration.
        """
        grey = self._grey(image)
        # A looped recording or a changed clock: predictions across the jump would be wrong.
        if stamp < self._stamp:
            self.reset()
        self._stamp = stamp
        self._forget(stamp)
        fits = self._find(grey, stamp)
        targets = self._by_target(fits)
        seen = [self._seen(numbers, fits, len(grey)) for numbers in targets.values()]
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
                "the camera was calibrated with images of {}x{} pixels, but this image has {}x{}; calibrate at this "
                "size, or scale the parameters".format(*(self._camera.size or ()), width, height)
            )
        if image.dtype != np.uint8 or image.ndim not in (2, 3):
            raise SetupError(
                f"the image is {image.dtype} of shape {image.shape}; it must be uint8, (H, W) or (H, W, 3)"
            )
        return to_grey(image)

    def _forget(self, stamp: int) -> None:
        self._tracks = {
            number: track for number, track in self._tracks.items() if stamp - track.stamp < FORGOTTEN_S * 1e9
        }

    # --- finding ---

    def _find(self, grey: Image, stamp: int) -> dict[int, Fit]:
        """Return the fits of all markers in an image, by the number of the marker.

        Search the whole frame when it is time for a search, or when a marker is lost.
        """
        due = self._frames % self._scan_every == 0
        self._frames += 1
        found = self._scan(grey) if due else {}
        expected = {
            number: Detection(number, _predicted(track, stamp)[0])
            for number, track in self._tracks.items()
            if number not in found
        }
        fits = self._fit_all(grey, {**found, **expected}, stamp, expected)
        # A marker that has left the image is lost, too; `FORGOTTEN_S` limits how long frames pay for its search.
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
        """Add the detections `more` to `found`; of two detections with the same number, keep the larger one."""
        for one in more:
            old = found.get(one.number)
            if old is None or _extent(one) > _extent(old):
                found[one.number] = one

    # --- fitting ---

    def _fit_all(
        self, grey: Image, found: Mapping[int, Detection], stamp: int, expected: Container[int] = ()
    ) -> dict[int, Fit]:
        """Fit the edges of detected markers, and return the good fits by the number of the marker.

        A marker in `expected` counts only if its fit stays near its predicted position.
        """
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

    def _seen(self, numbers: list[int], fits: Mapping[int, Fit], height: int) -> Corners:
        """Return the corners of a landmark with their covariance; `numbers` are its visible markers.

        `height` is the number of rows of the image.
        """
        points = np.concatenate([self._markers.points(number) for number in numbers])
        rays = np.concatenate([fits[number].rays for number in numbers])
        noise = np.zeros((rays.size, rays.size))
        for place, number in enumerate(numbers):
            noise[8 * place : 8 * place + 8, 8 * place : 8 * place + 8] = fits[number].covariance
        given, scale = self._uncertainty, self._uncertainty.covariance_scale
        tracks = [self._tracks[number] for number in numbers]
        rows = np.concatenate([track.corners[:, 1] for track in tracks])
        seconds = given.readout_time * ((rows + 0.5) / height - 0.5)
        motion = np.concatenate([track.velocity for track in tracks]) * seconds[:, None]
        floor = np.zeros((len(points), 2, rays.size))
        corner = np.arange(len(points))
        floor[corner, 0, 2 * corner] = floor[corner, 1, 2 * corner + 1] = given.corner_floor
        floor_rays = pixels_to_rays(self._camera, rays, floor)
        shared = [
            rays_by_camera(self._camera, self._roots, rays),
            pixels_to_rays(self._camera, rays, motion[..., None]),
        ]
        return Corners(
            points, rays, noise * scale**2, floor_rays @ floor_rays.T * scale**2, np.concatenate(shared, axis=1) * scale
        )

    def _starts(self, landmarks: Iterable[list[int]], fits: Mapping[int, Fit]) -> list[list[Pose]]:
        """Return the start poses for each landmark: the possible poses of its single markers.

        A landmark is given by the numbers of its visible markers.
        """
        if not fits:
            return []
        points = np.stack([self._markers.points(number) for number in fits])
        poses = dict(zip(fits, square_poses(points, np.stack([fit.rays for fit in fits.values()]))))
        return [[pose for number in numbers for pose in poses[number]] for numbers in landmarks]

    def _sight(
        self, target: TargetId, numbers: list[int], seen: Corners, solutions: Sequence[Solution], stamp: int
    ) -> Sighting:
        given = self._uncertainty
        sides = side_shifts(solutions[0].pose, seen.points) * given.side_sigma * given.covariance_scale
        seen = replace(seen, shared=np.concatenate([seen.shifts, sides], axis=1))
        seen, solutions = with_all_errors(seen, solutions[:2])
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
    """Return the new track of a marker, with its velocity, after the marker was found at `corners`."""
    if old is None or stamp <= old.stamp:
        return _Track(corners, np.zeros((4, 2)), stamp, blur)
    return _Track(corners, (corners - old.corners) / ((stamp - old.stamp) / 1e9), stamp, blur)


def _predicted(track: _Track, stamp: int) -> tuple[Floats, float]:
    """Return the corners of a marker predicted for `stamp`, and the largest error of the prediction in pixels."""
    seconds = (stamp - track.stamp) / 1e9
    return track.corners + track.velocity * seconds, float(np.abs(track.velocity).max()) * seconds / 2


def _region(predicted: tuple[Floats, float], shape: tuple[int, ...]) -> Region:
    corners, doubt = predicted
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = max(_MARGIN * float(np.max(high - low)), _LEAST_MARGIN) + doubt
    left, top = np.floor(np.maximum(low - margin, 0)).astype(int)
    right, bottom = np.ceil(np.minimum(high + margin, (shape[1], shape[0]))).astype(int)
    return Region(int(left), int(top), max(int(right), 0), max(int(bottom), 0))
