"""A user's own templates: a folder of Jinja files, each rendered with the IR."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any

from jinja2 import Environment, TemplateSyntaxError

from roverlink.generator import ir
from roverlink.generator.diagnostics import DiagnosticsError, Span
from roverlink.generator.emit.output_rules import NO_TEMPLATES, TEMPLATE_FAILED
from roverlink.generator.emit.render import Files, environment, header
from roverlink.generator.ir import ros_names

SUFFIX = ".j2"


def emit(bridge: ir.Bridge, project: Path, folder: str, span: Span) -> Files:
    """What the templates of a folder make: ``generated/<folder's name>/``, without the templates' suffix.

    A template sees ``bridge``. One with ``{route}`` in its path is rendered for each row, and sees that as ``route``;
    ``{message}`` does the same for each message of the ROS 2 package. ``folder`` is named from the project, and
    ``span`` is where it is asked for. Raises `DiagnosticsError` for a folder without templates, and for the first
    template that cannot be rendered.
    """
    root = project / folder
    templates = sorted(path.relative_to(root).as_posix() for path in root.rglob(f"*{SUFFIX}"))
    if not templates:
        why = f"holds no file that ends with {SUFFIX}" if root.is_dir() else "is not a folder"
        raise DiagnosticsError([NO_TEMPLATES.at(span, f"{folder} {why}")])
    own = environment(root)
    own.filters |= {"snake_case": ros_names.snake_case, "camel_case": ros_names.camel_case}
    own.globals["header"] = header
    place = PurePosixPath("generated", root.resolve().name)
    for template in templates:
        for path, view in _renderings(template, bridge):
            yield str(place / path.removesuffix(SUFFIX)), _rendered(own, template, view, Span(f"{folder}/{template}"))


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


def _rendered(own: Environment, template: str, view: dict[str, Any], span: Span) -> str:
    try:
        return own.get_template(template).render(view)
    except TemplateSyntaxError as error:
        place = Span(span.file, error.lineno)
        raise DiagnosticsError([TEMPLATE_FAILED.at(place, f"not a template: {error.message}")]) from error
    except UnicodeDecodeError as error:
        raise DiagnosticsError(
            [TEMPLATE_FAILED.at(span, f"not a template: it is not UTF-8: {error.reason}")]
        ) from error
    except Exception as error:  # what stands in a template can raise anything
        place = Span(span.file, _line(error, template))
        raise DiagnosticsError([TEMPLATE_FAILED.at(place, f"cannot be rendered: {error}")]) from error


def _line(error: BaseException, template: str) -> int:
    """The template's line that raised an error; 0 where that is not known. Jinja puts it into the traceback."""
    found, step = 0, error.__traceback__
    while step is not None:
        if step.tb_frame.f_code.co_filename.endswith(template):
            found = step.tb_lineno
        step = step.tb_next
    return found
