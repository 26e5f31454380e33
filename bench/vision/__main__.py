"""The command line of the bench of the rover's eyes: python -m bench.vision."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from bench.errors import BenchError
from bench.report import draw, print_results, write_json
from bench.result import SectionResult
from roverlink.runtime.core.errors import SetupError

POSES, QUICK_POSES = 200, 30
EMPTY_FRAMES, QUICK_EMPTY_FRAMES = 500, 50
DRIVE_FRAMES, QUICK_DRIVE_FRAMES = 60, 20
CALIBRATIONS, QUICK_CALIBRATIONS = (5, 20), (1, 3)
"""Runs of large images, and of the small ones that the intervals are judged by."""
PLAIN_WIDTH = 130  # columns, where the output is not a terminal
SECTIONS = ("accuracy", "nothing", "speed", "calibration")


def _arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m bench.vision",
        description="Measure poses of markers and calibrations on rendered frames, beside plain OpenCV.",
        epilog="example: python -m bench.vision --quick --only speed --json vision.json",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write everything that was measured to FILE")
    parser.add_argument(
        "--out", type=Path, default=Path("build/bench"), metavar="DIR", help="folder of the picture (%(default)s)"
    )
    parser.add_argument("--quick", action="store_true", help="fewer frames: a first look")
    parser.add_argument("--poses", type=int, help=f"poses a size ({POSES}; quick {QUICK_POSES})")
    parser.add_argument(
        "--only", nargs="+", default=SECTIONS, choices=SECTIONS, metavar="NAME", help=", ".join(SECTIONS)
    )
    options = parser.parse_args(words)
    if options.poses is None:
        options.poses = QUICK_POSES if options.quick else POSES
    if options.poses < 1:
        parser.error(f"--poses {options.poses}: at least 1")
    if options.json and not options.json.resolve().parent.is_dir():
        parser.error(f"--json {options.json}: there is no such folder")
    return options


def _run(options: argparse.Namespace) -> None:
    try:  # only here, so that the help needs no OpenCV
        from bench.vision import accuracy, calibration, nothing, speed
    except ImportError as error:
        raise BenchError(f"{error}; `make bench-vision` installs what is needed") from error
    progress = Console(stderr=True, highlight=False, markup=False)
    options.out.mkdir(parents=True, exist_ok=True)
    results: dict[str, SectionResult] = {}
    if "speed" in options.only:
        results["speed"] = speed.measure(QUICK_DRIVE_FRAMES if options.quick else DRIVE_FRAMES, progress.print)
    if "accuracy" in options.only:
        results["accuracy"] = accuracy.measure(options.poses, accuracy.SIZES, progress.print)
    if "nothing" in options.only:
        results["nothing"] = nothing.measure(QUICK_EMPTY_FRAMES if options.quick else EMPTY_FRAMES, progress.print)
    if "calibration" in options.only:
        runs = QUICK_CALIBRATIONS if options.quick else CALIBRATIONS
        results["calibration"] = calibration.measure(*runs, progress.print)
    console = Console()
    print_results(results, [], console if console.is_terminal else Console(width=PLAIN_WIDTH))
    if options.json:
        write_json(options.json, results, [])
    progress.print(draw(options.out / "vision.png", results))


def main(words: Sequence[str]) -> int:
    """Run the bench; 2 where it cannot run."""
    try:
        _run(_arguments(words))
    except (BenchError, SetupError, OSError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
