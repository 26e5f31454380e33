"""The account of a bridge, and warnings that do not fill the log."""

from __future__ import annotations

import json
import logging
from collections import Counter

import pytest

from roverlink.runtime.bridge.account import WARNING_INTERVAL_S, Account, ThrottledWarnings


class _Clock:
    """Time that passes when it is told to."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> _Clock:
    """A clock of our own."""
    return _Clock()


@pytest.fixture
def warnings(clock: _Clock) -> ThrottledWarnings:
    """Warnings by that clock."""
    return ThrottledWarnings(logging.getLogger("test_account"), clock)


def test_the_first_warning_is_given_at_once(warnings: ThrottledWarnings, caplog: pytest.LogCaptureFixture) -> None:
    """A warning is logged as such, in its own words."""
    warnings.warn("malformed", "dropped: 100% of it")
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [
        ("WARNING", "dropped: 100% of it")
    ]


def test_more_of_it_is_kept_back_and_counted(
    warnings: ThrottledWarnings, clock: _Clock, caplog: pytest.LogCaptureFixture
) -> None:
    """Within two seconds a subject is warned of once; the next warning says how many there were between."""
    warnings.warn("malformed", "first")
    for _ in range(1000):
        clock.now += WARNING_INTERVAL_S / 2000
        warnings.warn("malformed", "between")
    clock.now += WARNING_INTERVAL_S
    warnings.warn("malformed", "second")
    clock.now += WARNING_INTERVAL_S
    warnings.warn("malformed", "third")
    assert caplog.messages == ["first", "second (and 1000 more like it)", "third"]


def test_the_interval_is_two_seconds(
    warnings: ThrottledWarnings, clock: _Clock, caplog: pytest.LogCaptureFixture
) -> None:
    """Just before two seconds nothing is said, at two seconds it is."""
    assert WARNING_INTERVAL_S == 2.0
    warnings.warn("a", "first")
    clock.now += 1.99
    warnings.warn("a", "early")
    clock.now += 0.01
    warnings.warn("a", "on time")
    assert caplog.messages == ["first", "on time (and 1 more like it)"]


def test_subjects_do_not_silence_each_other(warnings: ThrottledWarnings, caplog: pytest.LogCaptureFixture) -> None:
    """Each subject has an interval of its own."""
    for subject in ("malformed", "empty", "malformed", "lost"):
        warnings.warn(subject, subject)
    assert caplog.messages == ["malformed", "empty", "lost"]


def _account() -> Account:
    return Account(
        received=10,
        published=Counter(imu_info=4, gps_info=1),
        sent=Counter(drive_motor=2),
        forwarded=Counter(basestation=5),
        dropped=Counter(malformed=3, empty=0, conversion=1),
        unsent=Counter(hardware=1),
        unforwarded=Counter(basestation=2),
        link_events=Counter({("hardware", "ArmBoard", "learned"): 1, ("basestation", "", "unreachable"): 2}),
        taken=Counter(drive_motor=4, arm_ctrl=1),
        refused=Counter(arm_ctrl=1),
        superseded=Counter(drive_motor=1),
        failed=Counter(drive_motor=1),
        stops=Counter(drive_motor=3),
        extra_published=Counter({"imu/mag": 4}),
        extra_unpublished=Counter({"gps/fix": 1}),
        qos_mismatches={"imu_data": ["a subscription of /viz gets no messages"]},
        kernel_drops=7,
    )


def test_the_account_as_plain_values() -> None:
    """Totals, and what lies behind them; a reason that never occurred is left out."""
    values = _account().as_dict()
    assert json.loads(json.dumps(values)) == values
    assert values == {
        "received": 10,
        "published": 5,
        "sent": 2,
        "forwarded": 5,
        "dropped": {"conversion": 1, "malformed": 3},
        "taken": 5,
        "refused": {"arm_ctrl": 1},
        "superseded": {"drive_motor": 1},
        "failed": {"drive_motor": 1},
        "stops": {"drive_motor": 3},
        "unsent": {"hardware": 1},
        "unforwarded": {"basestation": 2},
        "link_events": {"basestation unreachable": 2, "hardware ArmBoard learned": 1},
        "links_received": 0,
        "links_sent": {},
        "other_schemas": {},
        "extra_published": {"imu/mag": 4},
        "extra_unpublished": {"gps/fix": 1},
        "qos_mismatches": {"imu_data": 1},
        "kernel_drops": 7,
        "by_payload": {"published": {"gps_info": 1, "imu_info": 4}, "sent": {"drive_motor": 2}},
    }


def test_the_account_in_one_line() -> None:
    """An operator reads at the end what came, what went, and what was lost for which reason."""
    assert _account().summary() == (
        "received 10, published 5, sent 2, forwarded 5; dropped: conversion 1, malformed 3; by the kernel: 7"
    )
    assert "dropped: none" in Account().summary()


def test_sums_that_do_not_agree_are_told() -> None:
    """What was received and taken has to be found again; of an empty account nothing is missing."""
    assert Account().discrepancies() == []
    assert _account().discrepancies() == ["10 datagrams received, but 9 published and dropped"]
    account = _account()
    account.published["imu_info"] += 1
    assert account.discrepancies() == []
    account.sent["drive_motor"] += 1
    assert account.discrepancies() == ["5 messages taken, but 6 sent, refused, superseded and failed"]
