"""The poses are the same with each version of OpenCV that is supported."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from bench.vision.contestants import camera_of
from bench.vision.scenes import SIDE, drive, lens
from roverlink.vision import MarkerSet, Pose, Tracker

_SIZE = (640, 480)
_GOLDEN = Path(__file__).parent / "poses_of_the_drive.json"


def test_poses_are_those_of_the_other_versions(request: pytest.FixtureRequest) -> None:
    """Three frames of a drive give the committed poses to a standard deviation; `--update-cases` writes them anew.

    They are not equal: versions detect some corners a pixel apart, and where the edge fit ends depends on its start.
    """
    tracker = Tracker(camera_of(lens(*_SIZE)), MarkerSet(side=SIDE))
    film = [tracker.track(shot.frame, shot.stamp) for shot in islice(drive(8, 5, _SIZE), 3)]
    found = [{str(one.id): one for one in sightings} for sightings in film]
    if request.config.getoption("--update-cases"):
        poses = [
            {name: [*one.pose.translation.tolist(), *one.pose.rotation.ravel().tolist()] for name, one in row.items()}
            for row in found
        ]
        _GOLDEN.write_text(json.dumps(poses, indent=1, sort_keys=True) + "\n")
    for row, golden in zip(found, json.loads(_GOLDEN.read_text()), strict=True):
        assert row.keys() == golden.keys()
        for name, numbers in golden.items():
            pose, sigma = row[name].pose, np.sqrt(np.diag(row[name].covariance))
            expected = Pose(np.reshape(numbers[3:], (3, 3)), np.array(numbers[:3]))
            assert (np.abs(pose.translation - expected.translation) < sigma[:3]).all()
            assert pose.angle_to(expected) < np.linalg.norm(sigma[3:])
