"""State of the expansion of a launch file: the values of arguments, and the places of packages."""

from __future__ import annotations

import os
import re
from collections import UserDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from check_launch.expansion.substitutions import UnknownTextError, text_of
from roverlink.generator.diagnostics import Span

_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_SKIPPED = frozenset({"build", "install", "log", "node_modules", "__pycache__"})
_DEPTH = 5  # folders below the top in which packages are searched
UNKNOWN_SHARE = "/share-folder-of/"
"""Beginning of the path that stands for the share folder of a package that is not there."""


class Packages:
    """Share folders of packages: of source trees, and of an installed ROS 2."""

    def __init__(self, tops: Iterable[Path]) -> None:
        """``tops`` are folders in which packages are searched, such as the top of a repository."""
        self._tops = list(dict.fromkeys(top.resolve() for top in tops))
        self._found: dict[str, Path] | None = None

    def share(self, package: str) -> str:
        """Return the share folder of a package; for an unknown package, a path that does not exist."""
        if self._found is None:
            self._found = dict(self._search())
        if package in self._found:
            return str(self._found[package])
        for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
            folder = Path(prefix) / "share" / package
            if folder.is_dir():
                return str(folder)
        return f"{UNKNOWN_SHARE}{package}"

    def existing(self, path: str, folder: str = "") -> str:
        """Return the path of a file; a relative one is searched in a folder, and where users run `ros2 launch`.

        In a source tree, a file may be in another folder than in the share folder.
        """
        candidates = [os.path.normpath(os.path.join(start, path)) for start in (folder, "", *map(str, self._tops))]
        if found_there := next(filter(os.path.exists, candidates), None):
            return found_there
        path = candidates[0]
        for share in (self._found or {}).values():
            if Path(path).is_relative_to(share):
                found = list(share.rglob(os.path.basename(path)))
                return str(found[0]) if len(found) == 1 else path
        return path

    def holds(self, path: str) -> bool:
        """Return true for a path below the folders in which packages are searched."""
        return any(Path(path).is_relative_to(top) for top in self._tops)

    def _search(self) -> Iterator[tuple[str, Path]]:
        for top in reversed(self._tops):
            for folder, inner, files in os.walk(top):
                depth = len(Path(folder).relative_to(top).parts)
                if "package.xml" in files:
                    path = Path(folder)
                    if name := _NAME.search((path / "package.xml").read_text(encoding="utf-8", errors="replace")):
                        yield name[1], path
                    inner.clear()
                elif depth >= _DEPTH:
                    inner.clear()
                inner[:] = sorted(name for name in inner if not name.startswith(".") and name not in _SKIPPED)


def package_of_share(path: str) -> tuple[str, str] | None:
    """Return the package and the path in its share folder, for a path below a share folder that is not there."""
    if not path.startswith(UNKNOWN_SHARE):
        return None
    package, _, rest = path.removeprefix(UNKNOWN_SHARE).partition("/")
    return package, os.path.normpath(rest) if rest else ""


class _Configurations(UserDict[str, Any]):
    """Values of arguments for functions of Python launch files, which cannot go on without the value."""

    def __init__(self, values: dict[str, str | None]) -> None:
        super().__init__()
        self.data = values

    def __getitem__(self, name: str) -> str:
        value: str | None = self.data[name]
        if value is None:
            raise UnknownTextError(name)
        return value


@dataclass(slots=True)
class Context:
    """State that the actions of a launch file read and change. It is also the context that its functions get."""

    packages: Packages
    configurations: dict[str, str | None] = field(default_factory=dict)
    """Value of each argument and variable; None if only the user knows it."""
    environment: dict[str, str] = field(default_factory=dict)
    file: str = ""
    """Path of the launch file that was included last."""
    namespace: str = ""
    remappings: list[Any] = field(default_factory=list)
    parameters: list[Any] = field(default_factory=list)
    place: Span = field(default_factory=lambda: Span(""))
    """Place of the action that is being expanded."""
    undeclared: list[tuple[str, Span]] = field(default_factory=list)
    """Arguments that are used, and that no launch file declares, each with the place of its use."""

    def missing(self, name: str) -> None:
        """Note that an argument is used that nothing declares."""
        self.undeclared.append((name, self.place))

    @property
    def launch_configurations(self) -> _Configurations:
        """The name that functions of Python launch files use."""
        return _Configurations(self.configurations)

    def perform_substitution(self, substitution: Any) -> str:
        """Return the text of a substitution, for functions of Python launch files."""
        return text_of(substitution, self)
