"""Users' own templates: folders of Jinja files, which a separate process renders with the IR."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any

from roverlink.generator import ir, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.output_rules import ForeignTemplate, NoTemplates, TemplateFailed
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.template_process import SUFFIX, Limits, Request, is_inside

LIMITS = Limits()
_WAIT_FACTOR = 6  # times the processor time, because other programs also use the processor

_INSTALLED = Path(__file__).parents[3]
"""Folder from which Python imports the package roverlink."""
# Our folder comes last, so that a package beside roverlink cannot hide a module of Python.
_RUN = """
import sys
sys.path.append(sys.argv[1])
from roverlink.generator.emit.template_process import main
main()
"""


def emit(bridge: ir.Bridge, project: Path, folder: str, span: Span) -> Files:
    """Render the templates of a user's folder; the files go to ``generated/NAME/``, where NAME is the folder's name.

    A template sees the IR as ``bridge``. A template with ``{route}`` in its path is rendered once for each row, and
    also sees the row as ``route``. A template with ``{message}`` in its path is rendered once for each message of the
    ROS 2 package, and also sees the message as ``message``. The templates' suffix is removed from the paths. ``folder``
    is relative to the project; ``span`` is the place in the table that lists the folder. Raises `DiagnosticsError` for
    a folder without templates, for links that lead out of it, and for the first template that cannot be rendered.
    """
    root = _root(project, folder, span)
    templates = _templates(root, folder, span)
    place = PurePosixPath("generated", root.name)
    for path, text in _rendered(Request(root, templates, bridge, LIMITS), folder):
        yield str(place / path.removesuffix(SUFFIX)), text


def _root(project: Path, folder: str, span: Span) -> Path:
    """Return the path of a folder of templates. Raises `DiagnosticsError` if the folder is a link out of the project.

    Only the command line may name a folder outside the project, with a path that starts with ``..``.
    """
    root = (project / folder).resolve()
    if not folder.startswith("..") and not root.is_relative_to(project.resolve()):
        raise DiagnosticsError(
            [
                ForeignTemplate.at(
                    span,
                    f"the folder {folder!r} is a symbolic link that leads out of the project",
                    "replace the link by a copy of the folder",
                )
            ]
        )
    return root


def _templates(root: Path, folder: str, span: Span) -> tuple[str, ...]:
    faults: list[Diagnostic] = []

    def refuse(path: str, fault: str) -> None:
        span = Span(f"{folder}/{source_files.printable(path)}")
        faults.append(ForeignTemplate.at(span, fault, "replace a link by a copy of the file"))

    found = [path for path in source_files.walk(root, refuse) if path.endswith(SUFFIX)] if root.is_dir() else []
    if not found and not faults:
        why = f"contains no file that ends with {SUFFIX}" if root.is_dir() else "is not a folder"
        raise DiagnosticsError(
            [NoTemplates.at(span, f"{folder!r} {why}", "check the path; it is relative to the folder of the table")]
        )
    for path in found:
        if source_files.printable(path) != path:
            refuse(path, "the name of the template is not UTF-8")
        elif not (root / path).exists() or not is_inside(root / path, root):
            refuse(path, f"the link does not lead to a visible file inside the folder {folder!r}")
        else:
            try:
                source_files.read(root, path)
            except OSError as error:
                refuse(path, f"the template cannot be read: {error.strerror}")
    if faults:
        raise DiagnosticsError(faults)
    return tuple(found)


def _rendered(request: Request, folder: str) -> Iterator[tuple[str, str]]:
    """Yield path and text of each rendered file.

    Raises `DiagnosticsError` for the first template that cannot be rendered.
    """
    template = ""
    for kind, *content in _answers(request):
        if kind == "template":
            template = content[0]
        elif kind == "file":
            yield content[0], content[1]
        elif kind == "failed":
            file, line, message = content
            raise DiagnosticsError([TemplateFailed.at(Span(f"{folder}/{file}", line), message)])
        else:
            return
    limits = request.limits
    message = f"cannot render the template within {limits.seconds} s and {limits.memory >> 20} MiB of memory"
    raise DiagnosticsError([TemplateFailed.at(Span(f"{folder}/{template}"), message)])


def _answers(request: Request) -> list[list[Any]]:
    """Start the process that renders the templates, and return the JSON lines that it wrote.

    If the process was killed, a line that is not complete is dropped.
    """
    # The process runs in an empty folder, so that a user's module cannot hide a module of Python.
    with tempfile.TemporaryDirectory(prefix="roverlink-") as folder:
        command = [sys.executable, "-c", _RUN, str(_INSTALLED)]
        with subprocess.Popen(  # noqa: S603  # our Python
            command, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        ) as process:
            try:
                output, _ = process.communicate(pickle.dumps(request), timeout=_WAIT_FACTOR * request.limits.seconds)
            except subprocess.TimeoutExpired:
                process.kill()
                output, _ = process.communicate()
    return [json.loads(line) for line in output.splitlines(keepends=True) if line.endswith(b"\n")]
