"""Screen of ``roverlink top``: the diagnostics of a bridge as a table on the terminal."""

from __future__ import annotations

from collections import Counter
from typing import Any, Literal

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray, DiagnosticStatus

LEVELS = ("OK", "WARN", "ERROR", "STALE")
_STYLES = {"OK": "green", "WARN": "yellow", "ERROR": "bold red", "STALE": "magenta"}
_DROPPED = "dropped."
_MISMATCHES = "qos_mismatches."
_COLUMNS: tuple[tuple[str, int | None, Literal["left", "right"]], ...] = (
    ("no.", 3, "right"),
    ("row", None, "left"),
    ("direction", None, "left"),
    ("", 5, "left"),
    ("rate", 8, "right"),
    ("of", 4, "right"),
    ("age", 6, "right"),
    ("count", 7, "right"),
    ("dropped", 7, "right"),
)
_TEXTS = ("fingerprint", "topic", "direction", "recording")


def page_of(array: DiagnosticArray, node: str) -> dict[str, Any] | None:
    """Return the state of one bridge from its diagnostics; None if the diagnostics are not those of the node ``node``.

    Values that are numbers are converted to numbers.
    """
    own = next((status for status in array.status if status.name == node), None)
    if own is None:
        return None
    prefix = f"{node}: "
    return {
        "stamp": array.header.stamp.sec + array.header.stamp.nanosec / 1e9,
        "node": _entry(own, node),
        "rows": [
            _entry(status, status.name.removeprefix(prefix))
            for status in array.status
            if status.name.startswith(prefix)
        ],
    }


def _entry(status: DiagnosticStatus, name: str) -> dict[str, Any]:
    level = LEVELS[status.level] if status.level < len(LEVELS) else str(status.level)
    values = {pair.key: pair.value if pair.key in _TEXTS else _number(pair.value) for pair in status.values}
    return {"name": name, "level": level, "message": status.message, "peer": status.hardware_id, **values}


def _number(text: str) -> Any:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def has_problems(page: dict[str, Any]) -> bool:
    """Return true if the bridge or one of its rows has another level than OK."""
    return any(entry["level"] != "OK" for entry in (page["node"], *page["rows"]))


def render(page: dict[str, Any], quiet: bool = False) -> RenderableType:
    """Return the screen for a state; ``quiet`` is true if the bridge has not published its state for a while."""
    node = page["node"]
    title = Text.assemble(
        (str(node["name"]), "bold"),
        "  ",
        (node["level"], _STYLES.get(node["level"], "")),
        f"  {node['message']}",
        *([("  no messages any more", "bold red")] if quiet else []),
    )
    return Group(title, *map(Text, [*_node_lines(node), _levels_line(page["rows"])]), _table(page["rows"]))


def _levels_line(rows: list[dict[str, Any]]) -> str:
    counts = Counter(row["level"] for row in rows)
    return "rows: " + ", ".join(f"{counts[level]} {level}" for level in LEVELS if counts[level])


def _node_lines(node: dict[str, Any]) -> list[str]:
    lines = [
        f"received {node['received']} ({node['received_rate']:.1f}/s), forwarded {_named(node, 'forwarded.')}, "
        f"not sent {_named(node, 'unsent.')}",
        f"dropped {_named(node, _DROPPED)}; by the kernel {node['kernel_drops']}",
        f"socket {_share(node['socket_waiting_bytes'], node['socket_size_bytes'])}, handling p50 "
        f"{_microseconds(node.get('handling_p50_us'))}, p99 {_microseconds(node.get('handling_p99_us'))}",
    ]
    if mismatches := _named(node, _MISMATCHES, none=""):
        lines.append(f"publishers and subscriptions of other nodes without matching QoS: {mismatches}")
    if "recording" in node:
        lines.append(
            f"recording {node['recording']}: {node['recording_bytes'] / 1e6:.1f} MB, "
            f"{node['recording_waiting']} waiting, {node['recording_lost']} lost"
        )
    return lines


def _named(entry: dict[str, Any], prefix: str, none: str = "none") -> str:
    parts = [f"{key.removeprefix(prefix)} {value}" for key, value in entry.items() if key.startswith(prefix) and value]
    return ", ".join(parts) or none


def _share(waiting: int, size: int) -> str:
    return f"{100 * waiting / size:.0f}% full" if size else "-"


def _microseconds(value: float | None) -> str:
    return "-" if value is None else f"under {value} us"


def _table(rows: list[dict[str, Any]]) -> Table:
    table = Table(expand=True, box=None, pad_edge=False, header_style="bold")
    for name, least, justify in _COLUMNS:
        table.add_column(name, justify=justify, min_width=least, no_wrap=True, overflow="ellipsis")
    table.add_column("", ratio=1, no_wrap=True, overflow="ellipsis")
    for row in rows:
        dropped = sum(value for key, value in row.items() if key.startswith(_DROPPED))
        table.add_row(
            str(row["number"]),
            row["name"],
            row["direction"].replace("_to_", "→"),
            Text(row["level"], _STYLES.get(row["level"], "")),
            f"{row['rate']:.1f}/s",
            f"{row['expect_rate']:g}" if "expect_rate" in row else "",
            f"{row['age']:.1f} s" if "age" in row else "",
            str(row["count"]),
            str(dropped) if dropped else "",
            row["message"],
            style="" if row["count"] or dropped else "dim",
        )
    return table
