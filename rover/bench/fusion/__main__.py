"""Judge ``roverlink fuse`` on recorded drives, and on simulated ones beside robot_localization's equations."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from bench.report import report
from bench.result import Group, SectionResult, Table
from rover.bench.fusion.drives import Drive, Noise, calibrated, mrclam, smartloc
from rover.bench.fusion.filters import Estimate, filtered
from rover.bench.fusion.program import fused


def _score(drive: Drive, found: Mapping[float, Estimate], times: Sequence[float]) -> tuple[float, float]:
    """Return the RMSE of the position in metres, and the mean NEES: 3 if the covariance is honest, 2 without a yaw."""
    squared, normalized = [], []
    freedom = 3 if drive.landmarks else 2
    for time in times:
        pose, covariance = found[time]
        missed = pose - drive.true_pose(time)
        missed[2] = math.remainder(missed[2], 2 * math.pi)
        squared.append(missed[:2] @ missed[:2])
        missed = missed[:freedom]
        normalized.append(missed @ np.linalg.solve(covariance[:freedom, :freedom], missed))
    return math.sqrt(np.mean(squared)), float(np.mean(normalized))


def _judge(drive: Drive, noise: Noise) -> tuple[Sequence[str], str]:
    """Return the row of a drive, and what was said about it."""
    drive = drive.timed(noise.delay, noise.lead).with_fix_variance(noise.fix_variance)
    (ours, said), theirs = fused(drive, noise), filtered(drive, noise)
    times = sorted(ours.keys() & theirs.keys())
    scores = [
        f"{one:.{digits}f}" for found in (ours, theirs) for one, digits in zip(_score(drive, found, times), (3, 1))
    ]
    return (drive.name, f"{len(times) / len(drive.times):.0%}", *scores), f"{drive.name}: {noise}; {said}"


def judged(drives: Sequence[Drive], longest: float, progress: Console) -> list[Sequence[str]]:
    """Judge drives up to a time in seconds.

    The errors of the sensors of a robot are those of its other drives; without one, those of the other robots.
    """
    noises = []
    for drive in drives:
        others = [one for one in drives if one is not drive]
        noises.append(calibrated([one for one in others if one.robot == drive.robot] or others or [drive]))
    with ProcessPoolExecutor() as pool:
        rows, told = zip(*pool.map(_judge, [replace(drive, longest=longest) for drive in drives], noises))
    for one in told:
        progress.print(one)
    return list(rows)


def main(words: Sequence[str]) -> int:
    """Measure, print the tables, and return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m rover.bench.fusion",
        description="Judge roverlink fuse on recorded drives, beside a gated extended Kalman filter.",
        epilog="example: python -m rover.bench.fusion --mrclam MRCLAM_Dataset6 MRCLAM_Dataset7 --simulated 5",
    )
    parser.add_argument("--mrclam", nargs="+", type=Path, default=[], metavar="FOLDER", help="folders of MRCLAM")
    parser.add_argument("--smartloc", nargs="+", type=Path, default=[], metavar="FILE", help="inputs of smartLoc")
    parser.add_argument("--simulated", type=int, default=0, metavar="COUNT", help="number of simulated drives")
    parser.add_argument("--far", type=int, default=0, metavar="COUNT", help="number of simulated drives of 100 m")
    parser.add_argument(
        "--seconds", type=float, default=math.inf, help="longest time of a recorded drive (default: all)"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the tables to FILE")
    options = parser.parse_args(words)
    progress = Console(stderr=True, highlight=False, markup=False)
    recorded = [drive for folder in options.mrclam for drive in mrclam(folder)]
    cities = [drive for path in options.smartloc for drive in smartloc(path)]
    groups = [
        Group(name, judged(one, options.seconds, progress))
        for name, one in (("MRCLAM", recorded), ("smartLoc", cities))
        if one
    ]
    columns = ("drive", "time with\na pose", "fuse\nRMSE, m", "NEES", "filter\nRMSE, m", "NEES")
    tables = [Table("Recorded drives", columns, groups)]
    if options.simulated:
        from rover.bench.fusion.simulated import compared  # only here: it imports the simulated tracker of the tests

        rows = [
            compared(range(options.simulated), landmarks=landmarks, gps=gps)
            for landmarks, gps in ((True, False), (True, True), (False, True), (False, False))
        ]
        columns = (
            "sensors beside\nthe wheels",
            "fuse is\nnearer",
            *columns[2:4],
            "robot_localization\nRMSE, m",
            "NEES",
        )
        tables.append(Table("Simulated drives", columns, [Group("4 landmarks, 5 % slip", rows)]))
    if options.far:
        from rover.bench.fusion.simulated import far  # as above

        rows = far(range(options.far))
        tables.append(Table("Drives of 100 m", ("figure", "measured"), [Group("4 landmarks, no GPS, 5 % slip", rows)]))
    data = {group.heading: group.rows for table in tables for group in table.groups}
    results = {"fusion": SectionResult(tables, data=data)}
    report(results, options.json)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
