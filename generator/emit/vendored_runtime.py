"""The part of roverlink that runs a bridge, and the generated Python code, as files of the ROS 2 package.

With them, the folder of the package can be built in any workspace: nothing of roverlink, and nothing of the project,
has to be on the computer that builds or runs it. Of roverlink, the package gets the modules that ``roverlink run`` can
import, the files beside them, and the sources of the native core, which the package's CMakeLists.txt compiles.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, shipped
from roverlink.generator.emit.targets.ros2 import VENDOR

_ROOTS = ("roverlink.__main__", "roverlink.commands.run")
_CORE = ("native/flags", "native/include/roverlink/*.h", "native/src/*", "cpp/c/*")
_COMMENTS = {
    **dict.fromkeys((".py", ".yaml"), ("#", "")),
    **dict.fromkeys((".c", ".cpp", ".h", ".hpp", ".js"), ("//", "")),
    ".css": ("/*", " */"),
    ".html": ("<!--", " -->"),
}
"""Start and end of a comment, by the suffix of the file's name."""
_DATA = (".css", ".html", ".js", ".yaml")
"""Suffixes of the files beside modules that a bridge reads."""


def emit(bridge: ir.Bridge, generated: Mapping[str, str]) -> Files:
    """Yield the files; ``generated`` are the texts of all other generated files by path."""
    folder = f"{bridge.folder}/ros/{bridge.package}/{VENDOR}"
    own = {path: text for path, text in generated.items() if _is_python_code(path.removeprefix(f"{bridge.folder}/"))}
    for path, text in own.items():
        yield f"{folder}/project/{path}", text
    for file in sorted(_files(text for path, text in own.items() if path.endswith(".py"))):
        name = file.relative_to(shipped("")).as_posix()
        text = file.read_text(encoding="utf-8")
        if file.suffix:  # else it is the list of flags, which has no comments
            text = f"{header(f'roverlink/{name}', *_COMMENTS[file.suffix])}\n{text}"
        yield f"{folder}/runtime/roverlink/{name}", text


def _is_python_code(path: str) -> bool:
    """Return true for the path of a file, relative to the generated package, that a bridge needs at run time."""
    return path == "translations.json" or (path.endswith(".py") and not path.startswith("ros/"))


def _files(generated: Iterable[str]) -> set[Path]:
    """Return the files of roverlink that a bridge needs; ``generated`` are the texts of the generated modules."""
    root = shipped("")
    found = {path for pattern in _CORE for path in root.glob(pattern)}
    modules = set(_reached([*_ROOTS, *(name for text in generated for name in _imported(text))]))
    folders = {module.parent for module in modules if module.name == "__init__.py"}
    beside = {path for folder in folders for path in folder.iterdir() if path.suffix in _DATA}
    return found | modules | beside


def _reached(waiting: list[str]) -> Iterator[Path]:
    """Yield the modules of roverlink that some modules import, directly or not, also inside of functions."""
    seen = set[str]()
    while waiting:
        name = waiting.pop()
        path = _module(name)
        if name in seen or path is None:
            continue
        seen.add(name)
        yield path
        waiting += [name.rpartition(".")[0], *_imported(path.read_text(encoding="utf-8"))]


def _imported(text: str) -> Iterator[str]:
    """Yield the names that a module imports, which may be those of modules."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))


def _module(name: str) -> Path | None:
    """Return the file of a module of roverlink; None if it is of another package, or is no module."""
    first, *parts = name.split(".")
    if first != "roverlink":
        return None
    path = shipped("").joinpath(*parts)
    return next((file for file in (path / "__init__.py", Path(f"{path}.py")) if file.is_file()), None)
