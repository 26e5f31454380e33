"""Command line of the camera benchmarks: python -m rover.bench.vision."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from bench.errors import BenchError
from bench.report import draw, report
from bench.result import SectionResult
from roverlink.runtime.core.errors import SetupError

POSES, QUICK_POSES = 200, 30
DEGRADED_POSES, QUICK_DEGRADED_POSES = 60, 10
EMPTY_FRAMES, QUICK_EMPTY_FRAMES = 500, 50
DRIVE_FRAMES, QUICK_DRIVE_FRAMES = 60, 20
DIFFICULT_SCENES, QUICK_DIFFICULT_SCENES = 40, 10
CALIBRATIONS, QUICK_CALIBRATIONS = 5, 1
LENSES, QUICK_LENSES = 20, 3
"""Runs for each lens."""
ROCKS, QUICK_ROCKS = 240, 30
"""Rocks of each kind."""
SEQUENCES, QUICK_SEQUENCES = 10, 2
PLAIN_WIDTH = 130  # columns, if the output is not a terminal
RECEIVING_S, QUICK_RECEIVING_S = 10.0, 3.0
SECTIONS = (
    *("accuracy", "consistency", "nothing", "finding", "speed", "calibration", "lenses"),
    *("photographs", "receiving", "rocks", "objects"),
)


def _arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m rover.bench.vision",
        description="Measure marker poses, calibrations, rocks and objects on rendered frames, and markers on "
        "photographs, beside plain OpenCV, and the receiving of images, beside rclpy.",
        epilog="example: python -m rover.bench.vision --quick --only speed --json vision.json",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all measurements to FILE")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("build/bench"),
        metavar="DIR",
        help="folder for the charts (default: %(default)s)",
    )
    parser.add_argument("--quick", action="store_true", help="use fewer frames")
    parser.add_argument(
        "--poses", type=int, help=f"poses per marker size (default: {POSES}, or {QUICK_POSES} with --quick)"
    )
    parser.add_argument(
        "--only",
        nargs="+",
        default=SECTIONS,
        choices=SECTIONS,
        metavar="NAME",
        help="measure only these sections: " + ", ".join(SECTIONS),
    )
    options = parser.parse_args(words)
    if options.poses is None:
        options.poses = QUICK_POSES if options.quick else POSES
    if options.poses < 1:
        parser.error(f"--poses {options.poses} is too small; use at least 1")
    if options.json and not options.json.resolve().parent.is_dir():
        parser.error(f"--json {options.json}: the folder does not exist")
    return options


def _run(options: argparse.Namespace) -> None:
    try:  # imported here, so that --help needs no OpenCV
        from rover.bench.vision import (
            accuracy,
            calibration,
            consistency,
            finding,
            lenses,
            nothing,
            objects,
            photographs,
            receiving,
            rocks,
            speed,
        )
    except ImportError as error:
        raise BenchError(f"{error}; `make bench-vision` installs the missing packages") from error
    progress = Console(stderr=True, highlight=False, markup=False)
    options.out.mkdir(parents=True, exist_ok=True)
    results: dict[str, SectionResult] = {}
    if "speed" in options.only:
        results["speed"] = speed.measure(QUICK_DRIVE_FRAMES if options.quick else DRIVE_FRAMES, progress.print)
    if "accuracy" in options.only:
        results["accuracy"] = accuracy.measure(options.poses, accuracy.SIZES, progress.print)
    if "consistency" in options.only:
        poses = QUICK_DEGRADED_POSES if options.quick else DEGRADED_POSES
        results["consistency"] = consistency.measure(poses, consistency.SIZES, progress.print)
    if "nothing" in options.only:
        results["nothing"] = nothing.measure(QUICK_EMPTY_FRAMES if options.quick else EMPTY_FRAMES, progress.print)
    if "finding" in options.only:
        counts = (QUICK_DIFFICULT_SCENES, QUICK_DRIVE_FRAMES) if options.quick else (DIFFICULT_SCENES, DRIVE_FRAMES)
        results["finding"] = finding.measure(*counts, progress.print)
    if "calibration" in options.only:
        runs = QUICK_CALIBRATIONS if options.quick else CALIBRATIONS
        results["calibration"] = calibration.measure(runs, progress.print)
    if "lenses" in options.only:
        results["lenses"] = lenses.measure(QUICK_LENSES if options.quick else LENSES, progress.print)
    if "photographs" in options.only:
        results["photographs"] = photographs.measure(progress.print)
    if "receiving" in options.only:
        seconds = QUICK_RECEIVING_S if options.quick else RECEIVING_S
        results["receiving"] = receiving.measure(seconds, options.out, progress.print)
    if "rocks" in options.only:
        results["rocks"] = rocks.measure(QUICK_ROCKS if options.quick else ROCKS, progress.print)
    if "objects" in options.only:
        results["objects"] = objects.measure(QUICK_SEQUENCES if options.quick else SEQUENCES, progress.print)
    report(results, options.json, width=PLAIN_WIDTH)
    progress.print(draw(options.out / "vision.png", results))


def main(words: Sequence[str]) -> int:
    """Run the benchmarks. Returns 2 if they cannot run."""
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
