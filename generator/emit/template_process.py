"""The process in which users' templates are rendered: jinja's sandbox, with limits on time, memory and output.

A pull request can bring a template, and CI renders it. The sandbox refuses everything that leads from the bridge to
Python's internals. It has no limits: a loop that never ends, or a text that doubles 40 times, is stopped by the limits
of the process. `user_templates` starts the process with a pickled `Request`; the process answers with JSON lines, so
that nothing it writes can run code in the process that reads them.
"""

from __future__ import annotations

import contextlib
import json
import pickle
import signal
import sys
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from jinja2 import Environment, FileSystemLoader, TemplateError, TemplateSyntaxError
from jinja2.exceptions import SecurityError
from jinja2.sandbox import ImmutableSandboxedEnvironment

from roverlink.generator import ir
from roverlink.generator.emit.render import SETTINGS, header
from roverlink.generator.ir import ros_names

SUFFIX = ".j2"
_SPARE_S = 2  # after the time limit: then the system ends the process, if Python could not
_LARGEST_POWER = 4096  # bits of an integer that `**` may make


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a folder of templates."""

    seconds: int = 10
    """Processor time; the other process waits for six times as long."""
    memory: int = 1 << 30
    """Bytes of address space."""
    output: int = 64 << 20
    """Characters of all files together."""


@dataclass(frozen=True, slots=True)
class Request:
    """A folder of templates to be rendered."""

    root: Path
    templates: tuple[str, ...]
    """Relative to the root."""
    bridge: ir.Bridge
    limits: Limits


def main() -> None:
    """Render the request on standard input; write JSON lines to standard output.

    ``["template", name]`` comes before the files of a template, ``["file", path, text]`` is one of them. The last line
    is ``["failed", file, line, message]`` for the first template that fails, or ``["done"]``.
    """
    request: Request = pickle.load(sys.stdin.buffer)  # noqa: S301  # written by the process that started this one
    _limit(request.limits)
    for answer in _answers(request):
        print(json.dumps(answer), flush=True)


def _limit(limits: Limits) -> None:
    """Limit this process; on Windows, only the time that the other process waits is limited."""
    if sys.platform == "win32":
        return
    import resource  # Windows has none

    signal.signal(signal.SIGXCPU, _out_of_time)
    resource.setrlimit(resource.RLIMIT_CPU, (limits.seconds, limits.seconds + _SPARE_S))
    with contextlib.suppress(ValueError, OSError):  # macOS knows no limit of the address space
        resource.setrlimit(resource.RLIMIT_AS, (limits.memory, limits.memory))


def _out_of_time(*_: object) -> None:
    raise TimeoutError("it takes too long")


def _answers(request: Request) -> Iterator[list[str | int]]:
    own = _environment(request.root)
    budget = request.limits.output
    for template in request.templates:
        yield ["template", template]
        try:
            for path, view in _renderings(template, request.bridge):
                text = _rendered(own, template, view, budget)
                budget -= len(text)
                yield ["file", path, text]
        except Exception as error:  # noqa: BLE001  # a template can raise anything
            yield ["failed", *_failure(error, template)]
            return
    yield ["done"]


def _environment(root: Path) -> Environment:
    own = _Sandbox(loader=_InsideFolder(root), **SETTINGS)
    own.filters |= {"snake_case": ros_names.snake_case, "camel_case": ros_names.camel_case}
    own.globals["header"] = header
    del own.globals["lipsum"], own.filters["random"]  # the same table must give the same text
    return own


class _Sandbox(ImmutableSandboxedEnvironment):
    """Jinja's sandbox; `**` makes no number whose computation could not be interrupted."""

    intercepted_binops = frozenset({"**"})

    def call_binop(self, context: Any, operator: str, left: Any, right: Any) -> Any:
        bits = int(left).bit_length() * abs(int(right))
        if bits > _LARGEST_POWER:
            raise SecurityError(f"a power of more than {_LARGEST_POWER} bits")
        return super().call_binop(context, operator, left, right)


class _InsideFolder(FileSystemLoader):
    """Loads templates of one folder, and nothing to which a link leads out of it."""

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        root = Path(self.searchpath[0]).resolve()
        if not is_inside(root / template, root):
            raise TemplateError(f"{template!r} is not a file of the templates' folder")
        return super().get_source(environment, template)


def is_inside(path: Path, root: Path) -> bool:
    """Tell if a path leads, by way of any links, to a template or a visible file below a folder.

    The folder may be the project itself, and ``.git/config`` may hold a password.
    """
    found = path.resolve()
    if not found.is_relative_to(root):
        return False
    return found.suffix == SUFFIX or not any(part.startswith(".") for part in found.relative_to(root).parts)


def _renderings(template: str, bridge: ir.Bridge) -> Iterator[tuple[str, dict[str, Any]]]:
    """The path and the view of each file that a template makes."""
    if "{route}" in template:
        for route in bridge.routes:
            yield template.replace("{route}", route.name), {"bridge": bridge, "route": route}
    elif "{message}" in template:
        for message in bridge.messages:
            yield template.replace("{message}", message.name), {"bridge": bridge, "message": message}
    else:
        yield template, {"bridge": bridge}


def _rendered(own: Environment, template: str, view: dict[str, Any], budget: int) -> str:
    """Render a template. Raises `SecurityError` for a text of more characters than the budget."""
    parts, length = [], 0
    stream = cast(Generator[str, None, None], own.get_template(template).generate(view))
    for part in stream:
        parts.append(part)
        length += len(part)
        if length > budget:  # raised inside, so that the error has the template's line
            stream.throw(SecurityError("the templates of the folder make too much text"))
    return "".join(parts)


def _failure(error: Exception, template: str) -> tuple[str, int, str]:
    """The template that failed, its line (0 for the whole file), and the reason."""
    if isinstance(error, TemplateSyntaxError):
        return error.name or template, error.lineno, f"not a template: {error.message}"
    if isinstance(error, UnicodeDecodeError):
        return template, 0, f"not a template: it is not UTF-8: {error.reason}"
    reason = "it needs too much memory" if isinstance(error, MemoryError) else error
    return template, _line(error, template), f"cannot be rendered: {reason}"


def _line(error: BaseException, template: str) -> int:
    """The template's line that raised an error; 0 where that is not known. Jinja puts it into the traceback."""
    found, step = 0, error.__traceback__
    while step is not None:
        if step.tb_frame.f_code.co_filename.endswith(f"/{template}"):
            found = step.tb_lineno
        step = step.tb_next
    return found
