"""Pictures of the pages about vision and objects, and the recording of a tutorial."""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from roverkit.demo.field import SIDE, landmarks, parameters, write_cameras, write_field
from roverkit.objects.detector import ObjectDetector
from roverkit.objects.object_tracker import ObjectTracker
from roverkit.objects.scenes import sequence
from roverkit.objects.shipped_model import PATH
from roverkit.vision import Landmarks, MarkerSet, Tracker, localize
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.frames import Frame
from roverkit.vision.images.drawing import SEEN, draw
from roverkit.vision.images.film import Film as Writer
from roverkit.vision.images.object_drawing import draw_objects
from roverkit.vision.localization.field_tracker import FieldTracker, LandmarkResult, MountedCamera
from roverkit.vision.markers.detection import Detector, Image, MarkerDetection, to_grey

from bench.report import draw as draw_charts
from rover.bench.vision.accuracy import SIZES, measure
from rover.bench.vision.circling_film import RATE_HZ, Film, render_film

FOLDER = Path("rover/docs/vision")
POSES = 100
"""Poses per size, for the chart of errors."""
_LEVELS = 16  # grey levels that are merged, so that noise does not make the files large
_ROUGH = (40, 40, 235)
_REGION = (235, 160, 40)
_AROUND = 6  # pixels around a marker
_ZOOM = 12
_AXES = ("x, m", "y, m")
_SEED = 4  # of the image with objects
_SURE = 2.4477  # radius in standard deviations that holds 95 % of a bivariate normal distribution


def main(words: list[str]) -> int:
    """Make all pictures, or with --quick all but the chart of errors."""
    parser = argparse.ArgumentParser(prog="python -m rover.bench.vision.pictures", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=FOLDER, metavar="DIR", help="folder for the pictures (default: %(default)s)"
    )
    parser.add_argument("--quick", action="store_true", help="leave out the chart of errors, which takes minutes")
    options = parser.parse_args(words)
    options.out.mkdir(parents=True, exist_ok=True)
    film = render_film()
    write_recording(options.out, film)
    draw_steps(options.out, film)
    draw_detections(options.out / "objects.png")
    if not options.quick:
        print(draw_charts(options.out / "errors.png", {"accuracy": measure(POSES, SIZES, print)}))
    return 0


def write_recording(folder: Path, film: Film) -> None:
    """Write the video of a drive, the camera with its parameters, and the landmarks."""
    with Writer(folder / "drive.mp4", RATE_HZ) as writer:
        for frame in film:
            writer.add(frame.image, frame.stamp)
    write_field(folder)
    write_cameras(folder, {"source": "drive.mp4"})


def draw_detections(path: Path) -> None:
    """Draw the objects that the shipped model finds in a rendered image."""
    tracker, detector = ObjectTracker(), ObjectDetector(PATH)
    # An object comes out with its second detection.
    for number, scene in enumerate(itertools.islice(sequence(_SEED, 60, panel=True), 2)):
        found = tracker.track(detector.detect(scene.image), number)
    _write(path, draw_objects(scene.image, found, {}))


def draw_steps(folder: Path, film: Film) -> None:
    """Draw a picture for each step from a frame to a position on the field."""
    tracker = Tracker(parameters(), MarkerSet(side=SIDE))
    _, second = _results(list(film)[:2], tracker)  # the first frame is searched completely
    _write(folder / "frame.png", second.frame.image)
    _write(folder / "looks.png", _with_looks(second))
    rough, *_ = Detector(MarkerSet(side=SIDE)).scan(to_grey(second.frame.image))
    _write(folder / "edges.png", _with_edges(second, rough))
    _write(folder / "seen.png", draw(second.frame.image, parameters(), second.detections, second.camera_pose))
    _draw_field(folder / "field.png", film)


def _results(frames: Iterable[Frame], tracker: Tracker) -> list[LandmarkResult]:
    field_tracker = FieldTracker(landmarks=landmarks())
    return [field_tracker.track(MountedCamera(tracker), frame) for frame in frames]


def _with_looks(result: LandmarkResult) -> Image:
    """Return the frame, darkened except around the markers, whose edges are fitted where they were expected."""
    shown: Image = result.frame.image // 3
    for detection in result.detections:
        left, top = np.floor(detection.corners.min(axis=0)).astype(int) - _AROUND
        right, bottom = np.ceil(detection.corners.max(axis=0)).astype(int) + _AROUND
        shown[top:bottom, left:right] = result.frame.image[top:bottom, left:right]
        cv2.rectangle(shown, (left, top), (right - 1, bottom - 1), _REGION, 1)
    return shown


