"""Precision and recall of the lint's errors on histories made up at random, of which the truth is known.

Counted are errors about a number. A number is given away if it had two meanings, or two formats on the wire, at any
commit or in the uncommitted change; a repair is a hint, but has to be told. To look into a seed, write its
`RandomHistory`.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import pytest
from random_histories import RandomHistory

from roverlink.__main__ import main

# They judge a payload as a whole, and a number that is merely free; the truth is about the meanings of a number.
_OTHER_RULES = ("HIS103", "ENV107")
_RIGHT, _MISSED, _FALSE = "right", "missed", "false"

Verdict = tuple[str, int, str]  # a verdict, the seed, and what it is about


def _errors(command: list[str]) -> Iterator[tuple[str, int]]:
    """Type and number of each error that the lint reports, and of each number that it says is repaired."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        main([*command, "--format", "json"])
    for one in json.loads(said.getvalue()):
        assert one["id"] != "PRO101", f"the made-up state does not compile: {one['message']}"
        told = one["severity"] == "error" or "it has an earlier meaning back" in one["message"]
        if told and one["number"] is not None and one["id"] not in _OTHER_RULES:
            yield one["message_type"], one["number"]


def judge(seed: int) -> list[Verdict]:
    """Compare the lint's errors with the truth of one history."""
    with tempfile.TemporaryDirectory() as folder:
        history = RandomHistory(seed, Path(folder))
        history.write()
        errors = set(_errors(history.command))
    truth = history.truth
    names = {id: name for name, id in truth.ids.items()}
    found = {(truth.ids.get(name, -1), number) for name, number in errors}
    sorts = {_RIGHT: found & truth.reused, _MISSED: truth.reused - found}
    sorts[_FALSE] = found - truth.reused
    return [
        (sort, seed, f"{names.get(id, 'a type that never was')} {number}")
        for sort, keys in sorts.items()
        for id, number in sorted(keys)
    ]


def _assert_figures(verdicts: Iterable[list[Verdict]]) -> None:
    judged = [one for each in verdicts for one in each]
    right, missed, false = (sum(one[0] == sort for one in judged) for sort in (_RIGHT, _MISSED, _FALSE))
    print(f"{right} right, {missed} missed, {false} false:", *(one for one in judged if one[0] != _RIGHT), sep="\n  ")
    assert right / (right + false) >= 0.95
    assert right / (right + missed) >= 0.97


@pytest.mark.parametrize("seeds", [range(2), pytest.param(range(20), marks=pytest.mark.slow)], ids=["few", "some"])
def test_figures_on_few_histories(seeds: range) -> None:
    """Of the errors 95 % are right, and 97 % of the numbers given away have one."""
    _assert_figures(map(judge, seeds))


@pytest.mark.exhaustive
def test_figures_on_many_histories() -> None:
    """The figures hold on thousands of histories."""
    with ProcessPoolExecutor(min(2, os.cpu_count() or 1)) as workers:
        _assert_figures(workers.map(judge, range(1000, 3500), chunksize=50))
