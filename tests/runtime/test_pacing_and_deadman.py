"""At most so many a second, and the newest wins; and when the stop of a silent topic is due."""

from __future__ import annotations

import itertools
import math

from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.runtime.bridge.deadman import Watchdog
from roverlink.runtime.bridge.limited_row import Pacer


def test_the_newest_waits_and_the_others_are_counted() -> None:
    """The first passes; of those that come too early, the last is what passes when its time has come."""
    pacer = Pacer(10)
    assert pacer.offer([b"-", b"a"], 1.0) == ([b"a"], 1)
    assert pacer.offer([b"b"], 1.01) == ((), 0)
    assert pacer.offer([b"-", b"c"], 1.02) == ((), 2)
    assert pacer.next_slot == 1.1
    assert pacer.take(1.09) is None
    assert pacer.take(1.1) == b"c"
    assert pacer.take(1.3) is None
    assert pacer.next_slot is None


@settings(max_examples=30)
@given(st.lists(st.tuples(st.floats(0, 0.3), st.booleans()), max_size=100))
def test_order_is_kept_the_rate_is_kept_and_the_sums_agree(events: list[tuple[float, bool]]) -> None:
    """Whatever the times of offers and takes."""
    pacer = Pacer(10)
    now, offered, superseded = 0.0, 0, 0
    passed: list[tuple[float, int]] = []
    for wait, offers in events:
        now += wait
        if offers:
            passing, replaced = pacer.offer([b"%d" % offered], now)
            passed += [(now, int(message)) for message in passing]
            offered, superseded = offered + 1, superseded + replaced
        elif (message := pacer.take(now)) is not None:
            passed.append((now, int(message)))
    waits = pacer.withdraw() is not None
    assert [number for _, number in passed] == sorted({number for _, number in passed})
    assert all(later - earlier > 0.1 - 1e-9 for (earlier, _), (later, _) in itertools.pairwise(passed))
    assert len(passed) + superseded + waits == offered


def _due(watchdog: Watchdog, *times: float) -> list[float]:
    """Those of some times at which the stop is due."""
    return [now for now in times if watchdog.is_due(now)]


def test_the_stop_is_due_once_the_topic_was_silent_long_enough() -> None:
    """Counted from the start or the last message; then again at the low rate, until there is another message."""
    watchdog = Watchdog(0.5, 2.0, now=0.0)
    assert _due(watchdog, 0.4, 0.5) == [0.5]
    watchdog.message_passed(1.3)
    assert not watchdog.silent
    assert _due(watchdog, 1.5, 1.79, 1.8, 1.9, 3.7, 3.8, 5.0, 5.8) == [1.8, 3.8, 5.8]
    assert watchdog.silent


def test_a_publisher_that_leaves_is_not_waited_for() -> None:
    """The stop is due at once, but not once more for having left."""
    watchdog = Watchdog(0.5, 2.0, now=0.0)
    watchdog.message_passed(1.0)
    watchdog.lost_publisher()
    assert _due(watchdog, 1.01, 1.02) == [1.01]
    watchdog.lost_publisher()
    assert _due(watchdog, 1.03, 3.0, 3.01) == [3.01]


@settings(max_examples=30)
@given(st.lists(st.tuples(st.floats(0, 3), st.booleans()), max_size=60))
def test_whatever_happens_silence_is_never_longer_than_after(events: list[tuple[float, bool]]) -> None:
    """Asked at its own times, the watchdog tells of every silence just when it is long enough."""
    watchdog = Watchdog(0.5, 1.0, now=0.0)
    now = last = 0.0
    for wait, speaks in events:
        until = now + wait
        while watchdog.next_due <= until:
            due = watchdog.next_due
            assert watchdog.is_due(due)
            assert due >= last + 0.5 or math.isclose(due, last + 0.5)
            assert watchdog.next_due > due
        now = until
        if speaks:
            watchdog.message_passed(now)
            last = now
        assert watchdog.next_due <= now + 1.0
