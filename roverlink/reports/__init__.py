"""What a lint found, in the forms in which people, scripts and CI read it."""

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
"""Each writes to standard output."""
