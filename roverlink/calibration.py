"""What `roverlink aruco calibrate` does: views in, a file of parameters out, and text on the way."""

from __future__ import annotations

import argparse
import contextlib
import time
from collections.abc import Sequence
from pathlib import Path

from roverlink.board_options import board_of
from roverlink.calibration_text import CalibrationText, JsonText, PlainText
from roverlink.camera_source import open_source
from roverlink.console import FINDINGS, OK
from roverlink.progress import progress
from runtime.errors import SetupError
from vision.calibration import BoardDetector, CharucoBoard, Collection, Model, PoorViewsError, View
from vision.calibration import calibrate as solve
from vision.calibration.writing import write_calibration
from vision.sources import FrameSource, ImageFiles


def calibrate(arguments: argparse.Namespace) -> int:
    """Collect views, calibrate, write. Raises `SetupError` for what is missing."""
    board = board_of(arguments)
    if not arguments.out.resolve().parent.is_dir():  # said now, not when all the work is done
        raise SetupError(f"{arguments.out}: there is no folder {arguments.out.parent}")
    text = JsonText() if arguments.json else PlainText()
    with open_source(arguments, say=text.note) as source:
        views = _images(source, board) if isinstance(source, ImageFiles) else _stream(source, board, arguments, text)
    try:
        calibration = solve(views, board, Model(arguments.model))
    except PoorViewsError as error:
        text.refused(error, views)
        return FINDINGS
    write_calibration(arguments.out, calibration)
    text.calibrated(calibration, arguments.out)
    return OK


def _images(source: ImageFiles, board: CharucoBoard) -> list[View]:
    """A view of every image: somebody chose them."""
    detector = BoardDetector(board)
    views = []
    with progress(source.name) as report:
        for path, frame in zip(source.paths, source):
            views.append(detector.find(frame.image, path.name, path.stat().st_mtime_ns))
            report(len(views), len(source.paths))
    return views


def _stream(
    source: FrameSource, board: CharucoBoard, arguments: argparse.Namespace, text: CalibrationText
) -> Sequence[View]:
    """Views that add something, until nothing is missing, the source ends, or somebody stops it."""
    collection = Collection(board, arguments.views)
    began = 0 if source.live else _recorded(source.name)
    text.begins(collection)
    with progress(source.name) as report, contextlib.suppress(KeyboardInterrupt):
        for frame in source:
            name = time.strftime("%H:%M:%S", time.localtime(frame.stamp / 1e9)) if source.live else f"{frame.number}"
            text.offered(collection.offer(frame.image, began + frame.stamp, f"frame {name}"), collection)
            if source.total:
                report(frame.number + 1, source.total)
            if collection.complete:
                break
    return collection.views


def _recorded(name: str) -> int:
    """When a recording was made, in nanoseconds since 1970, as far as its file knows."""
    return Path(name).stat().st_mtime_ns
