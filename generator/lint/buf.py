"""Comparison of two states with the program buf (``buf breaking``).

buf also finds changes that break generated source code or JSON, which our own rules do not check. buf gets both states
as descriptor sets of protoc, and its whole configuration on the command line. So it needs no network and no buf.yaml,
and works with any earlier state. We use buf's category FILE of rules, which contains the rules of all other categories
or stricter ones. Results that our own rules about bytes and the envelope already report are dropped.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Rule, Severity, Span, shown
from roverlink.generator.protos.schema import ProtoEnum, ProtoMessage, Schema


class BufNotInstalled(Rule, id="BUF101", severity=Severity.FATAL):
    """`lint --with-buf` needs buf, which is not installed.

    The lint looks for buf beside the running Python interpreter, then on the PATH. Without buf nothing is linted,
    because the result could be mistaken for a complete one.

    Bad::

        $ roverlink lint --against origin/main --with-buf     # buf is not installed

    Good::

        $ pip install buf-bin
        $ roverlink lint --against origin/main --with-buf
    """


class BufFailed(Rule, id="BUF102", severity=Severity.FATAL):
    """buf cannot be run, or failed to compare the two states.

    buf rejects some files that protoc accepts, such as message sets. The lint's own results are still shown.

    Bad::

        $ roverlink lint --against origin/main --with-buf     # old.proto declares a message set

    Good::

        $ roverlink lint --against origin/main     # without --with-buf
    """


_OPTION = Span("--with-buf")
_VIOLATIONS = 100  # the exit code of a comparison that found something
_OURS = ("ENV", "WIR")
_RULE = re.compile("[A-Z]+(_[A-Z0-9]+)+")
_TYPE = re.compile(r'\b(?:message|enum) "([\w.]+)"', re.IGNORECASE)
_NUMBER = re.compile(r'(?:missing values: \[|")(-?\d+)')


@cache
def rule(id: str) -> type[Rule] | None:
    """Return the `Rule` for a rule of buf, such as ``FIELD_NO_DELETE``; None if ``id`` has another form."""
    if not _RULE.fullmatch(id):
        return None

    class BufBreaking(Rule, id=id, severity=Severity.WARNING):
        __doc__ = f"buf documents {id}."

    return BufBreaking


def executable() -> str | None:
    """Return the path of buf; None if it is not installed.

    The buf beside the running Python interpreter is preferred to one on the PATH. On PyPI, buf is the package buf-bin.
    """
    return shutil.which("buf", path=str(Path(sys.executable).parent)) or shutil.which("buf")


def require() -> None:
    """Raise `DiagnosticsError` if buf is not installed."""
    if executable() is None:
        message = "buf is not installed beside this Python interpreter or on the PATH; nothing was linted"
        raise DiagnosticsError([BufNotInstalled.at(_OPTION, message, f"{sys.executable} -m pip install buf-bin")])


def breaking(before: Schema, after: Schema, shown_root: str) -> list[Diagnostic]:
    """Compare two states with buf, and return a diagnostic for each change that breaks users of the .proto files.

    ``shown_root`` is the folder of the .proto files, as diagnostics show it. protoc makes an entry message for each map
    field. If both are deleted, only the diagnostic about the map field is returned. Raises `DiagnosticsError` if buf
    fails.
    """
    if not before.files or not after.files:
        return []  # no file compiled, and protoc's errors are already reported
    # With `--error-format json`, buf prints one JSON object per line.
    output = _run(before, after)
    try:
        found = [_finding(json.loads(line), before, after, shown_root) for line in output.splitlines()]
    except (ValueError, LookupError, TypeError) as error:
        raise _failure(f"its output is not a list of findings: {_first_line(output)}") from error
    entries = {name for name, message in before.messages.items() if message.map_entry}
    return [finding for finding in found if finding.rule.id != "MESSAGE_NO_DELETE" or finding.type not in entries]


def _run(before: Schema, after: Schema) -> str:
    # A file that does not compile is missing in the descriptor set, and buf would report it as deleted.
    # protobuf's own files come with the compiler. Another version of grpcio-tools would look like a change of the
    # project.
    ignored = sorted({"google/protobuf", *before.uncompiled, *after.uncompiled})
    config = json.dumps({"version": "v2", "breaking": {"use": ["FILE"], "ignore": ignored}})
    command = [executable() or "buf", "breaking", "after.binpb", "--against", "before.binpb"]
    with tempfile.TemporaryDirectory(prefix="roverlink-buf-") as folder:
        for name, schema in (("before", before), ("after", after)):
            Path(folder, f"{name}.binpb").write_bytes(schema.descriptors.SerializeToString())
        try:
            done = subprocess.run(  # noqa: S603  # the buf that the user installed
                [*command, "--config", config, "--against-config", '{"version": "v2"}', "--error-format", "json"],
                cwd=folder,
                # buf's own cache and configuration are in the home folder otherwise. The result must not depend on
                # them, and a CI user may have no home folder.
                env={**os.environ, "BUF_CACHE_DIR": folder, "BUF_CONFIG_DIR": folder},
                capture_output=True,
                text=True,
                encoding="utf-8",
                errors="replace",
                check=False,
            )
        except OSError as error:
            raise _failure(f"it cannot be run: {error}") from error
    if done.returncode not in (0, _VIOLATIONS) or (done.returncode and not done.stdout):
        raise _failure(_first_line(done.stderr) or _first_line(done.stdout) or f"exit code {done.returncode}")
    return done.stdout


def _first_line(text: str) -> str:
    return next(filter(None, map(str.strip, text.splitlines())), "")


def _failure(why: str) -> DiagnosticsError:
    help = f"if this buf is old or broken: {sys.executable} -m pip install --upgrade buf-bin"
    return DiagnosticsError([BufFailed.at(_OPTION, f"{executable()} did not compare the two states: {why}", help)])


def _finding(parsed: Mapping[str, object], before: Schema, after: Schema, shown_root: str) -> Diagnostic:
    """Return the diagnostic for one line of buf's output; ``parsed`` is the line as parsed JSON.

    buf gives no place for a deleted file; the place is then the folder of the .proto files. Raises `ValueError`,
    `LookupError` or `TypeError` if ``parsed`` has another form.
    """
    id, message, path = str(parsed["type"]), str(parsed["message"]), str(parsed.get("path", ""))
    broken = rule(id)
    if broken is None:
        raise ValueError(id)
    span = Span(shown_root or ".")
    if path:
        span = Span(shown(shown_root, path), int(str(parsed["start_line"])), int(str(parsed["start_column"])))
    number = _NUMBER.search(message)
    return broken.at(
        span,
        message,
        f"see https://buf.build/docs/breaking/rules/#{id.lower()}",
        type=_full_name(message, path, span, before, after),
        number=int(number[1]) if number else None,
    )


def _full_name(message: str, path: str, span: Span, before: Schema, after: Schema) -> str:
    """Return the full name of the message or enum that buf's text ``message`` mentions; empty if it mentions none.

    buf writes the full name, the name without package, or only the last part of a nested type's name. If several types
    of the file match, this returns the type that starts last before ``span``, the place of the diagnostic.
    """
    name = _TYPE.search(message)
    if name is None:
        return ""
    for schema in (after, before):
        types: dict[str, ProtoMessage | ProtoEnum] = {**schema.messages, **schema.enums}
        if name[1] in types:
            return name[1]
        found = [
            declared
            for declared in types.values()
            if declared.file == path and declared.full_name.endswith(f".{name[1]}")
        ]
        if found:
            return max(found, key=lambda declared: (declared.span <= span, declared.span)).full_name
    return ""


def unstated(theirs: Iterable[Diagnostic], ours: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield the diagnostics of buf (``theirs``) that our own rules do not already report (``ours``).

    Two diagnostics are about the same fault if they have the same message or enum and the same number.
    """
    reported = {(finding.type, finding.number) for finding in ours if finding.rule.id.startswith(_OURS)}
    for finding in theirs:
        of_range = (
            finding.rule.id.startswith("RESERVED_") and (finding.type, None) in reported
        )  # our diagnostic may cover several ranges
        if finding.number is None or not (of_range or (finding.type, finding.number) in reported):
            yield finding
