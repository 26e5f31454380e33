"""Implementation of ``roverlink aruco calibrate``: collects views, calibrates, writes parameters and report.

A view is the set of board corners found in one image.
"""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import contextlib
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

from roverkit.aruco.board_options import board_of
from roverkit.calibration import (
    BoardDetector,
    Calibration,
    CalibrationBoard,
    Collection,
    Model,
    PoorViewsError,
    Verdict,
    View,
)
from roverkit.calibration import calibrate as solve
from roverkit.calibration.calibration_page import serve_page
from roverkit.calibration.calibration_text import CalibrationText, JsonText, PlainText
from roverkit.calibration.page.live_calibration import LiveCalibration
from roverkit.calibration.report import report, write_report
from roverkit.calibration.seen_board import SeenBoards
from roverkit.calibration.writing import write_calibration
from roverkit.node.camera_source import open_source, settings_of, source_of
from roverkit.node.ros_connection import RosConnection
from roverkit.vision.frames import Frame, FrameSource, ImageFiles
from roverkit.vision.opencv import cv2
from roverlink.console import FINDINGS, OK
from roverlink.installed_packages import installed_version
from roverlink.numerals import counted
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_SUFFIXES = (".yml", ".yaml")
REJECTED = ".rejected"
"""Part of the name of a file with parameters that must not be used, before its ending."""


def calibrate(arguments: argparse.Namespace, ros: RosArguments) -> int:
    """Collect views, calibrate, write the files, and return the exit code.

    The exit code is 1 if the views are not sufficient, or if the result must not be used. Raises `SetupError` if the
    source of frames, the board or the folder for the files is not usable.
    """
    board = board_of(arguments)
    # Checked before the work, not after it.
    if arguments.out.suffix.lower() not in _SUFFIXES:
        raise SetupError(f"{arguments.out}: the name of the file of parameters must end with {' or '.join(_SUFFIXES)}")
    if not arguments.out.resolve().parent.is_dir():
        raise SetupError(f"{arguments.out}: the folder {arguments.out.parent} does not exist")
    text = JsonText() if arguments.json else PlainText()
    with contextlib.ExitStack() as stack:
        connection = RosConnection(ros, arguments.middleware, stack, text.note)
        source = stack.enter_context(
            open_source(source_of(arguments, text.note), settings_of(arguments), connection, say=text.note)
        )
        if arguments.page:
            try:
                result = _on_page(source, board, arguments, text.note)
            except KeyboardInterrupt:
                text.note("stopped; nothing was saved")
                return FINDINGS
            return _told(text, *result)
        if isinstance(source, ImageFiles):
            views: Sequence[View] = _images(source, board, SeenBoards(board, text.note))
            if skipped := len(source.unreadable):
                text.note(f"skipped {skipped} of {counted(len(source.paths), 'image')}, which cannot be read")
        else:
            views = _stream(source, board, arguments, text)
    try:
        calibration = solve(views, board, Model(arguments.model))
    except PoorViewsError as error:
        text.refused(error, views)
        return FINDINGS
    return _told(text, calibration, *_write(arguments.out, calibration, board))


def _told(text: CalibrationText, calibration: Calibration, path: Path, page: Path) -> int:
    """Show the calibration to the user, and return the exit code."""
    text.calibrated(calibration, path, page)
    return FINDINGS if calibration.judgement.verdict is Verdict.UNUSABLE else OK


def _images(source: ImageFiles, board: CalibrationBoard, seen: SeenBoards) -> list[View]:
    """Return the view (board corners) of each image. No image is left out, because the user has chosen the images."""
    detector = BoardDetector(board)
    views = []
    with progress(source.name) as report_progress:
        for frame, name in _named(source):
            views.append(detector.find(frame.image, name, frame.stamp))
            seen.look(frame.image, views[-1])
            report_progress(frame.number + 1, len(source.paths))
    return views


