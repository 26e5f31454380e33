"""Conversion of a draft to the text of mapping.yaml; the reasons in the draft become comments."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roverlink.generator.adopt.draft import Draft, DraftRow
from roverlink.generator.table.edit import quoted, scalar

_WIDTH = 110


def text_of(draft: Draft) -> str:
    """Return the text of mapping.yaml for a draft."""
    parts = [_head(draft), _peers(draft), _messages(draft), _retired(draft), _lint(draft)]
    return "\n".join("\n".join(part) + "\n" for part in map(list, parts) if part)


def _head(draft: Draft) -> Iterator[str]:
    yield "# yaml-language-server: $schema=generated/mapping.schema.json"
    yield "#"
    yield "# One row for each message: its number, its topic, its peer and its direction."
    yield "# Drafted by `roverlink init`. Check the entries marked `guessed`, then remove the mark."
    yield "# After a change, run `roverlink generate`. Never change a number; move a removed message to `retired`."
    yield ""
    yield "version: 1"
    yield ""
    yield "proto:"
    yield f"  root: {scalar(draft.root)}"
    if draft.exclude:
        yield "  exclude:"
        for file, why in draft.exclude.items():
            yield from _commented(f"    - {scalar(file)}", why)
    yield ""
    yield "envelope:"
    yield f"  file: {scalar(draft.file)}"
    yield from _commented(f"  message: {scalar(draft.message)}", draft.oneof_doubt)
    yield f"  oneof: {scalar(draft.oneof)}"
    yield from _commented(f"  owner: {draft.owner}", draft.owner_reason)
    yield ""
    yield "ros:"
    yield f"  package: {scalar(draft.package)}"


def _peers(draft: Draft) -> Iterator[str]:
    yield "# Each peer listens on its own UDP port, at the address in the node's parameter dst_ip."
    yield "peers:"
    for index, peer in enumerate(sorted(draft.peers, key=lambda peer: peer.name)):
        prefixes = f"prefixes: [{', '.join(map(scalar, peer.prefixes))}], " if peer.prefixes else ""
        # Ports as the reader would choose them: from 6000 on, in the alphabetical order of the peers.
        yield f"  {peer.name}: {{{prefixes}port: {6000 + index}}}  # guessed"


def _messages(draft: Draft) -> Iterator[str]:
    yield "messages:"
    for row in draft.rows:
        yield from _row(row)


def _row(row: DraftRow) -> Iterator[str]:
    yield from (f"  # {line}".rstrip() for line in row.comment.splitlines())
    yield f"  - number: {row.number}"
    yield f"    name: {scalar(row.name)}"
    yield f"    proto: {scalar(row.proto)}"
    if row.ros:
        yield f"    ros: {scalar(row.ros)}"
    yield f"    topic: {scalar(row.name)}"
    yield from _commented(f"    direction: {row.direction}", f"guessed: {row.doubt}" if row.doubt else "")
    if row.fields:
        yield "    fields:"
        yield from (f"      {scalar(path)}: {scalar(name)}" for path, name in row.fields.items())
    if row.ignore:
        yield "    ignore:"
        for path, why in row.ignore.items():
            yield from _commented(f"      - {scalar(path)}", why)
    if row.lint:
        yield "    lint:"
        yield from _lowered(row.lint, "      ")


def _retired(draft: Draft) -> Iterator[str]:
    if draft.retired:
        yield "# Numbers that were used before, by git's history."
        yield "retired:"
        for row in draft.retired:
            entry = f"  - {{number: {row.number}, name: {scalar(row.name)}, proto: {scalar(row.proto)}}}"
            yield from _commented(entry, row.note)
    else:
        yield "retired: []"


def _lint(draft: Draft) -> Iterator[str]:
    if draft.lint:
        yield "# Rules that the tree broke when it was taken over. Remove a line to get its diagnostics back."
        yield "lint:"
        yield from _lowered(draft.lint, "  ")


def _lowered(rules: Mapping[str, str], margin: str) -> Iterator[str]:
    for rule, reason in sorted(rules.items()):
        yield f"{margin}{rule}: {{severity: hint, reason: {quoted(reason)}}}"


def _commented(line: str, comment: str) -> list[str]:
    """Return a line with a comment at its end. If this is too long, return two lines: the comment, then the line."""
    if not comment:
        return [line]
    comment = " ".join(comment.split())
    if len(line) + len(comment) < _WIDTH:
        return [f"{line}  # {comment}"]
    margin = " " * (len(line) - len(line.lstrip()))
    return [f"{margin}# {comment}", line]
