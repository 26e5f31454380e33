"""Process that renders users' templates in Jinja's sandbox, with limits on time, memory and output.

A pull request from a stranger can add a template, which CI then renders. The sandbox refuses access from the IR to
Python's internals, but it does not limit time and memory. The limits of the process stop an endless loop, or a text
that doubles 40 times. `user_templates` starts the process with a pickled `Request`. The process answers with JSON
lines, because a pickled answer could run code in the process that reads it.
"""

from __future__ import annotations

import contextlib
import json
import pickle
import signal
import sys
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, cast

from jinja2 import Environment, FunctionLoader, StrictUndefined, TemplateError, TemplateSyntaxError
from jinja2.exceptions import SecurityError
from jinja2.sandbox import ImmutableSandboxedEnvironment

from roverlink.generator import ir, source_files
from roverlink.generator.emit.render import SETTINGS, header
from roverlink.generator.ir import ros_names

SUFFIX = ".j2"
_SPARE_S = 2  # after the time limit, the kernel kills the process if Python did not end it
_LARGEST_POWER = 4096  # largest result of `**` in bits


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits for one process that renders all templates of a folder."""

    seconds: int = 10
    """Processor time in seconds. The process that started this one waits six times as long."""
    memory: int = 1 << 30
    """Largest address space of the process in bytes."""
    output: int = 64 << 20
    """Largest number of characters of all rendered files together."""


@dataclass(frozen=True, slots=True)
class Request:
    """Input of the process: a folder of templates to render, the IR, and the limits."""

    root: Path
    templates: tuple[str, ...]
    """Paths of the templates, relative to the root."""
    bridge: ir.Bridge
    limits: Limits


def main() -> None:
    """Read a pickled `Request` from standard input, render its templates, and write JSON lines to standard output.

    The line ``["template", name]`` says that a template begins, and ``["file", path, text]`` is a file that it
    produces. The last line is ``["failed", file, line, message]`` for the first template that fails, or ``["done"]``.
    """
    request: Request = pickle.load(sys.stdin.buffer)  # noqa: S301  # written by the process that started this one
    _limit(request.limits)
    for answer in _answers(request):
        print(json.dumps(answer), flush=True)


def _limit(limits: Limits) -> None:
    """Set the limits of this process. On Windows nothing is set; only the starting process limits the time."""
    if sys.platform == "win32":
        return
    import resource  # the module does not exist on Windows

    signal.signal(signal.SIGXCPU, _out_of_time)
    resource.setrlimit(resource.RLIMIT_CPU, (limits.seconds, limits.seconds + _SPARE_S))
    with contextlib.suppress(ValueError, OSError):  # macOS does not limit the address space
        resource.setrlimit(resource.RLIMIT_AS, (limits.memory, limits.memory))


def _out_of_time(*_: object) -> None:
    raise TimeoutError("the time limit is exceeded")


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
    own = _Sandbox(loader=FunctionLoader(partial(_source, root)), undefined=StrictUndefined, **SETTINGS)
    own.filters |= {"snake_case": ros_names.snake_case, "camel_case": ros_names.camel_case}
    own.globals["header"] = header
    del own.globals["lipsum"], own.filters["random"]  # the same table must give the same text
    return own


class _Sandbox(ImmutableSandboxedEnvironment):
    """Jinja's sandbox that also refuses powers with huge results, because Python cannot interrupt their computation."""

    intercepted_binops = frozenset({"**"})

    def call_binop(self, context: Any, operator: str, left: Any, right: Any) -> Any:
        bits = int(left).bit_length() * abs(int(right))
        if bits > _LARGEST_POWER:
            raise SecurityError(f"the result of '**' would have more than {_LARGEST_POWER} bits")
        return super().call_binop(context, operator, left, right)


def _source(root: Path, template: str) -> tuple[str, str, None] | None:
    """Return text and path of a template below the folder ``root``; None if it does not exist.

    Raises `TemplateError` for a file that templates may not read, such as a link that leads out of the folder.
    """
    if not is_inside(root / template, root):
        raise TemplateError(f"{template!r} is not a visible file inside the folder of the templates")
    try:
        return source_files.read_text(root, template), str(root / template), None
    except FileNotFoundError:
        return None
    except OSError as error:
        raise TemplateError(f"{template!r} cannot be read: {error.strerror}") from error


def is_inside(path: Path, root: Path) -> bool:
    """Return True if a path leads to a file that templates may read. Symbolic links are resolved first.

    The file must be below ``root``, and it must end with ``.j2`` or not be hidden. Hidden files are refused because the
    root may be the project's folder, and ``.git/config`` may contain a password.
    """
    found = path.resolve()
    if not found.is_relative_to(root):
        return False
    return found.suffix == SUFFIX or not any(part.startswith(".") for part in found.relative_to(root).parts)


def _renderings(template: str, bridge: ir.Bridge) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the path of each file that a template produces, and the variables that the template sees for this file.

    ``{route}.md.j2`` produces a file for each row, ``{message}.md.j2`` for each ROS message, ``all.md.j2`` only one.
    """
    if "{route}" in template:
        for route in bridge.routes:
            yield template.replace("{route}", route.name), {"bridge": bridge, "route": route}
    elif "{message}" in template:
        for message in bridge.messages:
            yield template.replace("{message}", message.name), {"bridge": bridge, "message": message}
    else:
        yield template, {"bridge": bridge}


def _rendered(own: Environment, template: str, view: dict[str, Any], budget: int) -> str:
    """Return the text that a template produces. Raises `SecurityError` if it has more than ``budget`` characters."""
    parts, length = [], 0
    stream = cast(Generator[str, None, None], own.get_template(template).generate(view))
    for part in stream:
        parts.append(part)
        length += len(part)
        if length > budget:  # raised inside, so that the error has the template's line
            stream.throw(SecurityError("the templates of the folder produce too much text"))
    return "".join(parts)


def _failure(error: Exception, template: str) -> tuple[str, int, str]:
    """Return the file name of the failed template, the line (0 for the whole file), and the reason."""
    if isinstance(error, TemplateSyntaxError):
        return error.name or template, error.lineno, f"cannot parse the template: {error.message}"
    if isinstance(error, UnicodeDecodeError):
        return template, 0, f"cannot read the template: it is not UTF-8: {error.reason}"
    reason = "the memory limit is exceeded" if isinstance(error, MemoryError) else error
    return template, _line(error, template), f"cannot render the template: {reason}"


def _line(error: BaseException, template: str) -> int:
    """Return the line of the template in which an error was raised; 0 if it is unknown.

    Jinja adds the template's line to the traceback of the error.
    """
    found, step = 0, error.__traceback__
    while step is not None:
        if step.tb_frame.f_code.co_filename.endswith(f"/{template}"):
            found = step.tb_lineno
        step = step.tb_next
    return found
