"""Find mistakes in launch files and their parameter files before they meet a rover.

Check ROS 2 launch files (YAML, XML, Python) and parameter files: unknown and misplaced parameters, wrong
types and ranges, unknown plugins and executables, remappings without effect, topics that nobody publishes
or with another QoS, and transforms with two parents or none. ROS 2 need not be installed: the facts about
packages come from a catalogue, which --list shows. Packages that are not in it are named and skipped.

A launch file is checked with the defaults of its arguments, and once more for each argument on which it
depends what is started. PATH may be followed by NAME:=VALUE, as for `ros2 launch`.

A Python launch file is a program, and runs, with your rights, in a process that --time-limit ends. Check files of
strangers only where their code may run. Python files without generate_launch_description do not run.

`roverlink explain PAR101` describes a rule. What a node refuses is an error, what it silently ignores is a
warning. Exit code 0: there is no finding, or only hints; 1: there are errors or warnings; 2: a file cannot
be read.

Example: roverlink check-launch --complete rover/navigation/launch/slam.launch.py
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path

from check_launch.catalogue.catalogue_files import DISTRIBUTIONS, NO_CATALOGUE, read_catalogue
from check_launch.distributions import checked_for, distributions_of
from check_launch.expansion.child_process import DEFAULT_LIMITS, Limits
from check_launch.expansion.launch_context import Packages
from check_launch.extraction.workspace import with_workspace
from check_launch.graph.system_drawing import dot_of, svg_of
from check_launch.own_programs import with_own_programs
from check_launch.rules.checking import Checked, Checker, files_to_check
from check_launch.rules.launch_rules import launch_rules
from roverlink.console import FINDINGS, OK, TABLE, UNABLE, Subparsers, documented_command, print_note, seconds
from roverlink.diagnostic_text import Sources
from roverlink.generator.diagnostics import Severity
from roverlink.generator.source_files import repository_top
from roverlink.reports import FORMATS
from roverlink.reports.reported import Reported
from roverlink.runtime.atomic_files import write_whole
from roverlink.runtime.core.errors import SetupError

_SET = ":="


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="check-launch")
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="PATH|NAME:=VALUE",
        help="launch file, parameter file, or a folder with such files; NAME:=VALUE sets an argument of launch files",
    )
    parser.add_argument(
        "--distribution",
        choices=DISTRIBUTIONS,
        help="ROS 2 distribution of the workspace (default: ROS_DISTRO, or the one that its texts name; without one, "
        "what only some distributions refuse is a warning)",
    )
    parser.add_argument(
        "--complete",
        action="store_true",
        help="the launch file starts everything: topics and frames that come from nowhere are errors, not only hints",
    )
    parser.add_argument(
        "--packages",
        nargs="+",
        type=Path,
        default=[],
        metavar="DIR",
        help="folders with the sources of more packages, whose launch files are included (default: the repository of "
        "PATH, and an installed ROS 2)",
    )
    parser.add_argument(
        "--catalogue",
        type=Path,
        metavar="FILE",
        help="keep what was read from the sources of the workspace in this file (default: in the user's cache)",
    )
    parser.add_argument(
        "--time-limit",
        type=seconds,
        default=DEFAULT_LIMITS.seconds,
        metavar="SECONDS",
        help="most processor time for a launch file with one value of its arguments (default: %(default)g)",
    )
    parser.add_argument(
        "--graph",
        type=Path,
        metavar="FILE",
        help="draw nodes, topics and frames into this SVG file with Graphviz, or write FILE.dot for it",
    )
    parser.add_argument(
        "--format", choices=FORMATS, default="text", help="format of the findings (default: %(default)s)"
    )
    parser.add_argument("--list", action="store_true", help="list the packages in the catalogue, with their versions")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Check the files, print the findings, and return the exit code."""
    paths = [Path(text) for text in arguments.paths if _SET not in text]
    if arguments.list:
        catalogue = read_catalogue(arguments.distribution or DISTRIBUTIONS[0])
        for name, package in catalogue.packages.items():
            source = catalogue.sources[package.source]
            print(
                f"{name} {package.version}".ljust(44), f"{source.repository} {source.commit[:10]} {source.date}".strip()
            )
        return OK
    if not paths:
        raise SetupError("name a launch file, a parameter file, or a folder with such files")
    missing: list[Path] = []
    files = list(files_to_check(paths, missing.append))
    if missing:
        if not missing[0].exists():
            raise SetupError(f"{missing[0]} does not exist")
        raise SetupError(f"{missing[0]}: there is no launch file, and no file with parameters of ROS 2 nodes")
    tops = [*_tops(files), *filter(Path.is_dir, paths)]
    packages = Packages([*arguments.packages, *tops])
    values = dict(text.split(_SET, 1) for text in arguments.paths if _SET in text)
    if "" in values:
        raise SetupError(f"write the name of an argument before '{_SET}'")
    limits = Limits(seconds=arguments.time_limit)

    def check(distribution: str) -> Checked:
        known = read_catalogue(distribution) if distribution else NO_CATALOGUE
        catalogue = with_workspace(known, packages, arguments.catalogue)
        catalogue = with_own_programs(catalogue, _table_file(paths))
        return Checker(catalogue, packages, arguments.complete, limits).check(files, values)

    distributions = (arguments.distribution,) if arguments.distribution else distributions_of(tops, packages)
    checked = checked_for(distributions, check)
    if arguments.graph:
        _draw(checked, arguments.graph)
    found = Reported(
        "roverlink check-launch", checked.findings, Sources(Path(".")), launch_rules(), extent=checked.extent
    )
    FORMATS[arguments.format](found)
    severities = {finding.severity for finding in checked.findings}
    if Severity.FATAL in severities:
        return UNABLE
    return FINDINGS if severities & {Severity.ERROR, Severity.WARNING} else OK


def _table_file(paths: Iterable[Path]) -> Path | None:
    """Return the nearest mapping.yaml above the first path; None if there is none."""
    for path in paths:
        found = (folder / TABLE for folder in (path.resolve(), *path.resolve().parents))
        return next((candidate for candidate in found if candidate.is_file()), None)
    return next((candidate for candidate in (Path(TABLE),) if candidate.is_file()), None)


def _tops(files: Iterable[Path]) -> Iterator[Path]:
    """Yield the top of the repository of each file; without a repository, the folder of its package or its own."""
    for folder in dict.fromkeys(file.resolve().parent for file in files):
        above = next((parent for parent in (folder, *folder.parents) if (parent / "package.xml").is_file()), folder)
        yield Path(repository_top(str(folder)) or above)


def _draw(checked: Checked, path: Path) -> None:
    if not checked.systems:
        raise SetupError("--graph draws what a launch file starts; name a launch file")
    if len(checked.systems) > 1:
        print_note(f"{path}: shows {checked.systems[0][0]}, the first of {len(checked.systems)} launch files")
    name, system = checked.systems[0]
    draw = dot_of if path.suffix in (".dot", ".gv") else svg_of
    write_whole(path, draw(system, name).encode())
