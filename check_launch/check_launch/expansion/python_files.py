"""Actions of Python launch files. Their code runs: check files of strangers only where their code may run."""

from __future__ import annotations

import ast
import builtins
import errno
import io
import os
import re
import shutil
import subprocess
import sys
import traceback
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import CodeType, MappingProxyType
from typing import Any

from check_launch.expansion import real_launch
from check_launch.expansion.actions import Action
from check_launch.expansion.entities import UnreadableFileError
from check_launch.expansion.launch_context import UNKNOWN_SHARE, Context, Packages
from check_launch.expansion.launch_imports import Ignored, LaunchImports, imported_modules
from check_launch.expansion.stand_ins import StandIns, actions_of
from check_launch.expansion.substitutions import RUN_TIME, TooLongTextError, UnknownTextError
from roverlink import bounded_files
from roverlink.generator.diagnostics import Span

_FUNCTION = "generate_launch_description"
_OPEN, _FIND = open, shutil.which
_OF_CODE = (NameError, TypeError, AttributeError, ImportError)
_OF_VALUES = (LookupError, ValueError, OSError)
"""Errors of which the code is the cause, whoever raises them, and those that depend on values."""
_RAISE = re.compile(r"(?:^|[:;]\s*)raise\b")


class NeedsMoreError(Exception):
    """Raised if a launch file needs a package or a value that is not there; has the place."""

    def __init__(self, place: Span, message: str) -> None:
        super().__init__(message)
        self.place = place


