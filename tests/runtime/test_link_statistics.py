"""Statistics of the link messages say what a simulated link did to the datagrams."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.runtime.core.link_message import LinkMessage
from roverlink.runtime.core.link_statistics import LinkStatistics

_BITS = 2**32
_SECOND_US = 1_000_000


def _message(sequence: int, sent: int, time_us: int, **more: int) -> LinkMessage:
    values = {"received": 0, "echo_us": 0, "echo_age_us": 0, **more}
    return LinkMessage(7, sequence % _BITS, sent % _BITS, time_us=time_us, hashes={}, **values)


def _regular(count: int, first: int = 1, sent: int = 0, step: int = 10) -> Iterator[LinkMessage]:
    for index in range(count):
        yield _message(first + index, sent + index * step, index * _SECOND_US)


@pytest.mark.parametrize("first", [1, _BITS - 5])
@pytest.mark.parametrize("sent", [0, _BITS - 25])
def test_a_perfect_link_loses_nothing_also_when_counters_wrap_around(first: int, sent: int) -> None:
    """Counters of 32 bits that start again at 0 are no loss, no duplicate and no change of order."""
    statistics = LinkStatistics()
    for index, message in enumerate(_regular(20, first, sent)):
        statistics.take(message, message.time_us + 500, index * 10, None)
    assert str(statistics).startswith("LinkStatistics(messages=20, lost_inbound=0, lost_outbound=0, duplicates=0,")
    assert (statistics.inbound.lost, statistics.inbound.recent) == (0, 0.0)
    assert (statistics.duplicates, statistics.reordered, statistics.jitter_us) == (0, 0, 0.0)


def test_one_message_says_nothing_yet() -> None:
    """What needs two link messages, or an answer, is unknown after the first one."""
    statistics = LinkStatistics()
    statistics.take(_message(5, 100, 0), 0, 3, None)
    assert (statistics.inbound.lost, statistics.inbound.recent, statistics.outbound.recent) == (0, None, None)
    assert (statistics.jitter_us, statistics.round_trip_us, statistics.clock_offset_us) == (None, None, None)


@pytest.mark.slow
@settings(max_examples=20)
@given(st.randoms(use_true_random=False))
def test_the_loss_is_that_of_the_link(random: Random) -> None:
    """What a link loses is counted exactly, whichever datagrams it loses, link messages included."""
    statistics, sent, arrived, lost = LinkStatistics(), 0, 0, 0
    start = random.choice([0, _BITS - 100])
    for sequence in range(1, 60):
        if sequence in (1, 59) or random.random() < 0.7:
            message = _message(sequence, start + sent, sequence * _SECOND_US)
            statistics.take(message, message.time_us, arrived, None)
            assert statistics.inbound.lost == lost
            arrived += 1
        else:
            lost += 1
        sent += 1
        for _ in range(random.randrange(20)):
            kept = random.random() < 0.8
            sent, arrived, lost = sent + 1, arrived + kept, lost + (not kept)
    assert statistics.inbound.recent is not None


def test_recent_loss_forgets_an_old_outage() -> None:
    """The share of the last messages shows how the link is now; the number counts from the start."""
    statistics = LinkStatistics()
    for index, message in enumerate(_regular(60)):
        statistics.take(message, message.time_us, index * 10 if index < 10 else (index - 1) * 10, None)
    assert statistics.inbound.lost == 10
    assert statistics.inbound.recent == 0


@pytest.mark.slow
@given(st.permutations(range(1, 20)), st.lists(st.integers(0, 18), max_size=10))
def test_order_and_duplicates_are_counted(order: list[int], repeated: list[int]) -> None:
    """A message behind a later one is reordered, and one that came before is a duplicate and changes nothing else."""
    statistics, newest, late = LinkStatistics(), 0, 0
    for sequence in order:
        statistics.take(_message(sequence, sequence, sequence), 0, sequence, None)
        late += sequence < newest
        newest = max(newest, sequence)
    assert (statistics.messages, statistics.reordered, statistics.duplicates) == (19, late, 0)
    lost = statistics.inbound.lost
    for index in repeated:
        statistics.take(_message(order[index], 999, 999), 999, 999, None)
    assert (statistics.messages, statistics.reordered, statistics.duplicates) == (19, late, len(repeated))
    assert statistics.inbound.lost == lost


def test_the_jitter_is_that_of_the_standard() -> None:
    """RFC 3550: J grows by a sixteenth of |D| - J, where D is the change of the transit time."""
    statistics, expected, before = LinkStatistics(), 0.0, None
    for index, delay_us in enumerate([100, 900, 300, 300, 5000, 100]):
        message = _message(index + 1, index, index * _SECOND_US)
        statistics.take(message, message.time_us + delay_us, index, None)
        if before is not None:
            expected += (abs(delay_us - before) - expected) / 16
        before = delay_us
    assert statistics.jitter_us == pytest.approx(expected)


def test_a_clock_that_jumps_is_no_jitter() -> None:
    """If the sender's clock is set, the jump is not taken for a delay, and older exchanges do not count."""
    statistics = LinkStatistics()
    statistics.take(_message(1, 0, 0, echo_us=1_000), 2_000, 0, 0)
    assert statistics.clock_offset_us is not None
    statistics.take(_message(2, 1, 3600 * _SECOND_US), 2_000 + _SECOND_US, 1, None)
    assert (statistics.jitter_us, statistics.clock_offset_us) == (None, None)


@given(
    offset_us=st.integers(-(10**15), 10**15),
    there_us=st.lists(st.integers(50, 200_000), min_size=8, max_size=8),
    back_us=st.lists(st.integers(50, 200_000), min_size=8, max_size=8),
    age_us=st.integers(0, 2_000_000),
)
def test_round_trip_and_offset_are_those_of_the_shortest_exchange(
    offset_us: int, there_us: list[int], back_us: list[int], age_us: int
) -> None:
    """The shortest of the last eight exchanges counts; its offset is wrong by half the difference of the two ways."""
    statistics = LinkStatistics()
    base = 10**16  # so that no clock is negative
    for old in range(3):  # shorter, but more than eight exchanges ago
        statistics.take(_message(old + 1, 0, base + offset_us + old, echo_us=base + old), base + old, 0, 0)
    for index, (there, back) in enumerate(zip(there_us, back_us)):
        asked = base + (index + 1) * 10 * _SECOND_US
        answered = asked + there + age_us
        message = _message(10 + index, 0, answered + offset_us, echo_us=asked, echo_age_us=age_us)
        statistics.take(message, answered + back, 0, 0)
    trip, there, back = min(
        (there + back, there, back) for there, back in zip(there_us, back_us)
    )  # of equal trips, any may count
    assert statistics.round_trip_us == trip
    assert statistics.clock_offset_us is not None
    assert abs(statistics.clock_offset_us - offset_us) <= trip / 2 + 1


def test_an_answer_that_cannot_be_true_is_ignored() -> None:
    """An echo of no known message, one twice, or one that is older than its question gives no round trip."""
    statistics = LinkStatistics()
    statistics.take(_message(1, 0, 0, echo_us=500), 1000, 0, None)
    assert statistics.round_trip_us is None
    statistics.take(_message(2, 0, 0, echo_us=500, echo_age_us=2_000_000), 1000, 0, 0)
    assert statistics.round_trip_us is None
    statistics.take(_message(3, 0, 0, echo_us=700), 1000, 0, 0)
    statistics.take(_message(4, 0, 0, echo_us=700), 701, 0, 0)
    assert statistics.round_trip_us == 300
