"""Output formats for findings (diagnostics): for people, scripts and CI servers."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roverlink.reports import github, json_report, junit, sarif, text
from roverlink.reports.reported import Reported
from roverlink.reports.text import NO_PROBLEMS

__all__ = ["FORMATS", "NO_PROBLEMS"]

FORMATS: Mapping[str, Callable[[Reported], None]] = {
    "text": text.write,
    "json": json_report.write,
    "github": github.write,
    "sarif": sarif.write,
    "junit": junit.write,
}
"""Functions that write findings to standard output, by the format's name in the option ``--format``."""
