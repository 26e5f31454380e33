"""Output of results: tables on a terminal, charts in a PNG, everything as JSON."""

import json
import os
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table as RichTable

from bench.result import Chart, SectionResult, Table

PICTURE_COLUMNS = 2
PANEL_INCHES = (6.0, 3.6)
COLOURS = {
    "floor": "tab:gray",
    "cpp": "tab:blue",
    "handwritten": "tab:orange",
    "roverlink": "tab:green",
    "python": "tab:olive",
    "rclpy": "tab:purple",
    "rclpy-python": "tab:pink",
    "OpenCV": "tab:blue",
    "OpenCV SUBPIX": "tab:orange",
    "OpenCV APRILTAG": "tab:red",
}
PACKAGES = ("cyclonedds", "numpy", "opencv-contrib-python-headless", "protobuf", "roverlink")
DEFAULT_BUFFER = Path("/proc/sys/net/core/rmem_default")


def machine() -> dict[str, Any]:
    """Return facts about the machine. Numbers can be compared within a run, but hardly across machines."""
    return {
        "cores": len(os.sched_getaffinity(0)),
        "processor": platform.processor() or platform.machine(),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "default_receive_buffer": int(DEFAULT_BUFFER.read_text(encoding="ascii")),
        "packages": {name: found for name in PACKAGES if (found := _version(name))},
    }


def report(
    results: Mapping[str, SectionResult], json_file: Path | None, notes: Sequence[str] = (), width: int = 110
) -> None:
    """Print all tables, and write the measurements to ``json_file`` if it is given.

    ``width`` is the number of columns if the output is not a terminal.
    """
    console = Console()
    _print_results(results, notes, console if console.is_terminal else Console(width=width))
    if json_file:
        _write_json(json_file, results, notes)


def _print_results(results: Mapping[str, SectionResult], notes: Sequence[str], console: Console) -> None:
    """Print every table, and the notes about missing parts."""
    facts = machine()
    packages = ", ".join(f"{name} {found}" for name, found in facts["packages"].items())
    console.print(f"{facts['cores']} cores, {facts['system']}, Python {facts['python']}, {packages}", highlight=False)
    for result in results.values():
        for table in result.tables:
            _print_table(table, console)
    for note in notes:
        console.print(f"note: {note}", highlight=False, markup=False)


def _write_json(path: Path, results: Mapping[str, SectionResult], notes: Sequence[str]) -> None:
    """Write machine, notes and the data of all sections."""
    sections = {name: result.data for name, result in results.items()}
    report = {"machine": machine(), "notes": list(notes), "sections": sections}
    path.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")


def draw(path: Path, results: Mapping[str, SectionResult]) -> str:
    """Draw all charts into one PNG; return a message with its path, or with the reason why there is none."""
    charts = [chart for result in results.values() for chart in result.charts if chart.curves]
    if not charts:
        return "no charts: nothing to draw"
    try:  # imported here: the import takes a second
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        return "no charts: matplotlib is not installed; `make bench` installs it"

    rows = -(-len(charts) // PICTURE_COLUMNS)
    width, height = PANEL_INCHES
    figure = Figure(figsize=(width * PICTURE_COLUMNS, height * rows), layout="constrained")
    FigureCanvasAgg(figure)
    for place, chart in enumerate(charts, 1):
        _draw_chart(figure.add_subplot(rows, PICTURE_COLUMNS, place), chart)
    figure.savefig(path, dpi=110)
    return f"charts: {path}"


def _draw_chart(axes: Any, chart: Chart) -> None:
    for curve in chart.curves:
        axes.plot(curve.x, curve.y, marker=".", label=curve.name, color=COLOURS.get(curve.name))
    if chart.diagonal:
        ends = [min(min(curve.x) for curve in chart.curves), max(max(curve.x) for curve in chart.curves)]
        axes.plot(ends, ends, linestyle=":", color="black", linewidth=0.8, label="no loss")
    axes.set(title=chart.title, xlabel=chart.x_label, ylabel=chart.y_label, xscale="log", yscale="log")
    axes.grid(visible=True, which="major", alpha=0.3)
    axes.legend(fontsize="small")


def _print_table(table: Table, console: Console) -> None:
    console.rule(table.title, align="left", characters="=")
    widths = [_width(table, place) for place in range(len(table.columns))]
    for group in table.groups:
        grid = RichTable(title=group.heading, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)
        for place, (column, width) in enumerate(zip(table.columns, widths, strict=True)):
            grid.add_column(column, justify="right" if place else "left", min_width=width)
        for row in group.rows:
            grid.add_row(*row)
        console.print(grid)
    for note in table.notes:
        console.print(note, style="dim", highlight=False, markup=False)


def _width(table: Table, place: int) -> int:
    """Return the width of a column over all groups, so that their separate grids align."""
    cells = [*table.columns[place].splitlines(), *(row[place] for group in table.groups for row in group.rows)]
    return max(len(cell) for cell in cells)


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None
