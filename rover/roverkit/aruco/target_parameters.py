"""Parameters of the tracker's node: which markers it looks for, and where the landmarks are."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from roverkit.aruco.target_options import marker_side
from roverkit.aruco.tracker_declaration import NODE
from roverkit.node.declared_parameters import DeclaredParameters
from roverkit.vision import Board, Landmarks, MarkerSet, read_landmarks
from roverkit.vision.markers.boards import read_boards
from roverkit.vision.markers.marker_set import SIDE
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments.ros_args import RosArguments


@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """Markers for which a tracker looks, and the landmarks among them, if their poses are known."""

    markers: MarkerSet
    landmarks: Landmarks | None


class TargetParameters(DeclaredParameters[Targets]):
    """Parameters of the tracker's node; their first values are the options of the command line."""

    def __init__(self, arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values, and the files that they name. Raises `SetupError` if a file or a value is wrong."""
        boards = read_boards(arguments.boards) if arguments.boards else ()
        sides = dict(arguments.side)
        self._side_is_given = None in sides or "side" in ros.parameters
        options = {
            "dictionary": arguments.dictionary,
            "side": sides.pop(None, SIDE),
            "sides": ", ".join(f"{number}={side}" for number, side in sides.items()),
            "landmarks": str(arguments.landmarks or ""),
        }
        super().__init__(NODE.parameters, options, ros, partial(_targets, boards), logger)

    @property
    def targets(self) -> Targets:
        """Markers and landmarks for which the tracker looks; another object after each change."""
        return self.meaning

    @property
    def assumed_side(self) -> float | None:
        """Side in metres that markers are assumed to have, because the user has given none; None if one is given."""
        return None if self._side_is_given or self.values["side"] != SIDE else SIDE


def _targets(boards: tuple[Board, ...], values: Mapping[str, Any]) -> Targets:
    """Return what the parameters describe. Raises `SetupError` if a file or a value is wrong."""
    markers = MarkerSet(values["dictionary"], values["side"], _sides(values["sides"]), boards)
    landmarks = read_landmarks(Path(values["landmarks"])) if values["landmarks"] else None
    for target in landmarks.places if landmarks else ():
        if not markers.is_target(target):
            known = (
                "a known board; define it in the file of --boards"
                if isinstance(target, str)
                else f"a known single marker; it is on a board, or {markers.dictionary} does not contain it"
            )
            raise SetupError(f"{values['landmarks']}: landmark {target!r} is not {known}")
    return Targets(markers, landmarks)


def _sides(text: str) -> dict[int, float]:
    """Parse the sides of single markers, such as ``7=0.1, 8=0.2``, in metres."""
    sides = {}
    for part in text.split(",") if text.strip() else ():
        try:
            number, side = marker_side(part.strip())
        except argparse.ArgumentTypeError as error:
            raise SetupError(f"the parameter 'sides': {error}") from error
        if number is None:
            raise SetupError(f"the parameter 'sides': {part.strip()!r} names no marker; write 7=0.1, or use 'side'")
        sides[number] = side
    return sides
