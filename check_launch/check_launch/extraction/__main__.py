"""``python -m check_launch.extraction``: write the catalogue of a distribution from checkouts of sources."""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from check_launch.catalogue.catalogue_files import DISTRIBUTIONS, file_of, text_of
from check_launch.catalogue.facts import Source
from check_launch.extraction.assembling import Assembler, Checkout, packages_in
from check_launch.extraction.launch_files import launch_files_of
from check_launch.extraction.supplement import read_supplement
from roverlink.runtime.atomic_files import write_whole


def main() -> int:
    """Read the checkouts, write the catalogue, and print what could not be extracted. Return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--distribution", required=True, choices=DISTRIBUTIONS)
    parser.add_argument("sources", nargs="+", type=Path, help="git checkouts, each at the version for the distribution")
    parser.add_argument("--output", type=Path, help="file to write (default: the catalogue in this package)")
    arguments = parser.parse_args()
    supplement = read_supplement()
    assembler = Assembler((_checkout(folder) for folder in arguments.sources), supplement)
    launch_files = {
        package: dict(launch_files_of(folder))
        for package, folder in assembler.folders()
        if package in supplement.launch_files
    }
    catalogue = assembler.catalogue(arguments.distribution, launch_files)
    write_whole(arguments.output or file_of(arguments.distribution), text_of(catalogue).encode())
    for name in sorted(assembler.unexplained):
        print(f"not explained: {name}", file=sys.stderr)
    print(f"{len(catalogue.packages)} packages, {len(catalogue.classes)} classes, {len(catalogue.plugins)} plugins")
    return 0


def _checkout(folder: Path) -> Checkout:
    log = ["git", "-C", str(folder), "log", "-1", "--format=%H %cs"]
    # Whoever maintains the catalogue has chosen the folder; git comes from the PATH, as for other commands.
    done = subprocess.run(log, check=True, capture_output=True, text=True)  # noqa: S603
    commit, date = done.stdout.split()
    return Checkout(folder.name, folder, Source(folder.name, commit, date), packages_in(folder))


if __name__ == "__main__":
    sys.exit(main())
