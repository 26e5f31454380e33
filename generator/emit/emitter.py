"""Step of the compiler that makes the text of every generated file. It does not write the files to the disk."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib.metadata import EntryPoint
from pathlib import Path, PurePosixPath

from roverlink.generator import ir, lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, shown
from roverlink.generator.emit import envelope_file, mapping_json_schema, targets, vendored_runtime
from roverlink.generator.emit.output_rules import ForbiddenPath, TargetFailed, UnknownTarget
from roverlink.generator.emit.python_format import format_python
from roverlink.generator.emit.render import Files, carries_header
from roverlink.generator.table import Table
from roverlink.suggestions import nearest

FOLDER = "generated"
"""First folder in the paths that targets return: ``generated/registry.py``. `placed` replaces it by the real folder."""


def placed(path: str, bridge: ir.Bridge) -> str:
    """Return the path at which a generated file is written, relative to the table.

    If the table sets the Python package ``rover.comms``, ``generated/registry.py`` becomes ``rover/comms/registry.py``.
    """
    return f"{bridge.folder}{path.removeprefix(FOLDER)}" if path.startswith(f"{FOLDER}/") else path


def emit(bridge: ir.Bridge, table: Table, published: lock.Ledger, project: Path) -> dict[str, str]:
    """Return the text of every file that is generated from a table, by the file's path relative to the table.

    ``published`` is the ledger (mapping.lock) that the last run wrote. ``project`` is the folder to which the table's
    template folders are relative. Raises `DiagnosticsError` with all mistakes in targets and templates.
    """
    collected = _Collected()
    collected.add(Span(bridge.table), [(f"{bridge.folder}/{mapping_json_schema.FILE}", mapping_json_schema.text())])
    if bridge.envelope.ours:
        path = shown(table.proto.root, bridge.envelope.file)
        collected.add(Span(bridge.table), [(path, envelope_file.text(bridge.envelope, bridge.table))])
        if bridge.link is not None:
            path = shown(table.proto.root, bridge.link.file)
            collected.add(table.at("link"), [(path, envelope_file.link_text(bridge.table))])
    for name in table.targets:
        span = table.at(f"targets.{name}")
        collected.add(span, _placed(_of_target(name, bridge, span), bridge))
    for folder in table.templates:
        from roverlink.generator.emit import user_templates  # here: it imports Jinja, which the help of a command lacks

        span = table.at(f"templates.{folder}")
        rendered = _below_folder(user_templates.emit(bridge, project, folder, span), span)
        collected.add(span, _placed(rendered, bridge))
    files = collected.files()
    if table.ros.vendor_runtime and "ros2" in table.targets:
        collected.add(table.ros.at("vendor_runtime"), vendored_runtime.emit(bridge, files))
        files = collected.files()
    unmarked = [path for path, text in files.items() if not carries_header(text)]
    return dict(
        sorted({**files, lock.NAME: lock.render(bridge, lock.settings_of_rows(table), published, unmarked)}.items())
    )


class _Collected:
    """Collection of generated files, and of the diagnostics about them.

    For each file, it also stores the place in the table that lists the file's target or template folder.
    """

    def __init__(self) -> None:
        self._files: dict[str, str] = {}
        self._asked: dict[str, Span] = {}
        self._findings: list[Diagnostic] = []

    def add(self, span: Span, files: Iterable[tuple[str, str]]) -> None:
        """Add the files of a target or of a template folder, which the table lists at ``span``.

        Adds a diagnostic for a file that another target or template folder has added before.
        """
        try:
            for path, text in files:
                if path in self._files:
                    also = [(self._asked[path], "the first target or folder that writes the file")]
                    message = f"two targets or template folders write the same file, {path!r}"
                    help = "remove one of the two from the table, or rename a template"
                    self._findings.append(ForbiddenPath.at(span, message, help, also))
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
        raise DiagnosticsError([UnknownTarget.at(span, f"unknown target {name!r}", help)])


def _of_installed(found: EntryPoint, bridge: ir.Bridge, span: Span) -> Files:
    """Yield the files of a target from another package. Any error in its code becomes a `TARGET_FAILED` diagnostic."""
    try:
        for path, text in found.load()(bridge):
            yield str(path), str(text)
    except Exception as error:  # code of another package may raise anything
        package = found.dist.name if found.dist else found.value
        message = f"the target {found.name!r} of the package {package!r} failed: {type(error).__name__}: {error}"
        help = "report this to the authors of the package, or remove the target from `targets`"
        raise DiagnosticsError([TargetFailed.at(span, message, help)]) from error


def _formatted(files: Files) -> Files:
    """Yield the files of a target, the Python files formatted by black.

    Files that are not Python, and the modules that protoc generated, do not change.
    """
    texts = dict(files)
    ours = {path: text for path, text in texts.items() if path.endswith(".py") and "/pb2/" not in path}
    yield from (texts | format_python(ours)).items()


def _placed(files: Files, bridge: ir.Bridge) -> Files:
    return ((placed(path, bridge), text) for path, text in files)


def _below_folder(files: Iterable[tuple[str, str]], span: Span) -> Iterator[tuple[str, str]]:
    """Yield the files unchanged. Raises `DiagnosticsError` if a path is not below ``generated/``.

    The emitter checks the files of other packages' targets and of users' templates in this way.
    """
    for path, text in files:
        pure = PurePosixPath(path)
        if pure.parts[:1] != (FOLDER,) or len(pure.parts) < 2 or ".." in pure.parts or "\\" in path:
            message = f"cannot write {path!r}: the path is not below {FOLDER}/"
            raise DiagnosticsError([ForbiddenPath.at(span, message, "correct the target or the template")])
        yield str(pure), text
