"""Tracking of markers from frame to frame.

In all frames, each marker of the previous frames is fitted at its predicted position. If that fails, the region around
this position is searched, and then the whole frame. For new markers, the whole frame is searched quickly every tenth of
a second, and thoroughly every half second, or at once if no marker is where it was: time and evidence decide, and not
the number of frames, because a camera may have two frames a second. Every marker is fitted at full resolution, so the
accuracy of its pose does not depend on how it was found.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, pairwise

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.uncertainty import Uncertainty, camera_roots, pixels_by_camera, pixels_to_rays
from roverkit.vision.markers.detection import SMALLEST_SIDE, Detector, Image, MarkerDetection, Region, to_grey
from roverkit.vision.markers.edges import Fit, Guess
from roverkit.vision.markers.flips import Flips
from roverkit.vision.markers.marker_fits import Fitted, extent, fit_markers
from roverkit.vision.markers.marker_set import MarkerSet, TargetId
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.pnp import (
    Corners,
    Solution,
    mixed_covariance,
    solve,
    square_poses,
    with_all_errors,
)
from roverkit.vision.poses.pose import Pose
from roverlink.runtime.core.errors import SetupError

SCAN_S = 0.09
"""Time in seconds between searches of the whole frame: a little less than three frames at 30 frames a second."""
THOROUGH_S = 0.45
"""Time in seconds between thorough searches of the whole frame: every frame of a camera with two frames a second."""
FORGOTTEN_S = 0.5
"""Time in seconds for which a lost marker is still searched at its predicted position."""
NEAR = 1.0
"""Largest distance in pixels between fitted and predicted corners.

A fit that ends farther away may have started with wrong pixels.
"""
TOGETHER = 3
"""Number of frames with several markers of one number after which each of them counts as shared, even if it is alone.

In a single frame, something else may have been taken for a marker.
"""
_IMPOSSIBLE = 1e-5
"""Probability up to which the other pose of a marker does not count in the covariance."""
_SURPRISE = 0.5
"""Error in pixels of the last prediction from the velocity above which the next one comes from the image."""
_BENT = 0.15
"""Difference between the motions of a marker's corners, relative to its size, above which the optical flow is wrong."""
_REGIONS = 4
"""Number of regions that are searched in less time than the whole frame is searched quickly."""
_FLOW = {"winSize": (15, 15), "maxLevel": 3, "flags": cv2.OPTFLOW_USE_INITIAL_FLOW}
"""Optical flow at the corners: it follows them over some tens of pixels from where they are expected."""
_MARGIN = 0.3  # border around the predicted position, as a fraction of the marker's size
_LEAST_MARGIN = 10  # pixels


@dataclass(frozen=True, slots=True, eq=False)
class LandmarkDetection:
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
    """Covariance (6, 6) of the pose: x y z rotX rotY rotZ, about the camera's axes; see `vision/poses/pose.py`.

    It contains the possibility that the other pose is the true one, weighted by its probability.
    """
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
    shared: bool = False
    """True if several markers have this number, so the number does not say which one it is.

    They are in this frame, or they were together in `TOGETHER` earlier ones. Such a marker is never part of a board:
    `id` is its own number, and `pose` that of its own frame.
    """
    probability: float = 1.0
    """Probability that `pose`, and not the other pose, is the true one, by this frame and the earlier ones."""