class PythonFile:
    """A Python launch file, whose functions can be called."""

    def __init__(
        self, path: Path, shown: str, packages: Packages, environment: Mapping[str, str] = MappingProxyType({})
    ) -> None:
        """Read the file, without running it. Raises `UnreadableFileError`.

        ``environment`` has the variables that the rover's computer is known to have.
        """
        self._path, self._shown, self._packages = path, shown, packages
        self._stand_ins = StandIns(path, shown, packages)
        self._tree, self._code = _parsed(path, shown)
        self._declaration = line_of_launch_description(self._tree)
        if not self._declaration:
            raise UnreadableFileError(Span(shown), f"the file has no function {_FUNCTION}")
        self._stand_ins.read(self._tree)
        self._imported = dict(imported_modules(self._tree))
        self._missing: dict[str, int] = {}
        self._has_opened_unknown = False
        self._environment = _Environment(str(path), environment)

    def actions(self) -> list[Action]:
        """Run the file, and return its actions. Raises `UnreadableFileError` or `NeedsMoreError`."""
        names: dict[str, Any] = {"__name__": "launch_file", "__file__": str(self._path), "__builtins__": __builtins__}
        with self._running():
            exec(self._code, names)  # noqa: S102  # a launch file is a program
            found = names[_FUNCTION]()
            if found is None:
                raise UnreadableFileError(Span(self._shown, self._declaration), f"{_FUNCTION} returns None")
            if isinstance(found, Ignored):
                raise UnknownTextError(f"what {_FUNCTION} returns")
            if isinstance(found, list | tuple | Action):
                message = f"{_FUNCTION} returns no LaunchDescription: write LaunchDescription([...]) around the actions"
                raise UnreadableFileError(Span(self._shown, self._declaration), message)
            return actions_of(found)

    def called(self, function: Any, context: Context) -> list[Action]:
        """Call a function of an OpaqueFunction, and return its actions.

        Raises `UnreadableFileError` or `NeedsMoreError`.
        """
        with self._running():
            return actions_of(function(context))

    def missing_modules(self) -> Iterator[tuple[str, Span]]:
        """Yield the modules that the file has imported, and that are not there, each with its place."""
        for name, line in self._missing.items():
            yield name, Span(self._shown, line)

    @property
    def absent(self) -> Mapping[str, Span]:
        """Packages whose share folders the file has asked for, and that are not there, with the places."""
        return self._stand_ins.absent

    @contextmanager
    def _running(self) -> Iterator[None]:
        """Let the file import the stand-ins, and turn its errors into ours."""
        modules = self._stand_ins.modules()
        finder = LaunchImports(self._imported, modules, self._packages)
        hidden = {name: sys.modules.pop(name) for name in list(sys.modules) if name.partition(".")[0] in _REPLACED}
        before, path, environment = set(sys.modules), list(sys.path), os.environ
        sys.modules.update({**(hidden if real_launch.is_installed() else {}), **modules})
        sys.meta_path.append(finder)
        os.environ = self._environment  # type: ignore[assignment]  # noqa: B003  # what the system does not need
        exists, os.path.exists, os.path.isfile = (os.path.exists, os.path.isfile), _exists, _exists
        which, shutil.which = shutil.which, _which  # type: ignore[assignment]
        process, subprocess.Popen = subprocess.Popen, _Process  # type: ignore[misc]
        opened = io.open
        builtins.open = io.open = self._opened  # `pathlib` takes the one of io
        try:
            yield
        except UnreadableFileError:
            raise
        except TooLongTextError as error:
            raise UnreadableFileError(self._place(error), str(error)) from error
        except ModuleNotFoundError as error:
            raise NeedsMoreError(
                self._place(error), f"the file imports '{error.name}', which is not installed"
            ) from error
        except UnknownTextError as error:
            raise NeedsMoreError(
                self._place(error), f"the file needs '{error}', which is known at run time only"
            ) from error
        except (Exception, SystemExit, KeyboardInterrupt) as error:
            message = f"the file stops here: {type(error).__name__}: {error}"
            if needed := self._needed(error, {**self._missing, **finder.missing}):
                raise NeedsMoreError(self._place(error), f"{message} ({needed})") from error
            raise UnreadableFileError(self._place(error), message) from error
        finally:
            self._missing |= finder.missing
            os.environ = environment  # noqa: B003
            os.path.exists, os.path.isfile = exists
            shutil.which, subprocess.Popen = which, process  # type: ignore[misc]
            builtins.open = io.open = opened
            sys.meta_path.remove(finder)
            sys.path[:] = path
            for name in set(sys.modules) - before:
                module = sys.modules[name]
                is_made = getattr(module, "__loader__", None) is finder
                if is_made or name.partition(".")[0] in _REPLACED or _is_beside(module, self._path.parent):
                    sys.modules.pop(name)
            sys.modules.update(hidden)

    def _opened(self, file: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
        """Open a file. What stands in one of a package that is not here is known at run time only."""
        if UNKNOWN_SHARE not in str(file):
            return _OPEN(file, mode, *arguments, **options)
        self._has_opened_unknown = True
        return io.BytesIO(RUN_TIME.encode()) if "b" in mode else io.StringIO(RUN_TIME)

    def _needed(self, error: BaseException, missing: dict[str, int]) -> str:
        """Return what is not there, if the file may have stopped for this reason; empty if nothing is missing."""
        if missing:
            return f"'{next(iter(missing))}' is not installed"
        if self._environment.missing:
            return f"the environment has no variable {self._environment.missing[0]}"
        if isinstance(error, AttributeError) and type(error.obj).__module__.startswith("check_launch."):
            return "the stand-in of this object does not have it"
        if isinstance(error, ImportError) and not self._packages.holds(error.path or ""):
            return f"perhaps another '{error.name}' is installed where ROS 2 is"
        if isinstance(error, EOFError) or any(getattr(node, "attr", "") == "argv" for node in ast.walk(self._tree)):
            return "it reads what a user types"
        if isinstance(error, NameError) and any(getattr(node, "name", "") == "*" for node in ast.walk(self._tree)):
            return "perhaps a module gives it, of which the file imports all names"
        text = str(error)
        if RUN_TIME in text or UNKNOWN_SHARE in text or self._has_opened_unknown or _Process.is_replaced:
            return "a file or text is not here"
        if isinstance(error, FileNotFoundError):  # perhaps one that the robot has, or that the build makes
            return "a file is not here"
        if isinstance(error, OSError) and error.errno == errno.EFBIG:
            return ""  # the limit of this check
        last = traceback.extract_tb(error.__traceback__)[-1]
        is_own = last.filename == str(self._path) or self._packages.holds(last.filename)
        if isinstance(error, SystemExit) or (is_own and _RAISE.search(last.line or "")):
            return "the launch file itself refuses to go on"  # with values of arguments, or on this computer
        is_of_code = isinstance(error, _OF_CODE) or (is_own and not isinstance(error, _OF_VALUES))
        return "" if is_of_code else "perhaps with these values of arguments, or on this computer, only"

    def _place(self, error: BaseException) -> Span:
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(self._path)]
        return Span(self._shown, frames[-1].lineno or 0) if frames else Span(self._shown)


