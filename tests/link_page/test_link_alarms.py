"""What `top` and the page judge: which peers and boards are alive, what is the worst, and which alarms there are."""

from __future__ import annotations

from typing import Any

import pytest

from roverlink.link_judgement import Condition, conditions_of, judge_rows, old, peers_of, worst_of
from roverlink.link_page.link_alarms import LinkAlarms


def _row(board: str, age: float | None, direction: str = "hardware_to_ros", **more: Any) -> dict[str, Any]:
    seen = {} if age is None else {"age": age}
    common = {"name": f"{board} {direction}", "peer": "hardware", "direction": direction, "rate": 1.0, "count": 1}
    return {**common, "level": "OK", "message": "", **({"board": board} if board else {}), **seen, **more}


_DOWN = _row("Lamp", 0.1, "ros_to_hardware")


@pytest.mark.parametrize(
    ("rows", "state", "boards"),
    [
        ([_row("", None)], "never", {}),
        ([_row("", 2.0), _row("", 90.0)], "alive", {}),
        ([_row("", 4.0)], "silent", {}),
        ([_row("", 4.0, expect_rate=0.1)], "alive", {}),
        ([_row("", 31.0, expect_rate=0.1)], "silent", {}),
        ([_row("", 1.0, "ros_to_hardware")], "listens", {}),
        ([_row("Arm", 9.0), _row("", 1.0)], "alive", {"Arm": "silent"}),
        (
            [_row("Arm", 9.0), _row("Drive", 1.0), _row("Lid", None), _DOWN],
            "alive",
            {"Arm": "silent", "Drive": "alive", "Lid": "never", "Lamp": "listens"},
        ),
        (
            [_row("Arm", 9.0), _row("Drive", 4.0), _row("Lid", None), _DOWN],
            "silent",
            {"Arm": "silent", "Drive": "silent", "Lid": "never", "Lamp": "listens"},
        ),
        ([_row("Arm", None), _DOWN], "never", {"Arm": "never", "Lamp": "listens"}),
        ([_DOWN], "listens", {"Lamp": "listens"}),
        ([_row("Arm", 9.0), _row("Lid", 31.0, expect_rate=0.1)], "silent", {"Arm": "silent", "Lid": "silent"}),
        ([_row("Arm", 9.0), _row("Lid", 29.0, expect_rate=0.1)], "alive", {"Arm": "silent", "Lid": "alive"}),
    ],
)
def test_states_of_peers_and_boards(rows: list[dict[str, Any]], state: str, boards: dict[str, str]) -> None:
    """Silent is after three seconds, or three periods of a row that is expected more rarely; boards have their own."""
    (peer,) = peers_of({}, rows)
    assert (peer["state"], {board["name"]: board["state"] for board in peer["boards"]}) == (state, boards)


def _end(link: str, board: str = "Arm") -> dict[str, Any]:
    return {"peer": "hardware", "board": board, "link": link, "address": ""}


def _state(*given: dict[str, Any], end: dict[str, Any] | None = None, level: str = "OK", **link: Any) -> dict[str, Any]:
    rows, links = [dict(row) for row in given], [{"peer": "hardware", "board": "Arm", **link}]
    peers = peers_of({}, rows, [end] if end else [], links)
    judge_rows(rows, peers)
    return {"quiet": False, "node": {"level": level, "message": "as told"}, "peers": peers, "rows": rows}


_ARM = _row("Arm", 1.0, name="arm")
_NEVER = _row("Arm", None, count=0)
_STOP = _row("", 7.0, "ros_to_hardware", deadman_after=0.5, stops=3, stopping=1, name="drive")


