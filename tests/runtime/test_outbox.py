"""What waits for a line: within the budget in each second, by priority and in order, and each loss is counted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.runtime.net.outbox import FIRST, URGENT, Outbox, Undelivered


class _Item(NamedTuple):
    number: int
    priority: int
    size: int
    given: float


class _Run:
    """An outbox, asked at its own times, or later, while datagrams come.

    The thread that sends is held up before each fifth datagram leaves.
    """

    def __init__(self, budget: int | None, load: Sequence[_Item], late: float = 0.0, held: float = 0.0) -> None:
        self.sent: dict[_Item, float] = {}
        self.dropped: dict[_Item, tuple[float, str]] = {}
        self._now, self._late, self._held = 0.0, late, held
        self._outbox: Outbox[_Item] = Outbox(lambda item: item.priority, budget, self._drop)
        for item in load:
            self._until(item.given)
            self._outbox.put(item, self._now, item.size)
            self._take()
        self._until(math.inf)
        assert {*load} == {*self.sent, *self.dropped}
        assert sum(self._outbox.undelivered.values()) == len(self.dropped)

    def _drop(self, item: _Item, why: Undelivered) -> None:
        self.dropped[item] = self._now, why.value

    def _until(self, time: float) -> None:
        while (due := self._outbox.next_due + self._late) <= time and due < math.inf:
            self._now = max(self._now, due)
            self._take()
        self._now = max(self._now, time) if time < math.inf else self._now

    def _take(self) -> None:
        while (item := self._outbox.take(self._now)) is not None:
            self._now += self._held * (len(self.sent) % 5 == 4)
            self.sent[item] = self._now
            self._outbox.has_left(item.size, self._now)


_BUDGETS = st.sampled_from([8_000, 60_000, 200_000, 5_000_000])
_GAPS = st.sampled_from([0.0, 0.0, 0.0001, 0.002, 0.03, 0.4])


@st.composite
def _loads(draw: st.DrawFn, budget: int, urgent: int = 1_000) -> list[_Item]:
    """Datagrams of all priorities, of which those that are urgent have at most so many bytes."""
    largest, load, now = budget // 4, list[_Item](), 0.0
    for gap, priority, share, copies in draw(
        st.lists(st.tuples(_GAPS, st.integers(0, FIRST), st.floats(0.001, 1), st.integers(1, 60)), max_size=25)
    ):
        for _ in range(copies):
            now += gap
            size = math.ceil(share * (urgent if priority >= URGENT else largest))
            load.append(_Item(len(load), priority, size, now))
    return load


def _check_budget(run: _Run, budget: int) -> list[tuple[float, _Item]]:
    """Check the bytes in each second, and return what has left."""
    log = [(time, item) for item, time in run.sent.items()]
    first = sent = 0
    for time, item in log:
        sent += item.size
        while log[first][0] < time - 1:
            sent -= log[first][1].size
            first += 1
        assert sent <= budget
    return log


@given(st.data(), _BUDGETS, st.sampled_from([0.0, 0.001, 0.05]))
def test_each_second_stays_within_the_budget_in_order(data: st.DataObject, budget: int, late: float) -> None:
    """Whatever comes, and however late the timer is; what is dropped was older, or less urgent, than what left."""
    load = data.draw(_loads(budget, budget // 4))
    _check_budget(_Run(budget, load, late, held=0.3), budget)
    run = _Run(budget, load, late)
    log = _check_budget(run, budget)
    for priority in range(FIRST + 1):
        numbers = [item.number for _, item in log if item.priority == priority]
        assert numbers == sorted(numbers)
    for lost, (when, why) in run.dropped.items():
        assert why in ("over_budget", "overflow")
        assert why == "overflow" or when >= lost.given + 0.5
        passed = [item for time, item in log if lost.given < time < when]
        assert all((-item.priority, item.number) < (-lost.priority, lost.number) for item in passed)


@settings(max_examples=40, deadline=None)
@given(st.data(), _BUDGETS)
def test_an_urgent_datagram_waits_for_its_own_kind_and_one_packet_at_most(data: st.DataObject, budget: int) -> None:
    """Beside all that comes, it leaves one packet later than without it; and at once if there are few of its kind."""
    largest = _Item(-1, 0, budget // 4, -100.0)  # which makes the bucket as large as it becomes
    load = [largest, *data.draw(_loads(budget))]
    urgent = [item for item in load if item.priority >= URGENT]
    beside, alone = _Run(budget, load).sent, _Run(budget, [largest, *urgent]).sent
    for item in urgent:
        if item in beside and item in alone:
            assert beside[item] - alone[item] <= 2 * largest.size / budget + 1e-6
            if sum(other.size for other in urgent if abs(other.given - item.given) <= 1) <= min(1_500, budget // 8):
                assert beside[item] == item.given


def test_the_rest_of_a_line_is_used_and_starves_in_the_order_of_priorities() -> None:
    """Three rows need twice the budget: the first gets all it needs, the second what is left, the third nothing."""
    load = [_Item(number, 2 - number % 3, 1_000, number / 400) for number in range(4_000)]
    run = _Run(200_000, load)
    shares = [sum(item.priority == priority for item in run.sent) for priority in (2, 1, 0)]
    assert shares[0] == 1_334
    assert sum(shares) > 0.97 * 2_000
    assert shares[2] < 30
    assert max(time - item.given for item, time in run.sent.items()) < 0.51


def test_what_can_never_leave_and_what_is_too_much_is_counted() -> None:
    """More than a quarter of a second's budget; more than a thousand that wait; an old one of a line without budget."""
    run = _Run(10_000, [_Item(0, 9, 2_501, 0.0), _Item(1, 0, 2_500, 0.0)])
    assert ([*run.sent], run.dropped) == ([(1, 0, 2_500, 0.0)], {(0, 9, 2_501, 0.0): (0.0, "too_large")})
    crowd = [_Item(number, number % 2, 100, 0.0) for number in range(1_500)]
    overflow = [item.number for item, (_, why) in _Run(100_000, crowd).dropped.items() if why == "overflow"]
    assert overflow == [*range(overflow[0], overflow[0] + 2 * len(overflow), 2)]
    outbox: Outbox[bytes] = Outbox()
    outbox.put(b"old", 1.0)
    outbox.put(b"new", 1.4)
    assert (outbox.take(1.6), outbox.next_due, outbox.undelivered) == (b"new", math.inf, {"stale": 1})