@dataclass(slots=True, eq=False)
class _Track:
    """Marker that was seen in earlier frames."""

    number: int
    fit: Fit
    corners: Floats
    """Corners (4, 2) in pixels when it was seen last."""
    stamp: int
    blur: float
    velocity: Floats = field(default_factory=lambda: np.zeros((4, 2)))
    """Velocity (4, 2) of the corners in pixels per second."""
    change: Floats = field(default_factory=lambda: np.zeros((4, 2)))
    """Change (4, 2) of the velocity in pixels per second; its half is an error of the velocity."""
    surprise: float = math.inf
    """Error in pixels of the last prediction from the velocity; infinity if there was none."""
    flips: Flips = field(default_factory=Flips)

    def predicted(self, stamp: int) -> Floats:
        """Return the corners (4, 2) predicted for `stamp`."""
        return self.corners + self.velocity * ((stamp - self.stamp) / 1e9)

    def moved(self, fitted: Fitted, stamp: int, row_s: float) -> None:
        """Set what was seen at `stamp`; `row_s` is the time in seconds from one row of the image to the next one."""
        if stamp > self.stamp:
            self.surprise = float(np.abs(fitted.corners - self.predicted(stamp)).max())
            way, seconds = fitted.corners - self.corners, (stamp - self.stamp) / 1e9
            # A corner that has moved down is read later.
            velocity = way / np.maximum(seconds + row_s * way[:, 1:], seconds / 2)
            self.velocity, self.change = velocity, velocity - self.velocity
        self.fit, self.corners, self.stamp, self.blur = fitted.fit, fitted.corners, stamp, fitted.blur


@dataclass(frozen=True, slots=True, eq=False)
class _Landmark:
    """Visible markers of a landmark, with their corners (4, 3) in the landmark's frame, in metres."""

    id: TargetId
    tracks: Sequence[_Track]
    points: Sequence[Floats]
    flips: Flips
    shared: bool = False


