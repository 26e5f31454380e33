"""State of the expansion of a launch file: the values of arguments, and the places of packages."""

from __future__ import annotations

import os
import re
import tempfile
from collections import UserDict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from check_launch.expansion.source_trees import source_folders
from check_launch.expansion.substitutions import UnknownTextError, text_of
from roverlink import bounded_files
from roverlink.generator.diagnostics import Span

_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_DEPENDENCY = re.compile(r"<\w*depend\b[^>]*>\s*([\w-]+)\s*</")
_DEPTH = 8  # folders below the top in which packages are searched
UNKNOWN_SHARE = "/share-folder-of/"
"""Beginning of the path that stands for the share folder of a package that is not there."""


class Packages:
    """Share folders of packages: of source trees, and of an installed ROS 2."""

    def __init__(self, tops: Iterable[Path]) -> None:
        """``tops`` are folders in which packages are searched, such as the top of a repository."""
        self._tops = tuple(dict.fromkeys(top.resolve() for top in tops))
        found = list(dict.fromkeys(_packages_in(self._tops)))
        self.folders = dict(found)
        """Folders of the packages in source trees, by the names of the packages."""
        self.copies = {name: [other for same, other in found if same == name] for name in self.folders}
        """All folders of each package: a repository may have several versions of one."""
        self._dependencies: dict[Path, frozenset[str]] = {}

    def share(self, package: str) -> str:
        """Return the share folder of a package; for an unknown package, a path that does not exist."""
        if package in self.folders:
            return str(self.folders[package])
        for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
            folder = Path(prefix) / "share" / package
            if folder.is_dir():
                return str(folder)
        return f"{UNKNOWN_SHARE}{package}"

    def prefixes(self) -> list[str]:
        """Return a folder with the name of each package of the source trees, as AMENT_PREFIX_PATH has after colcon."""
        return [str(folder.with_name(name)) for name, folder in self.folders.items()]

    def prefer(self, path: Path) -> None:
        """Take the folders that are the nearest to a launch file for packages that are there in several versions."""
        for name, folders in self.copies.items():
            self.folders[name] = max(folders, key=lambda folder: len(os.path.commonpath([folder, path])))

    def has(self, package: str) -> bool:
        """Return true if the source trees have a package."""
        return package in self.folders

    def dependencies(self, path: str) -> frozenset[str]:
        """Return the packages that the manifest of a file's package names."""
        top = next((folder for folder in Path(path).parents if (folder / "package.xml").is_file()), None)
        if top is not None and top not in self._dependencies:
            self._dependencies[top] = frozenset(_DEPENDENCY.findall(_text(top / "package.xml")))
        return self._dependencies[top] if top is not None else frozenset()

    def holds(self, path: str) -> bool:
        """Return true for a path below the folders in which packages are searched."""
        return any(Path(path).is_relative_to(top) for top in self._tops)

    def is_temporary(self, path: str) -> bool:
        """Return true for a file in the folder for temporary files, unless the checked packages are there."""
        folders = "/tmp", tempfile.gettempdir()  # noqa: S108  # only compared
        return any(map(Path(path).is_relative_to, folders)) and not self.holds(path)

    def python_folder(self, package: str) -> Path | None:
        """Return the folder from which the Python package of a ROS 2 package can be imported; None if there is none."""
        if package not in self.folders:
            return None
        top = self.folders[package]
        return next((one for one in (top, top / "src", top / "python") if any((one / package).glob("*.py"))), None)

    @cached_property
    def _beside(self) -> Mapping[str, list[Path]]:
        """Files that are in no package, by their names."""
        found: dict[str, list[Path]] = {}
        for top in self._tops:
            for folder, inner, names in source_folders(top):
                if "package.xml" in names or len(folder.relative_to(top).parts) >= _DEPTH:
                    inner.clear()
                for name in names if "package.xml" not in names else ():
                    found.setdefault(name, []).append(folder / name)
        return found

    def existing(self, path: str, folder: str = "") -> str:
        """Return the path of a file; a relative one is searched in a folder, and where users run `ros2 launch`.

        In a source tree, a file may be in another folder than in the share folder, or beside the package.
        """
        candidates = [os.path.normpath(os.path.join(start, path)) for start in (folder, "", *map(str, self._tops))]
        if found_there := next(filter(os.path.exists, candidates), None):
            return found_there
        path = candidates[0]
        for share in self.folders.values():
            if Path(path).is_relative_to(share):
                name = os.path.basename(path)
                found = list(share.rglob(name)) or self._beside.get(name, [])
                return str(found[0]) if len(found) == 1 else path
        return path


def _packages_in(tops: Iterable[Path]) -> Iterator[tuple[str, Path]]:
    """Yield the packages in folders; those of the first folder come last, and so have the last word."""
    for top in reversed(list(tops)):
        for folder, inner, files in source_folders(top):
            if "package.xml" in files:
                if name := _NAME.search(_text(folder / "package.xml")):
                    yield name[1], folder
                inner.clear()
            elif len(folder.relative_to(top).parts) >= _DEPTH:
                inner.clear()


def _text(manifest: Path) -> str:
    try:
        return bounded_files.read(manifest).decode(errors="replace")
    except OSError:
        return ""


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
    parameters: list[Any] = field(default_factory=list)  # None for a file that is not known
    place: Span = field(default_factory=lambda: Span(""))
    """Place of the action that is being expanded."""
    undeclared: list[tuple[str, Span]] = field(default_factory=list)
    """Arguments that are used, and that no launch file declares, each with the place of its use."""

    sources: dict[str, str] = field(default_factory=dict)
    """Files in which texts were replaced, by the temporary files with the result."""
    absent: dict[str, Span] = field(default_factory=dict)
    """Packages whose share folders are used, and that are not there, with the places of their use."""

    def share(self, package: str) -> str:
        """Return the share folder of a package, and note that it is used."""
        found = self.packages.share(package)
        if package_of_share(found):
            self.absent.setdefault(package, self.place)
        return found

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
