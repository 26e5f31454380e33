"""Scenes with known truth: a lens, a marker of given size at a random pose, and a background."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from roverkit.vision.images.rendering import (
    Floats,
    Grey,
    Lens,
    Pose,
    marker_print,
    project,
    render,
    texels_for,
    texture,
)

DICTIONARY = cv2.aruco.DICT_5X5_250
SIDE = 0.05
"""Side of the marker in metres."""
FRAME_NS = 33_000_000
"""Time between two frames in nanoseconds."""
FOCAL = 920.0
DISTORTION = (0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651)
"""Distortion of the rover's camera."""
LARGEST_TILT = np.radians(60)


@dataclass(frozen=True, slots=True)
class Scene:
    """Frame with its truth: the marker's number and pose, and its corners (4, 2) in pixels."""

    frame: Grey
    number: int
    pose: Pose
    corners: Floats


def lens(width: int = 640, height: int = 480) -> Lens:
    """Return a camera with the rover's distortion; its principal point is not the image's centre."""
    matrix = np.array([[FOCAL, 0, width / 2 + 7.3], [0, FOCAL * 1.004, height / 2 - 4.6], [0, 0, 1]])
    return Lens(matrix, DISTORTION, (width, height))


def corner_points(side: float = SIDE) -> Floats:
    """Return the corners (4, 3) of a marker in its frame, in OpenCV's order."""
    h = side / 2
    return np.array([[-h, h, 0], [h, h, 0], [h, -h, 0], [-h, -h, 0]])


def random_pose(camera: Lens, side_px: float, rng: np.random.Generator) -> Pose:
    """Return a pose of a marker: tilted, completely in the frame, at the distance for a side of `side_px`."""
    distance = SIDE * FOCAL / side_px
    width, height = camera.size
    rim = 0.5 * 2**0.5 * side_px * 9 / 7 + 4
    pixel = np.array([rng.uniform(rim, width - rim), rng.uniform(rim, height - rim)])
    translation = np.append(camera.rays(pixel), 1.0) * distance
    tilt, towards, roll = rng.uniform(0, LARGEST_TILT), rng.uniform(0, 2 * np.pi), rng.uniform(0, 2 * np.pi)
    axis = np.array([np.cos(towards), np.sin(towards), 0.0])
    facing = cv2.Rodrigues(axis * tilt)[0] @ np.diag([1.0, -1.0, -1.0]) @ cv2.Rodrigues(np.array([0, 0, roll]))[0]
    return Pose(facing, translation)


def scenes(side_px: float, count: int, seed: int) -> Iterator[Scene]:
    """Yield frames with one marker each."""
    camera = lens()
    for index in range(count):
        rng = np.random.default_rng([seed, int(side_px), index])
        number, pose = int(rng.integers(250)), random_pose(camera, side_px, rng)
        plane = marker_print(DICTIONARY, number, SIDE, texels=texels_for(side_px))
        frame = render(camera, texture(camera.size, rng), [(plane, pose)], rng)
        yield Scene(frame, number, pose, project(camera, pose, corner_points()))


@dataclass(frozen=True, slots=True)
class DriveFrame:
    """Frame of a drive with its time in nanoseconds and the true pose of each marker."""

    frame: Grey
    stamp: int
    poses: dict[int, Pose]


def drive(count: int, seed: int, size: tuple[int, int] = (1280, 720)) -> Iterator[DriveFrame]:
    """Yield frames 33 ms apart: the camera rolls and moves back and forth before four markers of 40 to 90 pixels."""
    camera = lens(*size)
    rng = np.random.default_rng(seed)
    scene = texture(size, rng)
    width, height = size
    places = [(0.25, 0.3), (0.7, 0.25), (0.3, 0.75), (0.75, 0.7)]
    starts = []
    for place, side_px in zip(places, (40, 55, 70, 90)):
        pose = random_pose(camera, side_px, rng)
        ray = camera.rays(np.array([place[0] * width, place[1] * height]))
        starts.append((int(rng.integers(250)), side_px, pose.rotation, np.append(ray, 1.0) * pose.translation[2]))
    for index in range(count):
        swing = np.sin(index / 20)
        turn = cv2.Rodrigues(np.array([0.0, 0.0, 0.05 * swing]))[0]
        closer = np.array([0.02, -0.01, -0.05]) * swing
        poses = {number: Pose(turn @ rotation, turn @ (shift + closer)) for number, _, rotation, shift in starts}
        planes = [
            (marker_print(DICTIONARY, number, SIDE, texels=texels_for(side_px)), poses[number])
            for number, side_px, _, _ in starts
        ]
        yield DriveFrame(render(camera, scene, planes, rng), index * FRAME_NS, poses)
