"""Actions of Python launch files. Their code runs: check files of strangers only where their code may run."""

from __future__ import annotations

import ast
import io
import os
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from types import MappingProxyType
from typing import Any
from unittest import mock

from check_launch.expansion import real_launch
from check_launch.expansion.actions import Action
from check_launch.expansion.entities import UnreadableFileError
from check_launch.expansion.launch_context import UNKNOWN_SHARE, Context, Packages
from check_launch.expansion.stand_ins import StandIns, actions_of
from check_launch.expansion.substitutions import UnknownTextError
from roverlink.generator.diagnostics import Span


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
        """Read the file. Raises `UnreadableFileError`."""
        self._path, self._shown, self._environment = path, shown, environment
        self._stand_ins = StandIns(path, shown, packages)
        try:
            self._tree = ast.parse(path.read_text(encoding="utf-8"), str(path))
        except (OSError, UnicodeDecodeError) as error:
            raise UnreadableFileError(Span(shown), f"cannot read the file: {error}") from error
        except SyntaxError as error:
            raise UnreadableFileError(
                Span(shown, error.lineno or 0, error.offset or 0), f"not valid Python: {error.msg}"
            ) from error
        names = (node.attr for node in ast.walk(self._tree) if isinstance(node, ast.Attribute))
        self._reads_environment = not {"getenv", "environ"}.isdisjoint(names)
        self._stand_ins.read(self._tree)

    def actions(self) -> list[Action]:
        """Run the file, and return its actions. Raises `UnreadableFileError` or `NeedsMoreError`."""
        names: dict[str, Any] = {"__name__": "launch_file", "__file__": str(self._path), "__builtins__": __builtins__}
        with self._running():
            exec(compile(self._tree, str(self._path), "exec"), names)  # noqa: S102  # a launch file is a program
            function = names.get("generate_launch_description")
            if function is None:
                raise UnreadableFileError(Span(self._shown), "the file has no function generate_launch_description")
            description = function()
            if description is None:
                raise UnreadableFileError(self._place_of(function), "generate_launch_description returns nothing")
            return actions_of(description)

    def _place_of(self, function: Any) -> Span:
        return Span(self._shown, function.__code__.co_firstlineno)

    def called(self, function: Any, context: Context) -> list[Action]:
        """Call a function of an OpaqueFunction, and return its actions.

        Raises `UnreadableFileError` or `NeedsMoreError`.
        """
        with self._running():
            return actions_of(function(context))

    @contextmanager
    def _running(self) -> Iterator[None]:
        """Let the file import the stand-ins, and turn its errors into ours."""
        modules = self._stand_ins.modules()
        hidden = {name: sys.modules.pop(name) for name in list(sys.modules) if name.partition(".")[0] in _REPLACED}
        before = set(sys.modules)
        path = list(sys.path)
        sys.modules.update({**(hidden if real_launch.is_installed() else {}), **modules})
        try:
            with redirect_stdout(io.StringIO()), mock.patch.dict(os.environ, self._environment):
                yield
        except (UnreadableFileError, UnknownTextError):
            raise
        except ModuleNotFoundError as error:
            raise NeedsMoreError(
                self._place(error), f"the file imports '{error.name}', which is not installed"
            ) from error
        except (Exception, SystemExit) as error:
            message = f"{type(error).__name__}: {error}"
            # A program, or a file that only the robot has, or that the build makes.
            is_missing = isinstance(error, FileNotFoundError)
            if (
                UNKNOWN_SHARE in message
                or _is_refusal(error)
                or ("NoneType" in message and self._reads_environment)
                or is_missing
                or (isinstance(error, KeyError) and "environ" in _source_of(error))
            ):
                raise NeedsMoreError(self._place(error), f"the file stops here: {message}") from error
            raise UnreadableFileError(self._place(error), f"the file stops here: {message}") from error
        finally:
            sys.path[:] = path
            for name in set(sys.modules) - before:
                if name.partition(".")[0] in _REPLACED or _is_beside(sys.modules[name], self._path.parent):
                    sys.modules.pop(name)
            sys.modules.update(hidden)

    def _place(self, error: BaseException) -> Span:
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(self._path)]
        return Span(self._shown, frames[-1].lineno or 0) if frames else Span(self._shown)


_REPLACED = frozenset({"launch", "launch_ros", "launch_xml", "launch_yaml", "nav2_common", "ament_index_python"})


def _is_beside(module: Any, folder: Path) -> bool:
    """Return true for a module of the launch file's folder; another file may have one with the same name."""
    file: str | None = getattr(module, "__file__", None)
    return file is not None and Path(file).is_relative_to(folder)


def _is_refusal(error: BaseException) -> bool:
    """Return true if a launch file itself refuses values of its arguments, or what it finds on this computer."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return (last.line or "").startswith(("raise ", "sys.exit", "exit("))


def _source_of(error: BaseException) -> str:
    return " ".join(frame.name + (frame.line or "") for frame in traceback.extract_tb(error.__traceback__))
