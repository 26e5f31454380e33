"""Step of the compiler that makes the text of every generated file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib.metadata import EntryPoint
from pathlib import Path, PurePosixPath

from roverlink.generator import ir, lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, nearest
from roverlink.generator.emit import envelope_file, mapping_json_schema, targets, user_templates
from roverlink.generator.emit.output_rules import FORBIDDEN_PATH, TARGET_FAILED, UNKNOWN_TARGET
from roverlink.generator.emit.python_format import format_python
from roverlink.generator.emit.render import Files
from roverlink.generator.table import Table

FOLDER = "generated"
"""Folder of generated files in the paths that targets return; `placed` replaces it by the real folder."""


def placed(path: str, bridge: ir.Bridge) -> str:
    """Return a generated file's real path: the project's Python package takes the place of ``generated/``."""
    return f"{bridge.folder}{path.removeprefix(FOLDER)}" if path.startswith(f"{FOLDER}/") else path


def emit(bridge: ir.Bridge, table: Table, published: lock.Ledger, project: Path) -> dict[str, str]:
    """Return the text of every file that a table compiles to, by its path relative to the table.

    ``published`` is the ledger of the last run. The template folders of the table are relative to ``project``. Raises
    `DiagnosticsError` with all mistakes in targets and templates.
    """
    collected = _Collected()
    collected.add(Span(bridge.table), [(f"{bridge.folder}/{mapping_json_schema.FILE}", mapping_json_schema.text())])
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
    """Collection of generated files, and of the diagnostics about them. Each file knows its place in the table."""

    def __init__(self) -> None:
        self._files: dict[str, str] = {}
        self._asked: dict[str, Span] = {}
        self._findings: list[Diagnostic] = []

    def add(self, span: Span, files: Iterable[tuple[str, str]]) -> None:
        """Add the files of a target or of a template folder, which the table lists at ``span``.

        Reports a file that another target or template has added before.
        """
        try:
            for path, text in files:
                if path in self._files:
                    also = [(self._asked[path], "this one writes the file first")]
                    self._findings.append(
                        FORBIDDEN_PATH.at(
                            span, f"two targets or template folders write the same file, {path!r}", also=also
                        )
                    )
                self._files[path] = text
                self._asked[path] = span
        except DiagnosticsError as error:
            self._findings += error.findings

    def files(self) -> dict[str, str]:
        """Return the text of each file, sorted by path. Raises `DiagnosticsError` if a mistake was found before."""
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
        help = nearest(name, known, f"known targets: {', '.join(known)}")
        raise DiagnosticsError([UNKNOWN_TARGET.at(span, f"unknown target {name!r}", help)])


def _of_installed(found: EntryPoint, bridge: ir.Bridge, span: Span) -> Files:
    """Yield the files of a target from another package. Any error in its code becomes a `TARGET_FAILED` diagnostic."""
    try:
        for path, text in found.load()(bridge):
            yield str(path), str(text)
    except Exception as error:  # code of another package may raise anything
        package = found.dist.name if found.dist else found.value
        message = f"the target {found.name!r} of the package {package!r} failed: {type(error).__name__}: {error}"
        raise DiagnosticsError([TARGET_FAILED.at(span, message)]) from error


def _formatted(files: Files) -> Files:
    """Format the Python files of a target with black; the modules that protoc generated are not changed."""
    texts = dict(files)
    ours = {path: text for path, text in texts.items() if path.endswith(".py") and "/pb2/" not in path}
    yield from (texts | format_python(ours)).items()


def _placed(files: Files, bridge: ir.Bridge) -> Files:
    return ((placed(path, bridge), text) for path, text in files)


def _below_folder(files: Iterable[tuple[str, str]], span: Span) -> Iterator[tuple[str, str]]:
    """Yield the files unchanged. Raises `DiagnosticsError` if a path is not below the folder of generated files.

    This checks the targets of other packages, and the templates of users.
    """
    for path, text in files:
        pure = PurePosixPath(path)
        if pure.parts[:1] != (FOLDER,) or len(pure.parts) < 2 or ".." in pure.parts or "\\" in path:
            message = f"cannot write {path!r}: it is not below {FOLDER}/"
            raise DiagnosticsError([FORBIDDEN_PATH.at(span, message)])
        yield str(pure), text


def _inside(project: Path, files: Files, span: Span) -> Files:
    """Yield the files unchanged. Raises `DiagnosticsError` if a symbolic link leads out of the project.

    The templates come from users and can contain any text, so nothing may be written outside the project.
    """
    for path, text in files:
        if not (project / path).parent.resolve().is_relative_to(project.resolve()):
            message = f"cannot write {path!r}: a link in its path leads outside the project"
            raise DiagnosticsError([FORBIDDEN_PATH.at(span, message)])
        yield path, text
