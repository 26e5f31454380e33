"""Output formats for findings (diagnostics): for people, scripts and CI servers."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roverlink.reports import github, json_report, junit, sarif
from roverlink.reports.reported import Reported


def _write_text(reported: Reported) -> None:
    from roverlink.reports import text  # here: the help of a command needs no rich

    text.write(reported)


FORMATS: Mapping[str, Callable[[Reported], None]] = {
    "text": _write_text,
    "json": json_report.write,
    "github": github.write,
    "sarif": sarif.write,
    "junit": junit.write,
}
"""Functions that write findings to standard output, by the format's name in the option ``--format``."""
