"""The tracker of ``roverlink aruco track``, with the rendered images of ``roverlink simulate --rover``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from roverlink.demo.field import AHEAD, HEIGHT_M, SIDE, parameters
from roverlink.driving.arcs import PlanarPose
from roverlink.runtime.interfaces import vision_msgs
from roverlink.simulation.rover_camera import FRAME, RoverCamera
from roverlink.vision import MarkerSet, Pose, TargetId, Tracker
from roverlink.vision.ros.sighting_messages import FrameNames, detections_of
from tests.driving.simulated_tracker import write_landmarks


class RenderedTracker:
    """Camera that looks ahead, with the tracker of its images."""

    mount = Pose(AHEAD, np.array([0.0, 0.0, HEIGHT_M]))

    def __init__(self, seed: int, folder: Path, places: Mapping[TargetId, Pose]) -> None:
        """Stand the landmarks at their places, which are written to a file in the folder."""
        path = folder / "standing.yaml"
        write_landmarks(path, places)
        self._camera = RoverCamera(path, seed)
        self._tracker = Tracker(parameters(), MarkerSet(side=SIDE))

    def see(self, rover: PlanarPose, stamp: int) -> vision_msgs.Detection3DArray:
        """Return the message about an image that is taken at a pose of the rover."""
        image = np.repeat(self._camera.image(rover)[:, :, None], 3, axis=2)
        return detections_of(self._tracker.track(image, stamp), stamp, FrameNames(FRAME, "aruco_"))