class Tracker:
    """Finds the markers in the frames of one camera, and computes their poses. Not thread-safe."""

    def __init__(
        self,
        camera: CameraParameters,
        markers: MarkerSet,
        *,
        scan_s: float = SCAN_S,
        thorough_s: float = THOROUGH_S,
        uncertainty: Uncertainty = Uncertainty(),  # noqa: B008  # it is frozen
    ) -> None:
        """Create a tracker that searches the whole frame every `scan_s` seconds, and thoroughly every `thorough_s`.

        `uncertainty` tells the errors beside the noise of the image, which the covariances contain.
        """
        self._markers, self._uncertainty = markers, uncertainty
        self._detector = Detector(markers)
        self._scan_s, self._thorough_s = scan_s, thorough_s
        self.use(camera)
        self.reset()

    @property
    def camera(self) -> CameraParameters:
        """Parameters of the camera."""
        return self._camera

    def use(self, camera: CameraParameters) -> None:
        """Use other parameters of the camera from the next frame on."""
        self._camera, self._roots = camera, camera_roots(camera)

    def reset(self) -> None:
        """Forget all markers of earlier frames. Called when the time of the frames jumps back."""
        self._tracks: list[_Track] = []
        self._together = Counter[int]()
        self._board_flips: dict[TargetId, Flips] = {}
        self._stamp = 0
        self._scanned = self._searched = -math.inf  # stamps of the last search, and of the last thorough one
        self._before: Image | None = None

    def track(self, image: Image, stamp: int) -> tuple[LandmarkDetection, ...]:
        """Return the landmarks in an image, grey (H, W) or BGR (H, W, 3), that was taken at `stamp`, in nanoseconds.

        Raises `SetupError` if the image does not have the size of the images of the camera's calibration.
        """
        grey = self._grey(image)
        # A looped recording or a changed clock: predictions across the jump would be wrong.
        if stamp < self._stamp:
            self.reset()
        self._tracks = [track for track in self._tracks if stamp - track.stamp < FORGOTTEN_S * 1e9]
        landmarks = self._landmarks(self._find(grey, stamp))
        # A caller may write the next grey image into the same array.
        self._stamp, self._before = stamp, grey.copy() if image.ndim == 2 else grey
        seen = self._seen(landmarks, grey)
        solved = [row for row in zip(landmarks, seen, solve(seen, _starts(seen))) if row[2]]
        given = self._uncertainty
        with_errors = with_all_errors(
            [corners for _, corners, _ in solved],
            [solutions[:2] for *_, solutions in solved],
            given.side_sigma * given.covariance_scale,
        )
        focal = math.sqrt(math.prod(self._camera.focal.tolist()))
        return tuple(_sight(landmark, *known, focal) for (landmark, *_), known in zip(solved, with_errors))

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

    # --- finding ---

    def _find(self, grey: Image, stamp: int) -> list[_Track]:
        """Return the markers in an image.

        Search the whole frame when it is time for a search, or when a marker is lost.
        """
        seen = self._follow(grey, stamp)
        # A marker that has left the image is lost, too; `FORGOTTEN_S` limits how long frames pay for its search.
        lost = [track for track in self._tracks if track not in seen]
        due = stamp - self._scanned >= self._scan_s * 1e9
        # If no marker is where it was, the frame may show another place.
        thorough = stamp - self._searched >= self._thorough_s * 1e9 or (due and bool(lost) and not seen)
        scanned = due or thorough or len(lost) > _REGIONS
        found = _distinct(self._scan(self._covered(grey, seen), stamp, thorough=thorough), seen) if scanned else []
        numbers = [detection.number for detection in found]
        for track in lost:
            if track.number in numbers:
                numbers.remove(track.number)
            else:
                found += self._detector.scan_region(grey, _region(track, stamp, grey.shape))
        if not scanned and len(_distinct(found, seen)) < len(lost):
            found += self._scan(self._covered(grey, seen), stamp, thorough=False)
        seen += self._fit_found(grey, _distinct(found, seen), stamp)
        return seen

    def _scan(self, grey: Image, stamp: int, *, thorough: bool) -> list[MarkerDetection]:
        self._scanned = stamp
        if not thorough:
            return self._detector.scan_quickly(grey)
        self._searched = stamp
        return self._detector.scan(grey)

    def _covered(self, grey: Image, seen: Sequence[_Track]) -> Image:
        """Return an image in which white covers the markers that are seen, so that a search does not read them again.

        A marker stays if another one, with its white border, may be in one of its cells.
        """
        covered: Image = grey.copy()
        modules = self._markers.bits.markerSize + 2
        hidden = [track.corners for track in seen if extent(track.corners) < SMALLEST_SIDE * (modules + 2)]
        corners = np.array(hidden).reshape(-1, 4, 2)
        middles = corners.mean(axis=1, keepdims=True)
        # Half of the white border is covered, too.
        outlines = np.rint(middles + (corners - middles) * (1 + 1 / modules)).astype(np.int32)
        x, y = np.moveaxis(np.clip(outlines, 0, np.array(grey.shape[::-1]) - 1), 2, 0)
        for outline, white in zip(outlines, grey[y, x].mean(axis=1).tolist()):
            cv2.fillConvexPoly(covered, outline, white)
        return covered

    def _follow(self, grey: Image, stamp: int) -> list[_Track]:
        """Fit the markers of earlier frames at their predicted positions; return those that are there."""
        places = self._predicted(grey, stamp)
        guesses = [self._guess(track, place) for track, place in places]
        seen: list[_Track] = []
        for (track, place), fitted in zip(places, fit_markers(grey, self._camera, guesses)):
            if fitted and np.abs(fitted.corners - place).max() <= NEAR * fitted.shrunk:
                track.moved(fitted, stamp, self._row_s(grey))
                seen.append(track)
        return seen

    def _guess(self, track: _Track, place: Floats) -> Guess:
        pattern, fit = self._markers.pattern(track.number), track.fit
        return Guess(pattern, place, track.blur, fit.lines, fit.rigidity)

    def _row_s(self, grey: Image) -> float:
        """Return the time in seconds from one row of an image to the next one."""
        return self._uncertainty.readout_time / len(grey)

    def _predicted(self, grey: Image, stamp: int) -> list[tuple[_Track, Floats]]:
        """Return the markers of earlier frames that are expected somewhere, with their expected corners (4, 2).

        These come from the marker's velocity, or from optical flow if the last prediction from the velocity was bad. If
        the flow is wrong, the marker is left out, because a fit that starts at a wrong place takes long.
        """
        steady: list[tuple[_Track, Floats]] = []
        doubtful: list[tuple[_Track, Floats]] = []
        for track in self._tracks:
            by_flow = track.surprise > _SURPRISE and track.stamp == self._stamp
            (doubtful if by_flow else steady).append((track, track.predicted(stamp)))
        if not doubtful or self._before is None or self._before.shape != grey.shape:
            return steady + doubtful
        corners = np.concatenate([track.corners for track, _ in doubtful]).astype(np.float32)
        expected = np.concatenate([place for _, place in doubtful]).astype(np.float32)
        flow, good, _ = cv2.calcOpticalFlowPyrLK(self._before, grey, corners, expected, **_FLOW)
        for (track, _), place, known in zip(doubtful, flow.reshape(-1, 4, 2).astype(float), good.reshape(-1, 4)):
            motion = place - track.corners
            if known.all() and np.abs(motion - motion.mean(axis=0)).max() < _BENT * extent(track.corners):
                steady.append((track, place))
        return steady

    def _fit_found(self, grey: Image, found: Sequence[MarkerDetection], stamp: int) -> list[_Track]:
        """Fit detected markers, and return their tracks: those of lost markers with the same numbers, or new ones."""
        guesses = [
            Guess(self._markers.pattern(detection.number), detection.corners, doubtful=detection.doubtful)
            for detection in found
        ]
        seen = []
        for detection, fitted in zip(found, fit_markers(grey, self._camera, guesses)):
            if fitted is None:
                continue
            lost = [track for track in self._tracks if track.number == detection.number and track.stamp != stamp]
            track = min(lost, key=lambda track: _distance(track.corners, fitted.corners), default=None)
            if track is None:
                track = _Track(detection.number, fitted.fit, fitted.corners, stamp, fitted.blur)
                self._tracks.append(track)
            else:
                track.moved(fitted, stamp, self._row_s(grey))
            seen.append(track)
        return seen

    # --- poses ---

    def _landmarks(self, seen: Iterable[_Track]) -> list[_Landmark]:
        """Return the landmarks to which the visible markers belong."""
        tracks = sorted(seen, key=lambda track: (track.number, *track.corners[0]))
        counts = Counter(track.number for track in tracks)
        self._together.update(number for number, count in counts.items() if count > 1)
        landmarks, boards = [], dict[TargetId, list[_Track]]()
        for track in tracks:
            target = self._markers.target(track.number)
            shared = counts[track.number] > 1 or self._together[track.number] >= TOGETHER
            if shared or target == track.number:
                points = self._markers.own_points(track.number)
                landmarks.append(_Landmark(track.number, [track], [points], track.flips, shared))
            else:
                boards.setdefault(target, []).append(track)
        for name, group in boards.items():
            points_of = [self._markers.points(track.number) for track in group]
            landmarks.append(_Landmark(name, group, points_of, self._board_flips.setdefault(name, Flips())))
        return landmarks

    def _seen(self, landmarks: Sequence[_Landmark], grey: Image) -> list[Corners]:
        """Return the corners of each landmark, with their covariance, at the time of the middle row of the image."""
        tracks = [track for landmark in landmarks for track in landmark.tracks]
        if not tracks:
            return []
        given = self._uncertainty
        rays = np.concatenate([track.fit.rays for track in tracks])
        rows = np.concatenate([track.corners[:, 1] for track in tracks])
        seconds = ((rows + 0.5 - len(grey) / 2) * self._row_s(grey))[:, None]
        motion, doubt = (
            np.concatenate(parts) * seconds for parts in zip(*((track.velocity, track.change / 2) for track in tracks))
        )
        floor = np.broadcast_to(given.corner_floor * np.eye(2), (len(rays), 2, 2))
        pixels = [floor, pixels_by_camera(self._camera, self._roots, rays), doubt[..., None], motion[..., None]]
        shifts = pixels_to_rays(self._camera, rays, np.concatenate(pixels, axis=2))
        rays = (rays - shifts[:, -1].reshape(-1, 2)).reshape(-1, 4, 2)
        shifts = given.covariance_scale * shifts[:, :-1].reshape(len(tracks), 4, 2, -1)
        own = _diagonal(shifts[..., :2] @ np.swapaxes(shifts[..., :2], 2, 3))
        noise = np.array([track.fit.covariance for track in tracks]) * given.covariance_scale**2
        shared = shifts[..., 2:].reshape(len(tracks), 8, -1)
        ends = accumulate((len(landmark.tracks) for landmark in landmarks), initial=0)
        return [
            Corners(
                points=np.concatenate(landmark.points),
                rays=rays[first:end].reshape(-1, 2),
                covariance=_diagonal(noise[first:end]),
                own=_diagonal(own[first:end]),
                shared=shared[first:end].reshape(8 * (end - first), -1),
            )
            for landmark, (first, end) in zip(landmarks, pairwise(ends))
        ]


