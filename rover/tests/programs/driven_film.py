"""A short drive on a field, as files and with its truth, and the command line that tracks it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from roverkit.demo.field import SIDE, write_cameras, write_field

from rover.bench.vision.circling_film import FOLDER, Film, render_film
from roverlink.__main__ import main


@dataclass(frozen=True)
class Field:
    """A drive on a field as files, and its truth."""

    folder: Path
    film: Film

    @classmethod
    def written(cls, folder: Path, count: int) -> Field:
        """Write a drive of some frames, its landmarks, and a file of cameras with the drive into a folder."""
        film = _film(count)
        (folder / "frames").mkdir()
        for frame in film:
            cv2.imwrite(str(folder / "frames" / f"{frame.number}.png"), frame.image)
        write_field(folder)
        write_cameras(folder, FOLDER)
        return cls(folder, film)

    def words(self, *more: object, source: object = None) -> list[str]:
        """The command line that tracks a source: the frames, with the parameters of the camera, or another one."""
        of_frames = (self.folder / "frames", "--parameters", self.folder / "camera.yml", "--rate", 10)
        given = ("--side", SIDE, "--landmarks", self.folder / "landmarks.yaml")
        return ["aruco", "track", *map(str, (*(of_frames if source is None else (source,)), *given, *more))]

    def off(self, number: int, position: Sequence[float]) -> float:
        """Metres from a position to where the camera was in a frame."""
        return float(np.linalg.norm(self.film.truth[number % len(self.film.frames)].translation - position))


def lines(capsys: pytest.CaptureFixture[str], words: list[str]) -> tuple[list[Any], str]:
    """Run a command to its end; the JSON lines of its output, and its errors."""
    assert main(words) == 0
    told = capsys.readouterr()
    return [json.loads(line) for line in told.out.splitlines()], told.err


@cache
def _film(count: int) -> Film:
    return render_film(count)
