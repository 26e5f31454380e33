"""Output formats for the findings (diagnostics) of `roverlink lint`: for people, scripts and CI servers."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roverlink.generator.lint.project import Linted
from roverlink.reports import github, json_report, junit, sarif, text

FORMATS: Mapping[str, Callable[[Linted], None]] = {
    "text": text.write,
    "json": json_report.write,
    "github": github.write,
    "sarif": sarif.write,
    "junit": junit.write,
}
"""Functions that write findings to standard output, by the format's name in the option ``--format``."""
