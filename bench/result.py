"""Result of a section: tables to print, charts to draw, and data for `--json`."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Group:
    """Rows of a table with their own heading."""

    heading: str
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True, slots=True)
class Table:
    """Table of texts; the first column names the row."""

    title: str
    columns: Sequence[str]
    groups: Sequence[Group]
    notes: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Curve:
    """Line of a chart; equal names have equal colours in all charts."""

    name: str
    x: Sequence[float]
    y: Sequence[float]


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves on logarithmic axes. `diagonal` draws y = x, the best possible result."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    diagonal: bool = False


@dataclass(frozen=True, slots=True)
class SectionResult:
    """One section of the report; `data` is JSON data."""

    tables: Sequence[Table]
    charts: Sequence[Chart] = ()
    data: dict[str, Any] = field(default_factory=dict)
