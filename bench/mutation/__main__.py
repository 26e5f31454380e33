"""Command line: python -m bench.mutation."""

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path
from queue import Queue

from bench.contestants import ROOT
from bench.errors import BenchError
from bench.mutation.judging import Coverage, Verdict, Workplace, record
from bench.mutation.mutants import Mutant, sample

FOLDERS = {
    "generator": 107,
    "roverlink": 34,
    "runtime": 52,
    "rover/roverkit": 97,
    "check_launch/check_launch": 30,
}
"""Mutants of each folder, in proportion to its lines of code."""
BASELINE = Path(__file__).parent / "baseline.jsonl"
"""The verdicts of an earlier suite on the sample of seed 36: what later ones have to notice as well."""
EXAMPLE = "example: python -m bench.mutation --out build/mutation/after.jsonl --workers 3"


def _arguments(words: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m bench.mutation",
        description="Give a seeded sample of places in the code one small fault each, and count those that the tests "
        "notice. The default and slow tests that cover the line judge.",
        epilog=EXAMPLE,
    )
    parser.add_argument(
        "--seed", type=int, help="draw a new sample with this seed (default: judge that of the baseline)"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("build/mutation/verdicts.jsonl"),
        metavar="FILE",
        help="a line of JSON for each verdict (default: %(default)s)",
    )
    parser.add_argument(
        "--recorded", type=Path, metavar="DIR", help="folder with coverage and junit.xml of an earlier run of the tests"
    )
    parser.add_argument(
        "--budget", type=float, default=20.0, help="seconds of tests for a mutant (default: 20, as in the baseline)"
    )
    parser.add_argument("--workers", type=int, default=2, help="mutants at once (default: %(default)s)")
    return parser.parse_args(words)


def main(words: Sequence[str]) -> int:
    """Judge the sample; the exit code is 1 if a folder kills fewer mutants than in the baseline."""
    options = _arguments(words)
    lines = BASELINE.read_text(encoding="utf-8").splitlines() if options.seed is None else []
    earlier = [_verdict(json.loads(line)) for line in lines]
    for verdict in [verdict for verdict in earlier if not verdict.mutant.is_sound(ROOT)]:
        print(f"left out, for the code has changed: {verdict.mutant.path}:{verdict.mutant.line}")
        earlier.remove(verdict)
    mutants = [verdict.mutant for verdict in earlier] or sample(ROOT, FOLDERS, options.seed)
    folder = options.recorded or ROOT / "build" / "mutation"
    if not options.recorded:
        record(ROOT, folder, FOLDERS)
    coverage = Coverage(ROOT, folder / "coverage", folder / "junit.xml")
    killers = {verdict.mutant: verdict.killer for verdict in earlier}
    places: Queue[Workplace] = Queue()
    for number in range(options.workers):
        places.put(Workplace(ROOT, ROOT / "build" / "mutation" / f"copy{number}"))

    def judge(mutant: Mutant) -> Verdict:
        place = places.get()
        try:
            return _judge(mutant, coverage, place, options.budget, killers.get(mutant, ""))
        finally:
            places.put(place)

    verdicts: dict[Mutant, Verdict] = {}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(options.workers) as pool:
        while left := [mutant for mutant in mutants if mutant not in verdicts]:
            for verdict in _with_progress(pool.map(judge, left), len(left)):
                verdicts[verdict.mutant] = verdict
                text = "".join(json.dumps(asdict(each)) + "\n" for each in verdicts.values())
                options.out.write_text(text, encoding="utf-8")
            # A killer that fails without a fault, too, says nothing: its mutants are judged once more without it.
            killed_by = sorted({verdict.killer for verdict in verdicts.values() if "::" in verdict.killer})
            place = places.get()
            unsound = set(place.unsound(killed_by, coverage.seconds(killed_by)))
            places.put(place)
            coverage.forget(unsound)
            verdicts = {mutant: verdict for mutant, verdict in verdicts.items() if verdict.killer not in unsound}
    return _report(verdicts.values(), earlier)


def _with_progress(verdicts: Iterable[Verdict], total: int) -> Iterator[Verdict]:
    began = time.monotonic()
    for number, verdict in enumerate(verdicts, 1):
        mutant = verdict.mutant
        said = verdict.killer or ("survived" if verdict.tests else "no test covers it")
        where = f"{number:3}/{total} {time.monotonic() - began:5.0f} s  {mutant.path}:{mutant.line}"
        print(f"{where} {mutant.before} -> {mutant.after}: {said}", flush=True)
        yield verdict


def _judge(mutant: Mutant, coverage: Coverage, place: Workplace, budget_s: float, killer: str) -> Verdict:
    tests = coverage.judges(mutant, budget_s, killer)
    if killer in tests and place.judge(mutant, [killer], coverage.seconds([killer])):
        return Verdict(mutant, 1, killer)
    others = [test for test in tests if test != killer]
    killed_by = place.judge(mutant, others, coverage.seconds(others)) if others else ""
    return Verdict(mutant, len(tests), killed_by)


def _verdict(entry: dict[str, object]) -> Verdict:
    return Verdict(**{**entry, "mutant": Mutant(**entry["mutant"])})  # type: ignore[arg-type]


def _report(verdicts: Iterable[Verdict], earlier: Sequence[Verdict]) -> int:
    before, worse = _killed(earlier), False
    for folder, (killed, total) in _killed(verdicts).items():
        was = before.get(folder)
        worse |= was is not None and killed < was[0]
        print(f"{folder:25} {killed:3} of {total:3} killed" + (f" (before: {was[0]})" if was else ""))
    return int(worse)


def _killed(verdicts: Iterable[Verdict]) -> dict[str, tuple[int, int]]:
    total, killed = Counter[str](), Counter[str]()
    for verdict in verdicts:
        folder = next(folder for folder in FOLDERS if verdict.mutant.path.startswith(f"{folder}/"))
        total[folder] += 1
        killed[folder] += verdict.killer != ""
    return {folder: (killed[folder], total[folder]) for folder in total}


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BenchError as error:
        print(f"bench.mutation: {error}", file=sys.stderr)
        sys.exit(2)
