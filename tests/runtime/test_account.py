"""The account of a bridge, and warnings that do not fill the log."""

from __future__ import annotations

import json
import logging
from collections import Counter

import pytest

from roverlink.runtime.bridge.account import Account, ThrottledWarnings


def test_a_subject_is_warned_of_once_in_two_seconds(caplog: pytest.LogCaptureFixture) -> None:
    """The next warning, or the end, says how many there were between, as a fact too; subjects have intervals each."""
    times = iter([1000.0, *[1000.0, 1001.0, 1001.99] * 2, 1002.0, 1004.0, 1004.0])
    warnings = ThrottledWarnings(logging.getLogger("test_account"), lambda: next(times))
    warnings.warn("malformed", "dropped: 100% of it")
    for subject, message in (("malformed", "between"), ("empty", "another")):
        for _ in range(3):
            warnings.warn(subject, message)
    for _ in range(2):
        warnings.warn("malformed", "on time")
    warnings.warn("malformed", "good news", logging.INFO)
    warnings.log_suppressed()
    warnings.log_suppressed()
    assert [(record.getMessage(), record.facts["kept_back"]) for record in caplog.records] == [  # type: ignore[attr-defined]
        ("dropped: 100% of it", 0),
        ("another", 0),
        ("on time (and 3 more like it)", 3),
        ("on time", 0),
        ("another (and 2 more like it)", 2),
        ("on time (and 1 more like it)", 1),
    ]
    assert {record.levelname for record in caplog.records} == {"WARNING"}


def _account() -> Account:
    return Account(
        received=10,
        published=Counter(imu_info=4, gps_info=1),
        sent=Counter(drive_motor=2),
        forwarded=Counter(basestation=5),
        dropped=Counter(malformed=3, empty=0, conversion=1),
        clocks_ahead=Counter(ArmBoard=3),
        unsent=Counter(hardware=1),
        unforwarded=Counter(basestation=2),
        undelivered=Counter({("hardware", "", "stale"): 4}),
        damaged=Counter({("hardware", "ArmBoard"): 6}),
        link_events=Counter({("hardware", "ArmBoard", "learned"): 1, ("basestation", "", "unreachable"): 2}),
        taken=Counter(drive_motor=5, arm_ctrl=3),
        refused=Counter(arm_ctrl=1),
        superseded=Counter(drive_motor=1),
        unchanged=Counter(arm_ctrl=2),
        late=Counter(drive_motor=1, arm_ctrl=0),
        failed=Counter(drive_motor=1),
        stops=Counter(drive_motor=3),
        withheld=Counter({("basestation", "gps_info", "superseded"): 6}),
        repeated=Counter(gps_info=2),
        budget_bytes=Counter(basestation=900),
        extra_published=Counter({"imu/mag": 4}),
        extra_unpublished=Counter({"gps/fix": 1}),
        qos_mismatches={"imu_data": ["a subscription of /viz gets no messages"]},
        kernel_drops=7,
        standing={"generated code": "it is old", "network": ""},
    )


def test_the_account_as_plain_values() -> None:
    """Totals, and what lies behind them; a reason that never occurred is left out."""
    values, expected = _account().as_dict(), dict[str, object]()
    assert json.loads(json.dumps(values)) == values
    expected |= {
        "received": 10,
        "published": 5,
        "sent": 2,
        "forwarded": 5,
        "taken": 8,
        "late": {"drive_motor": 1},
        "kernel_drops": 7,
    }
    expected |= {"dropped": {"conversion": 1, "malformed": 3}, "qos_mismatches": {"imu_data": 1}}
    expected |= {"refused": {"arm_ctrl": 1}, "failed": {"drive_motor": 1}, "superseded": {"drive_motor": 1}}
    expected |= {"unchanged": {"arm_ctrl": 2}, "repeated": {"gps_info": 2}, "budget_bytes": {"basestation": 900}}
    expected |= {"withheld": {"basestation gps_info superseded": 6}}
    expected |= {"stops": {"drive_motor": 3}, "unsent": {"hardware": 1}, "unforwarded": {"basestation": 2}}
    expected |= {"link_events": {"basestation unreachable": 2, "hardware ArmBoard learned": 1}}
    expected |= {
        "links_received": 0,
        "links_sent": {},
        "other_schemas": {},
        "unanswered": {},
        "clocks_ahead": {"ArmBoard": 3},
    }
    expected |= {"extra_published": {"imu/mag": 4}, "extra_unpublished": {"gps/fix": 1}}
    expected |= {"undelivered": {"hardware stale": 4}, "damaged": {"hardware ArmBoard": 6}}
    expected |= {"standing": {"generated code": "it is old"}}
    expected |= {"by_payload": {"published": {"gps_info": 1, "imu_info": 4}, "sent": {"drive_motor": 2}}}
    assert values == expected


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
    assert account.discrepancies() == ["8 messages taken, but 9 sent, refused, superseded, unchanged, late and failed"]
