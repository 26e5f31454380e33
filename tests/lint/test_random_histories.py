"""Precision and recall of the lint's errors on histories made up at random, of which the truth is known.

Counted are errors about a number. A number is given away if it had two meanings, or two formats on the wire, at any
commit or in the uncommitted change. Numbers in doubt count as neither. `random_histories` makes the histories; its
docstring says how to look into the one of a seed.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from random_histories import Key, RandomHistory

from roverlink.__main__ import main

_PRECISION, _RECALL = 0.95, 0.97
# They judge a payload as a whole, and a number that is merely free; the truth is about the meanings of a number.
_OTHER_RULES = ("HIS103", "ENV107")
_MISSED, _FALSE, _RIGHT = "missed", "false", "right"


@dataclass
class Score:
    """Verdicts on numbers, counted in all and by cause; and the first seed of each kind of mistake."""

    verdicts: Counter[str] = field(default_factory=Counter)
    by_cause: defaultdict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))
    seeds: dict[tuple[str, str], int] = field(default_factory=dict)

    def add(self, verdict: str, causes: Iterable[str], seed: int) -> None:
        """Count a verdict."""
        self.verdicts[verdict] += 1
        for cause in causes:
            self.by_cause[cause][verdict] += 1
            self.seeds.setdefault((cause, verdict), seed)

    def merge(self, other: Score) -> None:
        """Add the verdicts on later seeds."""
        self.verdicts += other.verdicts
        for cause, verdicts in other.by_cause.items():
            self.by_cause[cause] += verdicts
        self.seeds = {**other.seeds, **self.seeds}

    @property
    def precision(self) -> float:
        """Share of the errors that are right."""
        return self.verdicts[_RIGHT] / max(1, self.verdicts[_RIGHT] + self.verdicts[_FALSE])

    @property
    def recall(self) -> float:
        """Share of the numbers given away that have an error."""
        return self.verdicts[_RIGHT] / max(1, self.verdicts[_RIGHT] + self.verdicts[_MISSED])

    def table(self) -> str:
        """Return the figures, and the verdicts by cause with the seeds; a verdict has several causes."""
        rows = [
            f"{found[_RIGHT]:6} {found[_MISSED]:7} {self._seed(cause, _MISSED):>6} {found[_FALSE]:6} "
            f"{self._seed(cause, _FALSE):>6}  {cause}"
            for cause, found in sorted(self.by_cause.items())
        ]
        return "\n".join(
            [
                f"precision {self.precision:.1%}, recall {self.recall:.1%}: {dict(self.verdicts)}",
                " right  missed   seed  false   seed  cause",
                *rows,
            ]
        )

    def _seed(self, cause: str, verdict: str) -> str:
        return str(self.seeds.get((cause, verdict), ""))


def _errors(command: list[str]) -> Iterator[tuple[str, int]]:
    """Type and number of each error that the lint reports."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        main([*command, "--format", "json"])
    for one in json.loads(said.getvalue()):
        if one["id"] == "PRO101":
            raise ValueError(f"the made-up state does not compile: {one['message']}")
        if one["severity"] == "error" and one["number"] is not None and one["id"] not in _OTHER_RULES:
            yield one["message_type"], one["number"]


def judge(seed: int) -> Score:
    """Compare the lint's errors with the truth of one history."""
    with tempfile.TemporaryDirectory() as folder:
        history = RandomHistory(seed, Path(folder))
        history.write()
        errors = set(_errors(history.command))
    score, truth = Score(), history.truth
    for name in sorted(name for name, _ in errors if name not in truth.ids):
        score.add(_FALSE, [f"type: there never was a {name}"], seed)
    found: set[Key] = {(truth.ids[name], number) for name, number in errors if name in truth.ids}
    for verdict, keys in (
        (_RIGHT, found & truth.reused),
        (_MISSED, truth.reused - found),
        (_FALSE, found - truth.reused - truth.doubtful),
    ):
        for key in sorted(keys):
            score.add(verdict, truth.causes(key), seed)
    return score


def _assert_figures(scores: Iterable[Score]) -> None:
    total = Score()
    for score in scores:
        total.merge(score)
    print(total.table())
    assert total.precision >= _PRECISION
    assert total.recall >= _RECALL


def test_every_seed_is_one_history(tmp_path: Path) -> None:
    """A seed gives the same commits and the same truth each time."""
    one, same, other = (RandomHistory(seed, tmp_path / str(index)) for index, seed in enumerate((7, 7, 8)))
    assert one.truth == same.truth
    assert one.truth != other.truth


@pytest.mark.slow
def test_figures_on_few_histories() -> None:
    """Of the errors 95 % are right, and 97 % of the numbers given away have one; `--runxfail` shows the table."""
    _assert_figures(map(judge, range(20)))


@pytest.mark.slow
def test_figures_on_many_histories() -> None:
    """The figures hold on thousands of histories."""
    with ProcessPoolExecutor(min(2, os.cpu_count() or 1)) as workers:
        _assert_figures(workers.map(judge, range(1000, 3500), chunksize=50))