def _with_edges(result: LandmarkResult, rough: MarkerDetection) -> Image:
    """Return an enlarged marker with its detected and its refined corners."""
    (one,) = (detection for detection in result.detections if detection.id == rough.number)
    low = np.floor(one.corners.min(axis=0)).astype(int) - 5
    high = np.ceil(one.corners.max(axis=0)).astype(int) + 6
    part = result.frame.image[low[1] : high[1], low[0] : high[0]]
    shown: Image = cv2.resize(part, None, fx=_ZOOM, fy=_ZOOM, interpolation=cv2.INTER_NEAREST)
    for corners, colour in ((rough.corners, _ROUGH), (one.corners, SEEN)):
        places = np.rint(((corners - low + 0.5) * _ZOOM - 0.5) * 16).astype(np.int32)
        cv2.polylines(shown, [places], True, colour, 2, cv2.LINE_AA, 4)
    return shown


def _write(path: Path, image: Image) -> None:
    grey = np.ptp(image, axis=2, keepdims=True) == 0
    cv2.imwrite(str(path), np.where(grey, image // _LEVELS * _LEVELS, image), [cv2.IMWRITE_PNG_COMPRESSION, 9])
    print(f"picture: {path}")


def _draw_field(path: Path, film: Film) -> None:
    """Draw the field from above, and one position on it enlarged."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.8), layout="constrained")
    FigureCanvasAgg(figure)
    field, near = figure.subplots(1, 2)
    results = _results(film, Tracker(parameters(), MarkerSet(side=SIDE)))
    _plot_field(field, film, results)
    _plot_place(near, film, results[0])
    figure.savefig(path, dpi=90)
    print(f"picture: {path}")


def _plot_field(axes: Any, film: Film, results: list[LandmarkResult]) -> None:
    truth = np.array([pose.translation for pose in film.truth])
    found = np.array([result.camera_pose.pose.translation for result in results if result.camera_pose])
    axes.plot(truth[:, 0], truth[:, 1], color="lightgray", linewidth=5, label="true position")
    axes.plot(found[:, 0], found[:, 1], ".", color="tab:green", label="estimated position")
    for number, one in landmarks().places.items():
        x, y, _ = one.pose.translation
        axes.plot([x, x], [y - SIDE / 2, y + SIDE / 2], color="black", linewidth=4)
        axes.annotate(str(number), (x, y), xytext=(6, -3), textcoords="offset points")
    axes.set(title="the field from above", xlabel=_AXES[0], ylabel=_AXES[1], aspect="equal")
    axes.legend(fontsize="small", loc="lower left")


def _plot_place(axes: Any, film: Film, result: LandmarkResult) -> None:
    """Plot the uncertainty of a position from single landmarks, and from all of them."""
    known, truth = landmarks(), film.truth[result.frame.number].translation
    for detection in result.detections:
        single = localize([detection], Landmarks(known.frame, {detection.id: known.places[detection.id]}))
        if single:
            _plot_ellipse(
                axes, single.pose.translation - truth, single.covariance, "tab:orange", f"from {detection.id} alone"
            )
    if result.camera_pose:
        _plot_ellipse(
            axes,
            result.camera_pose.pose.translation - truth,
            result.camera_pose.covariance,
            "tab:green",
            "from all together",
        )
    axes.plot([0], [0], "+", color="black", markersize=12, label="true position")
    axes.set(title="one position with 95 % ellipses", xlabel="x, mm", ylabel="y, mm")
    axes.legend(fontsize="small")


def _plot_ellipse(axes: Any, place: Floats, covariance: Floats, colour: str, label: str) -> None:
    values, vectors = np.linalg.eigh(covariance[:2, :2])
    angles = np.linspace(0, 2 * np.pi, 90)
    rim = vectors @ (np.sqrt(values)[:, None] * np.stack([np.cos(angles), np.sin(angles)])) * _SURE + place[:2, None]
    axes.plot(*(1e3 * rim), color=colour, label=label, alpha=0.9 if "all" in label else 0.5)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
