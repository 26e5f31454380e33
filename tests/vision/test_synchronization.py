"""Synchronization by stamps, against an oracle that searches the whole history."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roverlink.vision.frames.synchronization import RESTART_NS, Synchronizer

Arrival = tuple[int, int]
"""A message that arrives: the index of its topic, and its stamp."""
Sets = list[tuple[int, ...]]

_END = 10_000


def _run(arrivals: Sequence[Arrival], topics: int, slop: int, queue: int = 1000) -> Sets:
    """The sets of a synchronizer whose messages are their own stamps."""
    synchronizer = Synchronizer[int](topics, slop, queue)
    return [one for topic, stamp in arrivals for one in synchronizer.add(topic, stamp, stamp)]


def _flushed(arrivals: Sequence[Arrival], topics: int) -> list[Arrival]:
    """The messages, and a last one of each topic, after which nothing waits."""
    return [*arrivals, *((topic, _END) for topic in range(topics))]


class _Oracle:
    """The rules, word by word: every decision searches all messages that have ever come."""

    def __init__(self, topics: int, slop: int) -> None:
        self._history: list[set[int]] = [set() for _ in range(topics)]
        self._slop, self._decided = slop, -1
        self.sets: Sets = []

    def add(self, topic: int, stamp: int) -> None:
        if topic or stamp > self._decided:
            self._history[topic].add(stamp)
        while (leading := [one for one in sorted(self._history[0]) if one > self._decided]) and self._decide(
            leading[0]
        ):
            self._decided = leading[0]

    def _decide(self, stamp: int) -> bool:
        """Whether the set of a leading message is decided; one that is complete is kept."""
        first, *others = self._history
        if not all(other and max(other) >= stamp for other in others):
            return False
        near = [_nearest(other, stamp) for other in others]
        if any(abs(one - stamp) > self._slop for one in near):
            return True
        if any(max(first) < one for one in near):
            return False
        unused = not self.sets or all(one > used for one, used in zip(near, self.sets[-1][1:]))
        if unused and all(_nearest(first, one) == stamp for one in near):
            self.sets.append((stamp, *near))
        return True


def _nearest(stamps: set[int], stamp: int) -> int:
    return min(stamps, key=lambda one: (abs(one - stamp), one))


def _expected(arrivals: Sequence[Arrival], topics: int, slop: int) -> Sets:
    oracle = _Oracle(topics, slop)
    for topic, stamp in arrivals:
        oracle.add(topic, stamp)
    return oracle.sets


_TOPICS = st.integers(2, 4)
_SLOP = st.integers(0, 12)


@st.composite
def _in_order(draw: st.DrawFn) -> tuple[int, list[Arrival]]:
    """Messages of topics that are delayed against each other; each topic is in order, and has lost some."""
    topics = draw(_TOPICS)
    streams = [sorted(draw(st.sets(st.integers(0, 60), max_size=14))) for _ in range(topics)]
    arrivals: list[Arrival] = []
    while left := [topic for topic, stream in enumerate(streams) if stream]:
        topic = draw(st.sampled_from(left))
        arrivals.append((topic, streams[topic].pop(0)))
    return topics, arrivals


@st.composite
def _reordered(draw: st.DrawFn) -> tuple[int, list[Arrival]]:
    """Messages in any order, some of them twice."""
    topics = draw(_TOPICS)
    arrival = st.tuples(st.integers(0, topics - 1), st.integers(0, 60))
    return topics, draw(st.lists(arrival, max_size=40))


@given(_in_order(), _SLOP)
def test_sets_do_not_depend_on_delays(drawn: tuple[int, list[Arrival]], slop: int) -> None:
    """However late a topic is, the sets are those of the mutually nearest stamps within the slop, oldest first."""
    topics, arrivals = drawn
    streams = [{stamp for index, stamp in _flushed(arrivals, topics) if index == topic} for topic in range(topics)]
    mutual = [
        (stamp, *near)
        for stamp in sorted(streams[0])
        if (near := [_nearest(stream, stamp) for stream in streams[1:]]) is not None
        and all(abs(one - stamp) <= slop and _nearest(streams[0], one) == stamp for one in near)
    ]
    assert _run(_flushed(arrivals, topics), topics, slop) == mutual


@given(_reordered(), _SLOP)
def test_a_late_message_is_used_until_its_set_is_decided(drawn: tuple[int, list[Arrival]], slop: int) -> None:
    """Whatever comes late, twice or never: the sets are those of a search in everything that had come."""
    topics, arrivals = drawn
    arrivals = _flushed(arrivals, topics)
    assert _run(arrivals, topics, slop) == _expected(arrivals, topics, slop)


@given(_reordered(), _SLOP, st.integers(1, 4))
def test_short_queues_lose_sets_and_break_no_rule(drawn: tuple[int, list[Arrival]], slop: int, queue: int) -> None:
    """Each stamp is used once, stamps increase in every topic, none is farther than the slop, and each has come."""
    topics, arrivals = drawn
    sets = _run(_flushed(arrivals, topics), topics, slop, queue)
    for earlier, later in pairwise(sets):
        assert all(before < after for before, after in zip(earlier, later))
    for one in sets:
        assert max(abs(stamp - one[0]) for stamp in one) <= slop
        assert {*enumerate(one)} <= {*_flushed(arrivals, topics)}


def test_equal_stamps_do_not_wait() -> None:
    """A set of equal stamps is complete with its last message, in any order of the topics."""
    synchronizer = Synchronizer[str](3)
    assert synchronizer.add(2, 7, "info") == []
    assert synchronizer.add(0, 7, "colour") == []
    assert synchronizer.add(1, 7, "depth") == [("colour", "depth", "info")]


def test_a_lost_message_costs_its_own_set_alone() -> None:
    """The next set comes as soon as it is complete."""
    assert _run([(0, 10), (0, 20), (1, 20), (0, 30), (1, 30)], 2, 0) == [(20, 20), (30, 30)]


def test_a_silent_topic_does_not_fill_the_memory() -> None:
    """Of what waits for a topic that says nothing, the newest messages stay, and find their partners later."""
    waiting = [(0, stamp) for stamp in range(100)]
    assert _run([*waiting, (1, 94), (1, 96)], 2, 0, queue=5) == [(96, 96)]
    assert _run([*waiting, (1, 97)], 2, 0, queue=5) == [(97, 97)]


@pytest.mark.parametrize("slop", [0, 5])
def test_a_recording_that_starts_again_is_synchronized_again(slop: int) -> None:
    """After a jump back of the stamps, sets continue, although all stamps are older than before."""
    late, early = 100 * RESTART_NS, 3
    arrivals = [(topic, late + stamp) for stamp in (0, 10) for topic in (0, 1)]
    again = [(topic, early + stamp) for stamp in (0, 10) for topic in (0, 1)]
    assert _run([*arrivals, *again], 2, slop)[-2:] == [(3, 3), (13, 13)]
