"""Findings for services that show them beside the code: their places in the repository, and their whole texts."""

from __future__ import annotations

import os
from pathlib import Path

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.source_files import repository_top
from roverlink.reports.reported import Reported


def place_in_repository(span: Span, reported: Reported) -> Span | None:
    """Return a place with the path of its file from the top of the repository; None if no checked file has the place.

    A place in an earlier state, such as ``main:proto/imu.proto:3``, becomes the file of today, without a line.
    """
    folder = reported.sources.folder.resolve()
    top = Path(repository_top(str(folder)) or os.getcwd())
    earlier = os.path.relpath(top / span.file.partition(":")[2], folder)
    for place in (span, Span(earlier)):
        path = os.path.relpath(folder / place.file, top)
        exists = place.file in reported.sources.texts or (folder / place.file).is_file()
        if exists and not path.startswith(os.pardir):
            return Span(Path(path).as_posix(), place.line, place.column)
    return None


def main_place(finding: Diagnostic, reported: Reported) -> Span | None:
    """Return the place at which a service shows a finding; None if it is about no file that exists.

    If the file of the finding does not exist, but that of an earlier declaration does, this is that file.
    """
    places = [finding.span, *(Span(use.place.file) for use in finding.uses)]
    return next(filter(None, (place_in_repository(place, reported) for place in places)), None)


def whole_text(finding: Diagnostic, reported: Reported, with_related: bool) -> str:
    """Return the message of a finding, the declarations in question, and the help, in several lines.

    Related places are included if ``with_related`` is True, and otherwise only if they are in no file that exists.
    """
    files = reported.sources
    lines = [finding.message]
    lines += [line for use in finding.uses for line in use.text(files.file_of(use)) if line]
    for span, what in finding.also:
        if with_related or not place_in_repository(span, reported):
            lines.append(f"{files.from_here(span)}: {files.with_commit(span, what)}")
    return "\n".join([*lines, *([f"help: {finding.help}"] if finding.help else [])])


def related_places(finding: Diagnostic, reported: Reported) -> list[tuple[Span, str]]:
    """Return the places in files that exist today which have to do with a finding, each with a text."""
    files = reported.sources
    # The lines of an earlier commit are others today.
    earlier = [(Span(use.place.file), " ".join(line.strip() for line in use.declaration)) for use in finding.uses]
    today = [(span, files.with_commit(span, what)) for span, what in finding.also]
    found = ((place_in_repository(span, reported), what) for span, what in (*earlier, *today))
    return list(dict.fromkeys((place, what) for place, what in found if place))