def _stream(
    source: FrameSource, board: CalibrationBoard, arguments: argparse.Namespace, text: CalibrationText
) -> Sequence[View]:
    """Collect useful views until they cover the whole image, the source of frames ends, or the user presses Ctrl-C."""
    collection = Collection(board, arguments.views)
    text.begins(collection)
    seen = SeenBoards(board, text.note)
    # Ctrl-C is the normal end of a live collection, so it must not skip the calibration.
    with progress(source.name) as report_progress, contextlib.suppress(KeyboardInterrupt):
        for frame, name in _named(source):
            offer = collection.offer(frame.image, frame.stamp, name)
            text.offered(offer, collection)
            seen.look(frame.image, offer.view)
            if source.total:
                report_progress(frame.number + 1, source.total)
            if collection.complete:
                break
    return collection.views


def _on_page(
    source: FrameSource, board: CalibrationBoard, arguments: argparse.Namespace, say: Callable[[str], None]
) -> tuple[Calibration, Path, Path]:
    """Let the user calibrate on the web page; return the calibration saved last, and the paths of its two files."""
    saved: list[tuple[Calibration, Path, Path]] = []

    def save(calibration: Calibration) -> str:
        path, page = _write(arguments.out, calibration, board)
        saved.append((calibration, path, page))
        return f"Saved to {path}, with a report in {page}."

    live = LiveCalibration(
        source.name,
        Collection(board, arguments.views),
        calibrate=lambda views: solve(views, board, Model(arguments.model)),
        report=lambda calibration: report(calibration, board, versions()),
        save=save,
    )

    def warn(text: str) -> None:
        say(text)
        live.warn(text)

    def feed(stop: threading.Event) -> None:
        seen = SeenBoards(board, warn)
        looking: Future[None] | None = None
        with ThreadPoolExecutor(1, "boards") as boards:  # its own thread: to look takes a second or two
            for frame, name in _named(source):
                if stop.is_set():
                    return
                offer = live.add_frame(frame.image, frame.stamp, name, chosen=isinstance(source, ImageFiles))
                if looking is None or looking.done():
                    if looking:
                        looking.result()  # raises its error, if it has one
                    looking = boards.submit(seen.look, frame.image, offer.view)
        live.ended()

    serve_page(live, feed, arguments.page_address, arguments.page_port, say, waits=source.live)
    return saved[-1]


def _named(source: FrameSource) -> Iterator[tuple[Frame, str]]:
    """Yield each frame with a name for its view.

    The stamps become nanoseconds since 1970: the modification time of an image, the time of a frame of a camera, or the
    modification time of a video plus the frame's time in it.
    """
    if isinstance(source, ImageFiles):
        for frame in source:
            path = source.paths[frame.number]
            yield replace(frame, stamp=path.stat().st_mtime_ns), path.name
    elif source.live:
        for frame in source:
            yield frame, f"frame {time.strftime('%H:%M:%S', time.localtime(frame.stamp / 1e9))}"
    else:
        began = Path(source.name).stat().st_mtime_ns
        for frame in source:
            yield replace(frame, stamp=began + frame.stamp), f"frame {frame.number}"


def _write(path: Path, calibration: Calibration, board: CalibrationBoard) -> tuple[Path, Path]:
    """Write the parameters to ``path`` and the report beside it; return the paths of both files.

    Parameters that must not be used get a name of their own, so that they never replace good ones. They are written
    nevertheless, because the views of a camera cannot be had again.
    """
    if calibration.judgement.verdict is Verdict.UNUSABLE:
        path = path.with_name(f"{path.stem}{REJECTED}{path.suffix}")
    page = path.with_suffix(".html")
    write_report(page, calibration, board, versions())
    write_calibration(path, calibration)
    return path, page


def versions() -> dict[str, str]:
    """Return the names and versions of the packages whose version can change the results of a calibration."""
    # Not the versions of pip's packages: on a Jetson, OpenCV and NumPy belong to the system.
    loaded = {"OpenCV": cv2.__version__, "NumPy": np.__version__}
    own = installed_version("roverlink")
    return {"roverlink": own, **loaded} if own else loaded
