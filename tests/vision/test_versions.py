"""The poses are the same with each version of OpenCV that is supported."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path

import pytest

from bench.vision.contestants import camera_of
from bench.vision.scenes import SIDE, drive, lens
from roverlink.vision import MarkerSet, Tracker

_SIZE = (640, 480)
_GOLDEN = Path(__file__).parent / "poses_of_the_drive.json"


def test_poses_are_those_of_the_other_versions(request: pytest.FixtureRequest) -> None:
    """Three frames of a drive give the committed poses to 1e-9; `--update-cases` writes them anew."""
    tracker = Tracker(camera_of(lens(*_SIZE)), MarkerSet(side=SIDE))
    found = [
        {str(one.id): [*one.pose.translation.tolist(), *one.pose.rotation.ravel().tolist()] for one in sightings}
        for shot in islice(drive(8, 5, _SIZE), 3)
        for sightings in [tracker.track(shot.frame, shot.stamp)]
    ]
    if request.config.getoption("--update-cases"):
        _GOLDEN.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")
    for poses, golden in zip(found, json.loads(_GOLDEN.read_text()), strict=True):
        assert poses == {id: pytest.approx(pose, abs=1e-9) for id, pose in golden.items()}
