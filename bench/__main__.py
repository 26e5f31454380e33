"""Command line of the benchmarks: python -m bench."""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.console import Console

from bench import bridging, conversion, generation, history, lines, linting, signing, starting, watching, whole_rover
from bench.contestants import FINDERS, ROOT
from bench.errors import BenchError
from bench.lab import Lab, prepare
from bench.report import draw, report
from bench.result import SectionResult

# To add a section, write a module with such a function and add a line here.
SECTIONS: dict[str, Callable[[Lab], SectionResult]] = {
    "bridging": bridging.measure,
    "starting": starting.measure,
    "rover": whole_rover.measure,
    "watching": watching.measure,
    "conversion": conversion.measure,
    "signing": signing.measure,
    "lines": lines.measure,
    "generation": generation.measure,
    "linting": linting.measure,
    "history": history.measure,
}

SECONDS, QUICK_SECONDS, SHORTEST_SECONDS = 1.0, 0.3, 0.1
PLAIN_WIDTH = 120  # columns, if the output is not a terminal
EXAMPLE = "example: python -m bench --quick --only cpp roverlink --json result.json"


def _arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m bench",
        description="Measure the bridge and compare it with other ways to build one.",
        epilog=EXAMPLE,
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all measurements to FILE")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("build/bench"),
        metavar="DIR",
        help="folder for the chart, the built programs and the logs (default: %(default)s)",
    )
    parser.add_argument(
        "--proto", type=Path, default=ROOT / "proto", metavar="DIR", help="the .proto tree (default: %(default)s)"
    )
    parser.add_argument(
        "--seconds",
        type=float,
        help=f"length of a measurement in seconds (default: {SECONDS:g}, or {QUICK_SECONDS:g} with --quick)",
    )
    parser.add_argument("--quick", action="store_true", help="use fewer rates and settings, and short measurements")
    parser.add_argument(
        "--only",
        nargs="+",
        default=[],
        metavar="NAME",
        choices=[*SECTIONS, *FINDERS],
        help="measure only these sections and contestants: " + ", ".join([*SECTIONS, *FINDERS]),
    )
    options = parser.parse_args(words)
    if options.seconds is None:
        options.seconds = QUICK_SECONDS if options.quick else SECONDS
    if options.seconds < SHORTEST_SECONDS:
        parser.error(f"--seconds {options.seconds:g} is too short; use at least {SHORTEST_SECONDS:g}")
    if options.json and not options.json.resolve().parent.is_dir():
        parser.error(f"--json {options.json}: the folder does not exist")
    return options


def _run(options: argparse.Namespace) -> None:
    progress = Console(stderr=True, highlight=False, markup=False, soft_wrap=True)
    lab = prepare(
        proto=options.proto,
        out=options.out.resolve(),
        seconds=options.seconds,
        quick=options.quick,
        only=[name for name in FINDERS if name in options.only],
        say=progress.print,
    )
    for note in lab.notes:
        progress.print(f"note: {note}")
    sections = [name for name in SECTIONS if name in options.only] or list(SECTIONS)
    results = {name: SECTIONS[name](lab) for name in sections}
    report(results, options.json, lab.notes, PLAIN_WIDTH)
    progress.print(draw(lab.site.out / "bench.png", results))


def main(words: Sequence[str]) -> int:
    """Run the benchmarks. Returns 2 if they cannot run."""
    try:
        _run(_arguments(words))
    except (BenchError, OSError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
