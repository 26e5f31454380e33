"""Pictures of rover/docs/calibration.md, made with a real browser: python -m rover.bench.vision.page_pictures."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import cv2
import numpy as np
from roverkit.calibration import Calibration, Collection, View, calibrate
from roverkit.calibration.calibrating import versions
from roverkit.calibration.page.live_calibration import LiveCalibration
from roverkit.calibration.page.server import PageServer
from roverkit.calibration.report import report

from bench.errors import BenchError
from rover.bench.vision.boards import BOARD
from rover.bench.vision.browser import Visitor, browser
from rover.bench.vision.moving_board import pictures
from roverlink.runtime.core.errors import SetupError

FOLDER = Path("rover/docs/calibration")
VIEWS, FIRST = 20, 6
"""Number of views, and the number after which the page is photographed."""
SCREEN, PHONE, PAPER = (1100, 760), (390, 1180), (800, 1300)
_START_NS, _FRAME_NS = 1_700_000_000_000_000_000, 100_000_000
_LEVEL = 16  # grey levels that are merged, so that noise does not make the files large


def main(words: list[str]) -> int:
    """Make all pictures. Returns 2 if there is no browser."""
    parser = argparse.ArgumentParser(prog="python -m rover.bench.vision.page_pictures", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=FOLDER, metavar="DIR", help="folder for the pictures (default: %(default)s)"
    )
    folder = parser.parse_args(words).out
    folder.mkdir(parents=True, exist_ok=True)
    live = LiveCalibration("http://192.168.0.7:8080/video", Collection(BOARD), _calibrate, _report, lambda _: "")
    try:
        with browser() as visitor, PageServer("127.0.0.1", 0, live) as server:
            visitor.screen(*SCREEN)
            visitor.open(server.url)
            _photograph(visitor, live, folder)
    except (BenchError, SetupError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    return 0


def _photograph(visitor: Visitor, live: LiveCalibration, folder: Path) -> None:
    """Photograph the page half way and with the result, and the report."""
    for number, grey in enumerate(pictures(VIEWS)):
        image = np.repeat(grey[:, :, None], 3, axis=2)
        for again in range(2):  # the second frame shows that the board is still
            stamp = _START_NS + (2 * number + again) * _FRAME_NS
            live.add_frame(image, stamp, f"frame {2 * number + again}")
        if number + 1 == FIRST:
            visitor.until(lambda: visitor.count("#views li") == FIRST)
            _write(folder / "page.png", visitor)
    visitor.click("#calibrate")
    visitor.until(lambda: visitor.shown("#result"))
    visitor.screen(*PHONE)
    _write(folder / "result.png", visitor)
    visitor.screen(*PAPER)
    visitor.run("location = 'report'")
    visitor.until(lambda: visitor.count("figure"))
    visitor.run("document.querySelectorAll('h2')[1].scrollIntoView()")
    _write(folder / "report.png", visitor)


def _write(path: Path, visitor: Visitor) -> None:
    visitor.until(lambda: visitor.run("return [...document.images].every((image) => image.complete)"))
    shown = np.asarray(cv2.imdecode(np.frombuffer(visitor.photograph(), np.uint8), cv2.IMREAD_COLOR))
    cv2.imwrite(str(path), shown // _LEVEL * _LEVEL + (_LEVEL - 1), [cv2.IMWRITE_PNG_COMPRESSION, 9])
    print(f"picture: {path}, {path.stat().st_size / 1000:.0f} kB")


def _calibrate(views: tuple[View, ...]) -> Calibration:
    return calibrate(views, BOARD)


def _report(calibration: Calibration) -> str:
    return report(calibration, BOARD, versions())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
