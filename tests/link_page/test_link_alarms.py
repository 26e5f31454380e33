"""What `top` and the page judge: which peers and boards are alive, what is the worst, and which alarms there are."""

from __future__ import annotations

from collections.abc import Sequence
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


_REST = {"deadman_after": 0.5, "stops": 3, "stopping": 1}
_TO_ARM = _row("Arm", 0.1, "ros_to_hardware")


def _link(**values: Any) -> dict[str, Any]:
    return {"peer": "hardware", "board": "Arm", "level": "OK", "message": "", **values}


def _end(board: str, link: str) -> dict[str, Any]:
    return {"peer": "hardware", "board": board, "link": link, "address": ""}


def _state(
    rows: list[dict[str, Any]], links: Sequence[dict[str, Any]], ends: Sequence[dict[str, Any]], level: str
) -> dict[str, Any]:
    rows, peers = [dict(row) for row in rows], peers_of({}, rows, ends, links)
    judge_rows(rows, peers)
    node = {"level": level, "message": "12 lost" if level != "OK" else "nothing lost"}
    return {"quiet": False, "node": node, "peers": peers, "rows": rows}


@pytest.mark.parametrize(
    ("rows", "links", "ends", "level", "subjects", "worst", "verdicts"),
    [
        ([_row("Arm", 1.0)], [], [], "OK", [], "OK: nothing lost", "OK"),
        ([_row("Arm", 1.0)], [], [], "WARN", ["bridge"], "WARN: 12 lost", "OK"),
        ([_row("Arm", None, count=0)], [], [], "OK", [], "WAITING: no message yet from hardware", "IDLE"),
        ([_row("Arm", None, count=0), _row("", 1.0)], [], [], "OK", [], "WAITING: no message yet from Arm", "IDLE OK"),
        # Of equally bad parts, the first one is shown; nothing of a silent peer or board is OK.
        (
            [_row("Arm", 5.0), _row("Drive", 1.0)],
            [],
            [],
            "OK",
            ["board Arm of hardware"],
            "ERROR: Arm is silent",
            "SILENT OK",
        ),
        (
            [_row("Arm", 60.0), _row("Drive", 5.0)],
            [],
            [],
            "OK",
            ["peer hardware", "board Arm of hardware"],
            "ERROR: hardware is silent",
            "SILENT SILENT",
        ),
        ([_row("Arm", 3.5), _row("Drive", 2.9)], [], [], "OK", [], "OK", "SILENT OK"),
        (
            [_row("Arm", 4.5), _TO_ARM],
            [],
            [],
            "WARN",
            ["bridge", "peer hardware"],
            "ERROR: hardware is silent: no message for 4 s",
            "SILENT SILENT",
        ),
        # The stop of the start is no alarm; that of a command that is missing is one.
        ([_row("", None, "ros_to_hardware", **_REST, count=0)], [], [], "OK", [], "OK", "REST"),
        (
            [_row("", 7.0, "ros_to_hardware", **_REST)],
            [],
            [],
            "OK",
            ["stop  ros_to_hardware"],
            "ERROR: no command  ros_to_hardware for 7 s: the bridge tells hardware to stop",
            "STOP",
        ),
        (
            [_row("Arm", 1.0, level="STALE", message="silent")],
            [],
            [],
            "OK",
            ["row Arm hardware_to_ros"],
            "SILENT: Arm hardware_to_ros: silent",
            "SILENT",
        ),
        (
            [_row("Arm", 1.0)],
            [_link(differing="Arm hardware_to_ros", level="WARN")],
            [],
            "OK",
            ["schema Arm of hardware"],
            "WARN: Arm runs other protos: Arm hardware_to_ros may be misread",
            "WARN",
        ),
        ([_row("Arm", 1.0)], [_link(loss_in=0.02, loss_out=0.1)], [], "OK", [], "OK", "OK"),
        (
            [_row("Arm", 1.0)],
            [_link(loss_in=0.02, loss_out=0.2)],
            [],
            "OK",
            ["loss Arm of hardware"],
            "WARN: Arm loses 20 %",
            "WARN",
        ),
        (
            [_row("Arm", 1.0)],
            [_link(loss_in=0.61)],
            [],
            "WARN",
            ["bridge", "loss Arm of hardware"],
            "ERROR: Arm loses 61 %",
            "WARN",
        ),
        (
            [_row("Arm", 1.0)],
            [],
            [_end("Arm", "not_resolved")],
            "OK",
            ["link Arm of hardware"],
            "WARN: Arm gets no commands: its host cannot be resolved",
            "OK",
        ),
        ([_row("Arm", 1.0)], [], [_end("Arm", "not_learned")], "OK", [], "OK", "OK"),
        (
            [_row("Arm", 1.0)],
            [],
            [_end("Lid", "unreachable")],
            "OK",
            ["link Lid of hardware"],
            "ERROR: Lid gets no commands",
            "OK",
        ),
    ],
)
def test_the_worst_of_all_parts_is_told(
    rows: list[dict[str, Any]],
    links: list[dict[str, Any]],
    ends: list[dict[str, Any]],
    level: str,
    subjects: list[str],
    worst: str,
    verdicts: str,
) -> None:
    """What is wrong, the worst of it, and the verdicts of the rows; of a quiet bridge, nothing is known.

    A silent board is an alarm while the rest speaks; boards that fall silent together are one alarm, that of the peer.
    """
    state = _state(rows, links, ends, level)
    found, told = conditions_of(state), worst_of(state)
    assert list(found) == subjects
    assert f"{told.level}: {told.text}".startswith(worst)
    assert " ".join(row["verdict"] for row in state["rows"]) == verdicts
    assert all(condition.advice for condition in found.values())
    quiet = old(state)
    assert (list(conditions_of(quiet)), worst_of(quiet).level) == (["bridge"], "UNKNOWN")
    assert {row["verdict"] for row in quiet["rows"]} == {peer["state"] for peer in quiet["peers"]} == {"UNKNOWN"}


def test_the_address_stands_at_its_board() -> None:
    """Each board has the state of its address and the result of its link messages; a peer may only have an address."""
    rows, radio = [_row("Arm", 1.0)], {"peer": "radio", "link": "ok", "address": "239.0.0.7:6000"}
    found = peers_of({}, rows, [_end("Arm", "not_resolved"), radio], [_link(schema="same")])
    (arm,) = found[0]["boards"]
    assert (arm["link"], arm["report"]["schema"], "report" in found[0]) == ("not_resolved", "same", False)
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
