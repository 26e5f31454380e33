"""Screen of ``roverlink top``: the states of bridges as tables on the terminal, and what the user selects with keys."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.text import Text

from roverlink.heard_bridges import DROPPED, QUIET_S, HeardBridge, HeardBridges, full_name, instance, place
from roverlink.link_judgement import Condition, badness, conditions_of, worst_of
from roverlink.numerals import counted

_STYLES = {"OK": "green", "WARN": "yellow", "SILENT": "bold red", "ERROR": "bold red", "STOP": "bold red"}
_STYLES |= {"UNKNOWN": "reverse"}
_CALM = ("OK", "IDLE", "REST")
"""Verdicts of rows that are no problem."""
_PANEL = 70  # least width of a bridge beside others
_GAP = 3  # between two bridges
_LEAST_ROWS = 11  # rows of the table that the lines above it must leave on a low screen
_DETAILS = 2  # lines about the selected row
_LEAST_MESSAGE = 12
_LEAST_NAME = 12


@dataclass
class View:
    """Selection that the user has made with keys: the row, the order and the filter of the rows, and the bridge."""

    sort: str = "number"
    """Key of `SORTS`."""
    filter: str = ""
    """Text that the shown rows contain."""
    typing: bool = False
    """True while the user types the filter."""
    problems: bool = False
    """True if only rows with a problem are shown: with a verdict that is none of `_CALM`, or with drops."""
    bridge: int = 0
    """Index of the bridge to which the keys apply."""
    row: str = ""
    """Name of the selected row; empty for the first one."""
    _first: dict[str, int] = field(default_factory=dict)
    _page_rows: int = 10

    def press(self, key: str, states: Sequence[dict[str, Any]]) -> bool:
        """Carry out a key of `Keyboard.keys`, given the states of all bridges; return false if it ends the program."""
        if self.typing:
            self._type(key)
        elif key in ("q", "Q"):
            return False
        elif key == "/":
            self.typing = True
        elif key == "escape":
            self.filter, self.problems = "", False
        elif key in ("s", "S"):
            names = list(SORTS)
            self.sort = names[(names.index(self.sort) + (1 if key == "s" else -1)) % len(names)]
        elif key == "p":
            self.problems = not self.problems
        elif key in ("tab", "back tab"):
            self.bridge = (self.bridge + (1 if key == "tab" else -1)) % len(states)
        else:
            self._move(key, self.rows(states[min(self.bridge, len(states) - 1)]))
        return True

    def _type(self, key: str) -> None:
        if key in ("enter", "escape"):
            self.typing = False
            if key == "escape":
                self.filter = ""
        elif key == "backspace":
            self.filter = self.filter[:-1]
        elif len(key) == 1:
            self.filter += key

    def _move(self, key: str, rows: Sequence[dict[str, Any]]) -> None:
        steps = {"up": -1, "k": -1, "down": 1, "j": 1, "page up": -self._page_rows, "page down": self._page_rows}
        steps |= {"home": -len(rows), "g": -len(rows), "end": len(rows), "G": len(rows)}
        if key in steps and rows:
            self.row = rows[min(max(self._index(rows) + steps[key], 0), len(rows) - 1)]["name"]

    def _index(self, rows: Sequence[dict[str, Any]]) -> int:
        return next((index for index, row in enumerate(rows) if row["name"] == self.row), 0)

    def rows(self, state: dict[str, Any]) -> list[dict[str, Any]]:
        """Return the rows of a state that the filter lets pass, in the order that the user has selected."""
        wanted = self.filter.lower()
        rows = [
            row
            for row in state["rows"]
            if wanted in f"{row['name']} {row['topic']} {row['direction']} {row['verdict']}".lower()
            and (not self.problems or row["verdict"] not in _CALM or _dropped(row))
        ]
        return sorted(rows, key=SORTS[self.sort])

    def window(self, bridge: str, rows: Sequence[dict[str, Any]], height: int) -> tuple[int, int]:
        """Return the indices of the first shown row and of the selected row, if ``height`` rows fit.

        ``bridge`` identifies the bridge: each bridge is scrolled on its own.
        """
        self._page_rows, selected = height, self._index(rows)
        first = min(self._first.get(bridge, 0), max(len(rows) - height, 0))
        self._first[bridge] = first = min(max(first, selected - height + 1), selected)
        return first, selected


def _dropped(entry: dict[str, Any]) -> int:
    return sum(value for key, value in entry.items() if key.startswith(DROPPED))


SORTS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "number": lambda row: row["number"],
    "name": lambda row: row["name"],
    "level": lambda row: (-badness(row["verdict"]), row["number"]),
    "rate": lambda row: (-row["rate"], row["number"]),
    "age": lambda row: (-row.get("age", math.inf), row["number"]),
    "dropped": lambda row: (-_dropped(row), row["number"]),
}
"""Orders of the rows: the key of each for the function ``sorted``."""


def printed(bridges: Sequence[HeardBridge], width: int) -> RenderableType:
    """Return the states of bridges as text to print, one below the other, with all rows."""
    lines: list[Text] = []
    for bridge in bridges:
        lines += [Text()] if lines else []
        lines += [*_header(bridge.state, _label(bridge, bridges), width), *_table(bridge.state["rows"], width)]
    return Text("\n").join(lines)


def live(bridges: Sequence[HeardBridge], heard: HeardBridges, view: View, width: int, height: int) -> RenderableType:
    """Return the screen of ``width`` x ``height`` characters that shows bridges, side by side if they fit.

    If they do not all fit side by side, the screen shows the bridge to which the keys apply, and the ones after it.
    """
    top = [_fitted(Text(text, "bold red"), width) for text in heard.warnings()]
    if len(bridges) > 1:
        top.append(_fitted(_overview(bridges, heard, view), width))
    shown = max(1, min(len(bridges), (width + _GAP) // (_PANEL + _GAP)))
    first = min(view.bridge, len(bridges) - shown)
    panel_height = max(height - len(top) - 1, 1)
    panel_width = (width - _GAP * (shown - 1)) // shown
    panels = [
        _panel(heard.state_now(bridge), _label(bridge, bridges), view, panel_width, panel_height)
        for bridge in bridges[first : first + shown]
    ]
    lines = [Text(" | ").join(parts) for parts in zip(*panels)]
    return Text("\n", no_wrap=True).join([*top, *lines, _fitted(_keys_line(view, len(bridges)), width)][-height:])


def _fitted(text: Text, width: int) -> Text:
    """Return a line with exactly ``width`` characters: cut with an ellipsis, or filled with spaces."""
    text.truncate(width, overflow="ellipsis", pad=True)
    return text


def _plain(text: object) -> str:
    """Return a text without control characters: a name comes from the network, and must not command the terminal."""
    return "".join(character if character.isprintable() else "?" for character in str(text))


def _label(bridge: HeardBridge, bridges: Sequence[HeardBridge]) -> str:
    """Return the name of a bridge, with the place where it runs if others have the same name."""
    name = full_name(bridge.state)
    alone = all(full_name(other.state) != name for other in bridges if other is not bridge)
    return _plain(name if alone else f"{name} ({place(bridge.state)})")


def _level(condition: Condition) -> tuple[str, str]:
    return condition.level, _STYLES.get(condition.level, "")


def _overview(bridges: Sequence[HeardBridge], heard: HeardBridges, view: View) -> Text:
    """Return the line that lists all bridges, the selected one first. It begins with the number of each level."""
    order = [*range(view.bridge, len(bridges)), *range(view.bridge)]
    worst = [worst_of(heard.state_now(bridge)) for bridge in bridges]
    parts = [Text(f"bridges: {_levels(condition.level for condition in worst)}")]
    for index in order:
        node = bridges[index].state["node"]
        name = _label(bridges[index], bridges)
        parts.append(Text.assemble((name, "bold reverse" if index == view.bridge else ""), " ", _level(worst[index])))
        parts[-1].append(f" dropped {_dropped(node) + node['kernel_drops']}")
    return Text("  ").join(parts)


def _keys_line(view: View, bridges: int) -> Text:
    if view.typing:
        return Text.assemble(("filter: ", "bold"), view.filter, ("_", "blink"), "   Enter keeps it, Esc clears it")
    parts = ["up/down", f"s sort: {view.sort}", f"/ filter{': ' + view.filter if view.filter else ''}"]
    parts += ["p all rows" if view.problems else "p problems", *(["Tab bridge"] if bridges > 1 else []), "q quit"]
    return Text("  ".join(parts), "reverse")


def _panel(state: dict[str, Any], label: str, view: View, width: int, height: int) -> list[Text]:
    """Return the lines that show one bridge, ``height`` in number."""
    rows = view.rows(state)
    header = _header(state, label, width)[: max(height - _LEAST_ROWS - _DETAILS - 1, 2)]
    space = max(height - len(header) - _DETAILS - 1, 1)
    first, selected = view.window(instance(state), rows, space)
    table = _table(rows, width, first, first + space, selected)
    if not rows:
        table.append(Text("no row matches; Esc shows all rows"))
    lines = [*header, *table]
    lines += [Text()] * (height - _DETAILS - len(lines))
    details = _details(rows[selected], f"row {selected + 1} of {len(rows)}") if rows else [Text()] * _DETAILS
    # Cut at the end on a screen that is too low for anything but the title and a few rows.
    return [_fitted(line, width) for line in [*lines, *details][:height]]


def _details(row: dict[str, Any], position: str) -> list[Text]:
    """Return the lines about the selected row, whose columns may be hidden or cut."""
    facts = [position, row["name"], f"topic {row['topic']}", _direction(row), f"count {row['count']}"]
    drops = _named(row, DROPPED, none="")
    told = [f"dropped: {drops}"] if drops else []
    return [
        Text(_plain("  ".join(facts)), "dim"),
        Text(_plain("; ".join(filter(None, [*told, row["reason"]])) or "nothing to report")),
    ]


def _header(state: dict[str, Any], label: str, width: int) -> list[Text]:
    """Return the lines about the bridge as a whole, the most important ones first."""
    node = state["node"]
    lines = [line for text in _faults(state, label) for line in text.wrap(Console(), width)]
    reasons = _named(node, DROPPED, none="")
    drops = f"datagrams dropped: {_dropped(node)}; by the kernel: {node['kernel_drops']}"
    lines.append(Text(_plain(drops + (f"; reasons: {reasons}" if reasons else ""))))
    if resting := ", ".join(row for peer in state["peers"] for row in peer["resting"]):
        lines.append(Text(_plain(f"at rest, no command yet: {resting}"), "dim"))
    lines += [
        Text(_plain("; ".join([f"{link['name']}: {link['message']}", *_link_facts(link)]))) for link in state["links"]
    ]
    if "recording" in node:
        size, waiting, lost = (node.get(f"recording_{name}", 0) for name in ("bytes", "waiting", "lost"))
        recording = (
            f"recording: {counted(lost, 'message')} lost, {waiting} waiting for the disk, {size / 1e6:.1f} MB in "
        )
        lines.append(Text(_plain(recording + node["recording"])))
    received = f"datagrams received: {node['received']} ({node['received_rate']:.1f}/s)"
    sent = f"forwarded: {_named(node, 'forwarded.')}; send errors: {_named(node, 'unsent.')}"
    for text in ("undelivered", "damaged", "withheld"):
        sent += f"; {text}: {counts}" if (counts := _named(node, f"{text}.", none="")) else ""
    buffer = _share(node["socket_waiting_bytes"], node["socket_size_bytes"])
    p50, p99 = _microseconds(node.get("handling_p50_us")), _microseconds(node.get("handling_p99_us"))
    lines.append(Text(_plain(f"rows: {_levels(row['verdict'] for row in state['rows'])}; {received}")))
    lines.append(Text(_plain(sent)))
    lines += [Text(_plain(f"{peer['name']}: {peer['budget_text']}")) for peer in state["peers"] if peer["budget_text"]]
    lines.append(Text(f"receive buffer: {buffer}; time to handle datagrams: p50 {p50}, p99 {p99}"))
    return lines


def _faults(state: dict[str, Any], label: str) -> Iterator[Text]:
    """Yield the worst condition with what to do, and the other conditions that the table of rows does not show."""
    worst = worst_of(state)
    yield Text.assemble((label, "bold"), "  ", _level(worst), f"  {_plain(worst.text)}")
    if worst.advice:
        yield Text(_plain(worst.advice), "bold")
    others = [one for subject, one in conditions_of(state).items() if one != worst and not subject.startswith("row ")]
    for condition in sorted(others, key=lambda one: -badness(one.level)):
        yield Text.assemble(_level(condition), f"  {_plain(condition.text)}")


def _link_facts(link: dict[str, Any]) -> list[str]:
    """Return what the link messages of an end have measured."""
    losses = [f"{way} {100 * link[key]:.1f}%" for way, key in (("in", "loss_in"), ("out", "loss_out")) if key in link]
    facts = [f"loss {', '.join(losses)}"] if losses else []
    facts += [f"{name} {_time(link[key])}" for name, key in _LINK_TIMES if key in link]
    facts += [f"{link['reordered']} reordered"] if link.get("reordered") else []
    facts += [counted(link[f"{one}s"], one) for one in ("duplicate", "restart") if link.get(f"{one}s")]
    facts += [f"{link['senders']} senders"] if link["senders"] > 1 else []
    return facts + ([f"last link message {link['age']:.0f} s ago"] if link.get("age", 0) > QUIET_S else [])


def _time(seconds: float) -> str:
    if seconds < _NOT_SET_S:
        return "not set"
    return f"{1000 * seconds:.1f} ms" if abs(seconds) < 10 else f"{seconds:.0f} s"


_LINK_TIMES = (("round trip", "round_trip"), ("jitter", "jitter"), ("clock", "clock_offset"))
_NOT_SET_S = -1e9  # the clock of a board without a date counts from its start


def _levels(levels: Iterable[str]) -> str:
    counts = Counter(levels)
    return ", ".join(f"{counts[level]} {level}" for level in sorted(counts, key=badness, reverse=True)) or "none"


def _named(entry: dict[str, Any], prefix: str, none: str = "none") -> str:
    parts = [f"{key.removeprefix(prefix)} {value}" for key, value in entry.items() if key.startswith(prefix) and value]
    return ", ".join(parts) or none


def _share(waiting: int, size: int) -> str:
    return f"{100 * waiting / size:.0f}% full" if size else "-"


def _microseconds(value: float | None) -> str:
    return "-" if value is None else f"under {value} us"


def _direction(row: dict[str, Any]) -> str:
    return str(row["direction"]).replace("_to_", "→")


def _age(row: dict[str, Any]) -> str:
    if "age" not in row:
        return ""
    age = row["age"]
    return f"{age:.1f} s" if age < 600 else f"{age / 60:.0f} min" if age < 6000 else f"{age / 3600:.1f} h"


class _Column(NamedTuple):
    title: str
    cell: Callable[[dict[str, Any]], str]
    right: bool = False
    least: int = 0
    """Smallest width in characters, so that a column does not jump while its numbers grow."""


_COLUMNS = (
    _Column("no.", lambda row: str(row["number"]), True, 3),
    _Column("row", lambda row: str(row["name"])),
    _Column("direction", _direction),
    _Column("level", lambda row: str(row["verdict"]), False, 6),
    _Column("rate", lambda row: f"{row['rate']:.1f}/s", True, 8),
    _Column("min", lambda row: f"{row['expect_rate']:g}" if "expect_rate" in row else "", True, 4),
    _Column("age", _age, True, 6),
    _Column("count", lambda row: str(row["count"]), True, 7),
    _Column("dropped", lambda row: str(_dropped(row) or ""), True, 7),
    _Column("stops", lambda row: str(row.get("stops", "")), True, 5),
    _Column("message", lambda row: str(row["reason"])),
)
_HIDDEN_FIRST = ("message", "min", "direction", "count", "no.", "age")
"""Columns that a narrow screen does not show, in this order. The others are always shown."""


def _table(
    rows: Sequence[dict[str, Any]], width: int, first: int = 0, end: int | None = None, selected: int | None = None
) -> list[Text]:
    """Return the table as lines: the titles, and the rows from the index ``first`` to ``end`` (not included).

    The columns have the widths that all rows need, so they do not jump when the user scrolls.
    """
    columns = {column.title: column for column in _COLUMNS}
    if not any("stops" in row for row in rows):
        del columns["stops"]
    cells = {title: [_plain(column.cell(row)) for row in rows] for title, column in columns.items()}
    widths = {title: max([column.least, len(title), *map(cell_len, cells[title])]) for title, column in columns.items()}
    widths["message"] = _LEAST_MESSAGE
    for title in _HIDDEN_FIRST:
        if _width(widths) > width:
            del widths[title]
    if "message" in widths:
        widths["message"] += width - _width(widths)
    elif (missing := _width(widths) - width) > 0:
        widths["row"] = max(widths["row"] - missing, _LEAST_NAME)

    def line(texts: Mapping[str, str], style: str, level: str = "") -> Text:
        parts = []
        for title, size in widths.items():
            part = Text(texts[title], _STYLES.get(level, "") if title == "level" else "")
            part.truncate(size, overflow="ellipsis")
            part.align("right" if columns[title].right else "left", size)
            parts.append(part)
        whole = Text("  ").join(parts)
        whole.stylize_before(style)
        return whole

    lines = [line({title: title for title in widths}, "bold")]
    for index in range(first, min(len(rows), len(rows) if end is None else end)):
        row = rows[index]
        style = "reverse" if index == selected else "" if row["count"] or _dropped(row) or row.get("stops") else "dim"
        lines.append(line({title: cells[title][index] for title in widths}, style, row["verdict"]))
    return lines


def _width(widths: Mapping[str, int]) -> int:
    return sum(widths.values()) + 2 * (len(widths) - 1)
