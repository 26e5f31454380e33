"""What a section of the bench hands back: tables to print, charts to draw, data for `--json`."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Group:
    """Rows of a table under a heading of their own."""

    heading: str
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True, slots=True)
class Table:
    """A table of ready-made texts; the first column names the row."""

    title: str
    columns: Sequence[str]
    groups: Sequence[Group]
    notes: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Curve:
    """One line of a chart; equal names get equal colours in every chart."""

    name: str
    x: Sequence[float]
    y: Sequence[float]


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over logarithmic axes. `diagonal` draws y = x, where y cannot do better."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    diagonal: bool = False


@dataclass(frozen=True, slots=True)
class SectionResult:
    """One section of the report; `data` is whatever JSON can hold."""

    tables: Sequence[Table]
    charts: Sequence[Chart] = ()
    data: dict[str, Any] = field(default_factory=dict)
