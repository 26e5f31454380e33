"""The phase between the IR and the disk: every file that a table compiles to, as path and text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib.metadata import EntryPoint
from pathlib import Path, PurePosixPath

from roverlink.generator import ir, lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, nearest
from roverlink.generator.emit import envelope_file, mapping_schema, targets, user_templates
from roverlink.generator.emit.output_rules import FORBIDDEN_PATH, TARGET_FAILED, UNKNOWN_TARGET
from roverlink.generator.emit.python_format import format_python
from roverlink.generator.emit.render import Files
from roverlink.generator.table import Table

FOLDER = "generated"
"""The folder of what is generated, as targets name it; `placed` tells where it is."""


def placed(path: str, bridge: ir.Bridge) -> str:
    """Return where a target's file goes: from ``generated/`` to the folder of the project's Python package."""
    return f"{bridge.folder}{path.removeprefix(FOLDER)}" if path.startswith(f"{FOLDER}/") else path


def emit(bridge: ir.Bridge, table: Table, published: lock.Ledger, project: Path) -> dict[str, str]:
    """Every file that a table compiles to: its path, relative to the table, and its text.

    ``published`` is what the ledger had before; ``project`` is the folder from which those of templates are named.
    Raises `DiagnosticsError` with everything that is wrong with targets and templates.
    """
    collected = _Collected()
    collected.add(Span(bridge.table), [(f"{bridge.folder}/{mapping_schema.FILE}", mapping_schema.text())])
    collected.add(Span(bridge.table), [(lock.NAME, lock.render(bridge, published))])
    if bridge.envelope.ours:
        path = f"{table.proto.root}/{bridge.envelope.file}"
        collected.add(Span(bridge.table), [(path, envelope_file.text(bridge.envelope, bridge.table))])
    for name in table.targets:
        span = table.at(f"targets.{name}")
        collected.add(span, _placed(_of_target(name, bridge, span), bridge))
    for folder in table.templates:
        span = table.at(f"templates.{folder}")
        rendered = _below_folder(user_templates.emit(bridge, project, folder, span), span)
        collected.add(span, _inside(project, _placed(rendered, bridge), span))
    return collected.files()


class _Collected:
    """Files, each with the place in the table that asks for it, and what is wrong with them."""

    def __init__(self) -> None:
        self._files: dict[str, str] = {}
        self._asked: dict[str, Span] = {}
        self._findings: list[Diagnostic] = []

    def add(self, span: Span, files: Iterable[tuple[str, str]]) -> None:
        """Add what is asked for at a place; two must not make one file."""
        try:
            for path, text in files:
                if path in self._files:
                    also = [(self._asked[path], "first here")]
                    self._findings.append(FORBIDDEN_PATH.at(span, f"{path} is made twice", also=also))
                self._files[path] = text
                self._asked[path] = span
        except DiagnosticsError as error:
            self._findings += error.findings

    def files(self) -> dict[str, str]:
        """The files in the order of their paths. Raises `DiagnosticsError` where anything is wrong."""
        if self._findings:
            raise DiagnosticsError(self._findings)
        return dict(sorted(self._files.items()))


def _of_target(name: str, bridge: ir.Bridge, span: Span) -> Files:
    if target := targets.built_in(name):
        yield from _formatted(target(bridge))
    elif found := targets.installed(name):
        yield from _below_folder(_of_installed(found, bridge, span), span)
    else:
        known = targets.names()
        help = nearest(name, known, f"there are {', '.join(known)}")
        raise DiagnosticsError([UNKNOWN_TARGET.at(span, f"there is no target {name!r}", help)])


def _of_installed(found: EntryPoint, bridge: ir.Bridge, span: Span) -> Files:
    """What another package's target makes; whatever goes wrong in it is told as its fault."""
    try:
        for path, text in found.load()(bridge):
            yield str(path), str(text)
    except Exception as error:  # another's code: any error of its is its author's to mend
        package = found.dist.name if found.dist else found.value
        message = f"the target {found.name} of {package} failed: {type(error).__name__}: {error}"
        raise DiagnosticsError([TARGET_FAILED.at(span, message)]) from error


def _formatted(files: Files) -> Files:
    """Format the Python of a target; protoc's modules stay as protoc wrote them."""
    texts = dict(files)
    ours = {path: text for path, text in texts.items() if path.endswith(".py") and "/pb2/" not in path}
    yield from (texts | format_python(ours)).items()


def _placed(files: Files, bridge: ir.Bridge) -> Files:
    return ((placed(path, bridge), text) for path, text in files)


def _below_folder(files: Iterable[tuple[str, str]], span: Span) -> Iterator[tuple[str, str]]:
    """Files of others', which must stay in the folder of what is generated."""
    for path, text in files:
        pure = PurePosixPath(path)
        if pure.parts[:1] != (FOLDER,) or len(pure.parts) < 2 or ".." in pure.parts or "\\" in path:
            message = f"would write {path!r}, which is not below {FOLDER}/"
            raise DiagnosticsError([FORBIDDEN_PATH.at(span, message)])
        yield str(pure), text


def _inside(project: Path, files: Files, span: Span) -> Files:
    """Files of users' templates, which no link may lead out of the project: their text can be anything."""
    for path, text in files:
        if not (project / path).parent.resolve().is_relative_to(project.resolve()):
            message = f"{path} would be written outside the project: a link leads out of it"
            raise DiagnosticsError([FORBIDDEN_PATH.at(span, message)])
        yield path, text