class _Environment(dict[str, str]):
    """The variables of the environment for a launch file; those that are not set are known at run time only."""

    def __init__(self, file: str, known: Mapping[str, str]) -> None:
        super().__init__({**os.environ, **known})
        self._file = file
        self.missing: list[str] = []
        """Variables that the launch file has asked for, and that are not set."""

    def __missing__(self, name: object) -> str:
        if not isinstance(name, str):  # the standard library looks for bytes, too
            raise KeyError(name)
        self._note(name)
        return RUN_TIME

    def get(self, name: str, default: Any = None) -> Any:
        """Return a variable, or the default."""
        if name not in self and default is None:
            self._note(name)
        return super().get(name, default)

    def copy(self) -> dict[str, str]:
        """Return the variables that are set."""
        return dict(self)

    def _note(self, name: str) -> None:
        callers = (sys._getframe(2), sys._getframe(2).f_back)  # the launch file may call `os.getenv`
        if any(frame is not None and frame.f_code.co_filename == self._file for frame in callers):
            self.missing.append(name)


def _parsed(path: Path, shown: str) -> tuple[ast.Module, CodeType]:
    try:
        return _compiled(bounded_files.read(path), str(path))
    except OSError as error:
        raise UnreadableFileError(Span(shown), f"cannot read the file: {error.strerror or error}") from error
    except SyntaxError as error:
        place = Span(shown, error.lineno or 0, error.offset or 0)
        raise UnreadableFileError(place, f"not valid Python: {error.msg}") from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise UnreadableFileError(Span(shown), f"not valid Python: {error}") from error


@cache  # the parent process parses the files, and each child needs some of them
def _compiled(source: bytes, path: str) -> tuple[ast.Module, CodeType]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of escapes in a stranger's texts
        tree = ast.parse(source, path)
        # It refuses more than the grammar, such as an argument that is given twice. With `dont_inherit`, the
        # `annotations` of this module are not those of the file.
        return tree, compile(tree, path, "exec", dont_inherit=True)


def line_of_launch_description(tree: ast.Module) -> int:
    """Return the line of the function that `ros2 launch` calls; 0 for a Python file without it, which does not run."""
    lines = (
        node.lineno
        for node in ast.walk(tree)
        if (isinstance(node, ast.FunctionDef) and node.name == _FUNCTION)
        or (isinstance(node, ast.alias) and _FUNCTION in (node.name, node.asname))
        or (isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id == _FUNCTION)
    )
    return next(lines, 0)


def is_python(path: Path) -> bool:
    """Return true for a file that `ros2 launch` reads as Python: any that declares the function and is no XML."""
    if path.suffix != ".launch":
        return path.suffix == ".py"
    try:
        text = bounded_files.read(path).lstrip()
    except OSError:
        return False
    return not text.startswith(b"<") and f"def {_FUNCTION}(".encode() in text


def is_launch_program(path: Path) -> bool:
    """Return true if a Python file can be read, and declares the function that `ros2 launch` calls."""
    try:
        return line_of_launch_description(_parsed(path.resolve(), str(path))[0]) > 0
    except UnreadableFileError:
        return True  # so that the check says why


_REPLACED = frozenset({"launch", "launch_ros", "launch_xml", "launch_yaml", "nav2_common", "ament_index_python"})


def _exists(path: Any) -> bool:
    """Return true for a file, and for one of a package that is not here: it is not known to be absent."""
    return UNKNOWN_SHARE in str(path) or RUN_TIME in str(path) or os.access(path, os.F_OK)


def _which(program: str, *arguments: Any, **options: Any) -> str:
    """Return the path of a program; that of one that is not installed here is known on the rover's computer only."""
    return _FIND(program, *arguments, **options) or RUN_TIME


class _Process(subprocess.Popen[Any]):
    """A process; instead of a program that is not installed here, one whose output is known at run time only."""

    is_replaced = False
    """True if a program is not installed here."""

    def __init__(self, args: Any, *rest: Any, **options: Any) -> None:
        try:
            super().__init__(args, *rest, **options)
        except FileNotFoundError:
            super().__init__(["echo", RUN_TIME], *rest, **options)  # raises if the folder is not there
            _Process.is_replaced = True


def _is_beside(module: Any, folder: Path) -> bool:
    """Return true for a module of the launch file's folder; another file may have one with the same name."""
    file: str | None = getattr(module, "__file__", None)
    return file is not None and Path(file).is_relative_to(folder)
