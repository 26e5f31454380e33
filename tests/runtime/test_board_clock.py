"""Stamps by the clock of a board are the true times of measuring, as far as they say."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.runtime.core.board_clock import BoardClock
from roverlink.runtime.core.handler import BoardStamp
from roverlink.runtime.core.link_message import LinkMessage
from roverlink.runtime.core.link_statistics import Exchange, LinkStatistics

_S, _MS, _US = 10**9, 10**6, 10**3

_QUEUES: dict[str, Callable[[random.Random], float]] = {
    "any length": lambda rng: rng.uniform(0, 5 * _MS),
    "mostly short": lambda rng: rng.expovariate(1 / (5 * _MS)),
}


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    rate=st.sampled_from([10, 30]),
    drift=st.floats(-5e-5, 5e-5),
    counter=st.sampled_from([(1, 64), (_US, 32), (_US, 64), (_MS, 32)]),
    since_start=st.sampled_from([0, 2**32 * _US - 25 * _S, 10**15]),
    queue=st.sampled_from(sorted(_QUEUES)),
    has_link=st.booleans(),
)
def test_a_stamp_is_less_than_a_millisecond_wrong_and_says_how_much(
    seed: int, rate: int, drift: float, counter: tuple[int, int], since_start: int, queue: str, has_link: bool
) -> None:
    """With 5 ms of queues, 50 ppm and counters that wrap; without the link message the shortest delay remains."""
    rng, clock, statistics = random.Random(seed), BoardClock(), LinkStatistics()  # noqa: S311  # repeatable
    stamp = BoardStamp(("at",), *counter)
    here, shortest, errors, outside = rng.randrange(10**18), 200 * _US, list[float](), 0

    def delay() -> int:
        return shortest + round(_QUEUES[queue](rng))

    def there(time: int) -> int:
        return since_start + round(time * (1 + drift))

    for index in range(45 * rate):
        now = index * _S // rate
        if has_link and index % rate == 0:
            asked, answered = now + delay(), now + delay() + 300 * _MS
            times = {"echo_us": (here + now) // _US, "echo_age_us": (there(answered) - there(asked)) // _US}
            link = LinkMessage(7, 1 + index // rate, 0, 0, there(answered) // _US, hashes={}, **times)
            statistics.take(link, (here + answered + delay()) // _US, 0, 0)
            clock.take_exchanges(statistics.exchanges)
        arrived = now + delay()
        age = clock.age(stamp, there(now) // stamp.nanoseconds % 2**stamp.bits, here + arrived)
        if now >= 30 * _S:
            uncertainty = clock.report(0).uncertainty
            assert age is not None
            assert uncertainty is not None
            errors.append(arrived - age - now - (0 if has_link else shortest))
            outside += abs(errors[-1]) > uncertainty * _S
    assert max(map(abs, errors)) < _MS + (stamp.nanoseconds if stamp.nanoseconds > _US else 0)
    assert outside <= len(errors) / 100
    assert abs((clock.report(0).drift or 0) - drift) < (1.5e-5 if stamp.nanoseconds <= _US else 5e-5)


@pytest.mark.slow
def test_a_clock_without_a_quartz_is_learned_as_well() -> None:
    """A drift of 1 % is no reason for stamps that are wrong, once it is known."""
    rng, clock, stamp = random.Random(1), BoardClock(), BoardStamp(("at",), _US, 32)  # noqa: S311  # repeatable
    for index in range(3000):
        now = index * 20 * _MS
        arrived = now + round(rng.uniform(0, 5 * _MS))
        age = clock.age(stamp, round(now * 1.01) // _US, arrived)
        if index > 1500:
            assert age is not None
            assert abs(arrived - age - now) < _MS


def test_a_new_session_begins_again_although_the_counter_fits() -> None:
    """After a restart, a counter of 32 bits may by chance have the value that was expected."""
    clock, stamp = BoardClock(), BoardStamp(("at",), _US, 32)
    exchanges = [Exchange(one, one, one, one) for one in range(8)]
    clock.take_exchanges(exchanges)
    ages = [clock.age(stamp, second * 1_000_000, second * _S) for second in range(20)]
    assert ages[-1] == 0
    clock.take_exchanges(exchanges[:1])
    assert clock.age(stamp, 20_000_000, 20 * _S) is None
    assert clock.report(0).restarts == 1
