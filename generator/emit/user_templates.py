"""A user's own templates: a folder of Jinja files, each rendered with the IR in a process with limits."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any

from roverlink.generator import ir
from roverlink.generator.diagnostics import DiagnosticsError, Span
from roverlink.generator.emit.output_rules import FOREIGN_TEMPLATE, NO_TEMPLATES, TEMPLATE_FAILED
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.template_process import SUFFIX, Limits, Request, is_inside

LIMITS = Limits()
_PATIENCE = 6  # times the processor time: other programs may use the processor too

_INSTALLED = Path(__file__).parents[3]
"""The folder with the package roverlink."""
# Ours comes last, lest a package beside it be taken for one of Python's modules.
_RUN = """
import sys
sys.path.append(sys.argv[1])
from roverlink.generator.emit.template_process import main
main()
"""


def emit(bridge: ir.Bridge, project: Path, folder: str, span: Span) -> Files:
    """Render the templates of a folder to ``generated/<folder's name>/``, without the templates' suffix.

    A template sees ``bridge``. One with ``{route}`` in its path is rendered for each row, and sees that as ``route``;
    ``{message}`` does the same for each message of the ROS 2 package. ``folder`` is relative to the project, and
    ``span`` is the place that asks for it. Raises `DiagnosticsError` for a folder without templates, for links that
    lead out of it, and for the first template that cannot be rendered.
    """
    root = _root(project, folder, span)
    templates = _templates(root, folder, span)
    place = PurePosixPath("generated", root.name)
    for path, text in _rendered(Request(root, templates, bridge, LIMITS), folder):
        yield str(place / path.removesuffix(SUFFIX)), text


def _root(project: Path, folder: str, span: Span) -> Path:
    """Return the folder; only the command line may name one outside the project."""
    root = (project / folder).resolve()
    if not folder.startswith("..") and not root.is_relative_to(project.resolve()):
        raise DiagnosticsError([FOREIGN_TEMPLATE.at(span, f"{folder} is a link that leads out of the project")])
    return root


def _templates(root: Path, folder: str, span: Span) -> tuple[str, ...]:
    found = sorted(root.rglob(f"*{SUFFIX}"))
    if not found:
        why = f"holds no file that ends with {SUFFIX}" if root.is_dir() else "is not a folder"
        raise DiagnosticsError([NO_TEMPLATES.at(span, f"{folder} {why}")])
    names = [path.relative_to(root).as_posix() for path in found]
    foreign = [
        FOREIGN_TEMPLATE.at(Span(f"{folder}/{name}"), f"is not a file of {folder}", "replace it by a copy of the file")
        for path, name in zip(found, names)
        if not path.is_file() or not is_inside(path, root)
    ]
    if foreign:
        raise DiagnosticsError(foreign)
    return tuple(names)


def _rendered(request: Request, folder: str) -> Iterator[tuple[str, str]]:
    """Path and text of each file. Raises `DiagnosticsError` for the first template that cannot be rendered."""
    template = ""
    for kind, *content in _answers(request):
        if kind == "template":
            template = content[0]
        elif kind == "file":
            yield content[0], content[1]
        elif kind == "failed":
            file, line, message = content
            raise DiagnosticsError([TEMPLATE_FAILED.at(Span(f"{folder}/{file}", line), message)])
        else:
            return
    limits = request.limits
    message = f"cannot be rendered within {limits.seconds} s and {limits.memory >> 20} MiB of memory"
    raise DiagnosticsError([TEMPLATE_FAILED.at(Span(f"{folder}/{template}"), message)])


def _answers(request: Request) -> list[list[Any]]:
    """Return everything that the process wrote, as far as it came."""
    # In a folder of its own, lest a module of the user's be taken for one of Python's.
    with tempfile.TemporaryDirectory(prefix="roverlink-") as folder:
        command = [sys.executable, "-c", _RUN, str(_INSTALLED)]
        with subprocess.Popen(  # noqa: S603  # our Python
            command, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        ) as process:
            try:
                said, _ = process.communicate(pickle.dumps(request), timeout=_PATIENCE * request.limits.seconds)
            except subprocess.TimeoutExpired:
                process.kill()
                said, _ = process.communicate()
    return [json.loads(line) for line in said.splitlines(keepends=True) if line.endswith(b"\n")]