def _diagonal(blocks: Floats) -> Floats:
    """Return the block diagonal matrices (..., K N, K N) with K blocks (..., K, N, N) each."""
    *many, count, size, _ = blocks.shape
    if count == 1:
        return blocks[..., 0, :, :]
    whole = np.zeros((*many, count, size, count, size))
    for place in range(count):
        whole[..., place, :, place, :] = blocks[..., place, :, :]
    return whole.reshape(*many, count * size, count * size)


def _sight(landmark: _Landmark, seen: Corners, solutions: Sequence[Solution], focal: float) -> LandmarkDetection:
    stamp = landmark.tracks[0].stamp
    probabilities = landmark.flips.weigh(solutions, stamp)
    chosen = probabilities.index(max(probabilities))
    best = solutions[chosen]
    other = solutions[1 - chosen].error if len(solutions) == 2 else math.inf
    possible = [
        (probability, solution.pose, solution.covariance)
        for probability, solution in zip(probabilities, solutions)
        if probability > _IMPOSSIBLE
    ]
    return LandmarkDetection(
        id=landmark.id,
        stamp=stamp,
        corners=np.concatenate([track.corners for track in landmark.tracks]),
        pose=best.pose,
        covariance=mixed_covariance(best.pose, possible),
        probability=probabilities[chosen],
        ambiguity=other / max(best.error, 1e-12),
        error=best.error * focal,
        seen=seen,
        solutions=tuple(solutions),
        shared=landmark.shared,
    )