@pytest.mark.parametrize(
    ("state", "worst", "subjects", "verdicts"),
    [
        (_state(_ARM), "OK: as told", "", "OK"),
        (_state(_ARM, level="WARN"), "WARN: as told", "bridge", "OK"),
        (_state(_NEVER), "WAITING: no message yet from hardware", "", "IDLE"),
        (_state(_NEVER, _row("", 1.0)), "WAITING: no message yet from Arm", "", "IDLE OK"),
        (_state(_row("Arm", 5.0), _row("", 1.0)), "ERROR: Arm is silent: no message for 5 s", "board Arm", "SILENT OK"),
        (_state(_row("Arm", 60.0), _row("", 5.0)), "ERROR: hardware", "peer hardware, board Arm", "SILENT SILENT"),
        (_state(_row("Arm", 3.5), _row("", 2.9)), "ERROR: Arm is silent", "", "SILENT OK"),
        (_state(_row("Arm", 4.5), _row("", 3.9), level="WARN"), "ERROR", "bridge, peer hardware", "SILENT SILENT"),
        (_state(_row("Arm", 9.0), _row("Arm", 0.1, "ros_to_hardware")), "ERROR", "peer hardware", "SILENT SILENT"),
        (_state(_NEVER, age=0.5), "OK: as told", "", "IDLE"),
        (_state({**_NEVER, "expect_rate": 1.0}, age=0.5), "WAITING: no message yet from hardware", "", "IDLE"),
        (_state(_row("Arm", 60.0), age=2.0), "OK: as told", "", "OK"),
        (
            _state(_row("Arm", 60.0), age=5.0),
            "ERROR: hardware is silent: no message for 5 s",
            "peer hardware",
            "SILENT",
        ),
        (_state({**_STOP, "count": 0}), "OK", "", "REST"),
        (_state(_STOP), "ERROR: no command drive for 7 s: the bridge tells hardware to stop", "stop drive", "STOP"),
        (_state({**_ARM, "level": "STALE"}), "SILENT: arm: ", "row arm", "SILENT"),
        (_state(_ARM, differing="arm"), "WARN: Arm runs other protos: arm may be misread", "schema Arm", "WARN"),
        (_state(_ARM, loss_in=0.02, loss_out=0.1), "OK", "", "OK"),
        (_state(_ARM, loss_in=0.02, loss_out=0.2), "WARN: Arm loses 20 %", "loss Arm", "WARN"),
        (_state(_ARM, loss_in=0.61), "ERROR: Arm loses 61 %", "loss Arm", "WARN"),
        (_state(_ARM, end=_end("not_resolved")), "WARN: Arm gets no commands: its host cannot", "link Arm", "OK"),
        (_state(_ARM, end=_end("not_learned")), "OK", "", "OK"),
        (_state(_ARM, end=_end("unreachable", "Lid")), "ERROR: Lid gets no commands", "link Lid", "OK"),
    ],
)
def test_the_worst_of_all_parts_is_told(state: dict[str, Any], worst: str, subjects: str, verdicts: str) -> None:
    """What is wrong, the worst of it, and the verdicts of the rows; of a quiet bridge, nothing is known.

    A silent board is an alarm while the rest speaks; boards that fall silent together are one alarm, that of the peer.
    The stop before the first command is no alarm.
    """
    found, told = conditions_of(state), worst_of(state)
    assert f"{told.level}: {told.text}".startswith(worst)
    assert ", ".join(found).replace(" of hardware", "") == subjects
    assert " ".join(row["verdict"] for row in state["rows"]) == verdicts
    assert all(condition.advice for condition in found.values())
    assert told.level != "OK" or {*verdicts.split()} <= {"OK", "IDLE", "REST"}
    quiet = old(state)
    assert (list(conditions_of(quiet)), worst_of(quiet).level) == (["bridge"], "UNKNOWN")
    assert {row["verdict"] for row in quiet["rows"]} == {peer["state"] for peer in quiet["peers"]} == {"UNKNOWN"}


def test_the_address_stands_at_its_board() -> None:
    """A board has the state of its address and the result of its link messages; a peer may only have an address."""
    radio = {"peer": "radio", "link": "ok", "address": "239.0.0.7:6000"}
    found = peers_of({}, [_ARM], [_end("not_resolved"), radio], [{"peer": "hardware", "board": "Arm", "senders": 1}])
    (arm,) = found[0]["boards"]
    assert (arm["link"], arm["report"]["senders"], "report" in found[0]) == ("not_resolved", 1, False)
    assert (found[1]["name"], found[1]["state"], found[1]["address"]) == ("radio", "listens", "239.0.0.7:6000")


def test_alarms_stay_until_they_come_anew() -> None:
    """An alarm that is over stays in the list, behind the others; a new onset or a worse level has a new number.

    Of a quiet bridge, nobody knows whether an alarm is over.
    """
    alarms = LinkAlarms()
    alarms.update("b", {"row a": Condition("WARN", "1 lost")}, 1.0)
    alarms.update("b", {"row a": Condition("WARN", "2 lost")}, 2.0)
    alarms.update("other", {}, 2.5)
    alarms.update("b", {}, 3.0)
    (alarm,) = alarms.as_list()
    assert [alarm[key] for key in ("number", "text", "since", "ended")] == [1, "2 lost", 1.0, 3.0]
    alarms.update("b", {"row a": Condition("WARN", "3 lost")}, 4.0)
    alarms.update("b", {"row b": Condition("WARN", "1 lost"), "row a": Condition("ERROR", "all lost")}, 5.0)
    alarms.update("other", {"row c": Condition("ERROR", "all lost")}, 5.5)
    alarms.update("other", {}, 5.6)

    def told() -> list[tuple[int, str, bool]]:
        return [(alarm["number"], alarm["level"], alarm["ended"] is None) for alarm in alarms.as_list()]

    assert told() == [(4, "ERROR", True), (3, "WARN", True), (5, "ERROR", False)]
    alarms.update("b", {"row a": Condition("WARN", "4 lost")}, 6.0)
    assert told() == [(4, "WARN", True), (5, "ERROR", False), (3, "WARN", False)]
    alarms.update("b", {"bridge": Condition("UNKNOWN", "quiet")}, 7.0, quiet=True)
    assert told()[:2] == [(6, "UNKNOWN", True), (4, "UNKNOWN", True)]
