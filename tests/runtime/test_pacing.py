"""At most so many a second, and the newest wins."""

from __future__ import annotations

import itertools

from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.runtime.bridge.pacing import Pacer


def test_the_newest_waits_and_the_others_are_counted() -> None:
    """The first passes; of those that come too early, the last is what passes when its time has come."""
    pacer: Pacer[str] = Pacer(10)
    assert pacer.offer("a", 1.0)
    assert not pacer.offer("b", 1.01)
    assert not pacer.offer("c", 1.02)
    assert pacer.next_slot == 1.1
    assert pacer.take(1.09) is None
    assert pacer.take(1.1) == "c"
    assert pacer.take(1.3) is None
    assert pacer.next_slot is None
    assert pacer.superseded == 1


def test_what_waits_can_be_withdrawn() -> None:
    """A stop must not be followed by an older command."""
    pacer: Pacer[str] = Pacer(10)
    pacer.offer("a", 1.0)
    pacer.offer("b", 1.05)
    assert pacer.withdraw() == "b"
    assert pacer.withdraw() is None
    assert pacer.take(9.0) is None


@settings(max_examples=30)
@given(st.lists(st.tuples(st.floats(0, 0.3), st.booleans()), max_size=100))
def test_order_is_kept_the_rate_is_kept_and_the_sums_agree(events: list[tuple[float, bool]]) -> None:
    """Whatever the times of offers and takes."""
    pacer: Pacer[int] = Pacer(10)
    now, offered = 0.0, 0
    passed: list[tuple[float, int]] = []
    for wait, offers in events:
        now += wait
        if offers:
            if pacer.offer(offered, now):
                passed.append((now, offered))
            offered += 1
        elif (thing := pacer.take(now)) is not None:
            passed.append((now, thing))
    waits = pacer.withdraw() is not None
    assert [thing for _, thing in passed] == sorted({thing for _, thing in passed})
    assert all(later - earlier > 0.1 - 1e-9 for (earlier, _), (later, _) in itertools.pairwise(passed))
    assert len(passed) + pacer.superseded + waits == offered