def _distinct(found: Sequence[MarkerDetection], seen: Sequence[_Track]) -> list[MarkerDetection]:
    """Return the detections of markers that are not seen yet; of several detections of a marker, the largest one."""
    if not found:
        return []
    known = len(seen)
    corners = np.array([track.corners for track in seen] + [detection.corners for detection in found]).reshape(-1, 4, 2)
    middles, sizes = corners.mean(axis=1).tolist(), np.ptp(corners, axis=1).mean(axis=1).tolist()
    of_number: dict[int, list[int]] = {}
    for place, track in enumerate(seen):
        of_number.setdefault(track.number, []).append(place)
    distinct = []
    for place in sorted(range(known, len(corners)), key=lambda place: -sizes[place]):
        detection = found[place - known]
        others = of_number.setdefault(detection.number, [])
        if all(math.dist(middles[place], middles[one]) >= max(sizes[place], sizes[one]) / 2 for one in others):
            others.append(place)
            distinct.append(detection)
    return distinct


def _distance(corners: Floats, others: Floats) -> float:
    return float(np.linalg.norm(corners.mean(axis=0) - others.mean(axis=0)))


def _region(track: _Track, stamp: int, shape: tuple[int, ...]) -> Region:
    corners = track.predicted(stamp)
    doubt = float(np.abs(corners - track.corners).max()) / 2
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = max(_MARGIN * float(np.max(high - low)), _LEAST_MARGIN) + doubt
    left, top = np.floor(np.maximum(low - margin, 0)).astype(int)
    right, bottom = np.ceil(np.minimum(high + margin, (shape[1], shape[0]))).astype(int)
    return Region(int(left), int(top), max(int(right), 0), max(int(bottom), 0))


def _starts(seen: Sequence[Corners]) -> list[list[Pose]]:
    """Return the start poses for each landmark: the possible poses of its single markers."""
    if not seen:
        return []
    points = np.concatenate([corners.points.reshape(-1, 4, 3) for corners in seen])
    rays = np.concatenate([corners.rays.reshape(-1, 4, 2) for corners in seen])
    poses = iter(square_poses(points, rays))
    return [[pose for _ in range(len(corners.points) // 4) for pose in next(poses)] for corners in seen]
