"""Executables and components of a ROS 2 package, from its CMakeLists.txt or setup.py."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass, replace
from pathlib import Path

from check_launch.extraction.class_facts import ClassFacts

_COMMENT = re.compile(r"#[^\n]*")
_CALL = re.compile(r"\b(\w+)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)")
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_WORD = re.compile(r'"([^"]*)"|([^\s"]+)')
_ENTRY_POINT = re.compile(r"^\s*([\w.-]+)\s*=\s*([\w.]+):[\w.]+\s*$", re.MULTILINE)
_NAME = re.compile(r"[\w.:-]+")
_OPEN = frozenset({"foreach", "macro", "function", "while"})
"""Commands of CMake whose executables may have other names than the text says."""
_BUILDING = frozenset({"add_executable", "ament_auto_add_executable"})
_MAIN = re.compile(r"\bmain\s*\(")
_MADE = re.compile(r"(?:make_shared|make_unique)\s*<\s*([\w:]+)")


@dataclass(frozen=True, slots=True)
class BuiltProgram:
    """An executable of a package."""

    name: str
    class_name: str = ""
    """Class of the node in C++, as it is written; empty if it is not known."""
    module: str = ""
    """Module that a Python program runs, such as ``my_package.camera``; empty for other programs."""


@dataclass(frozen=True, slots=True)
class Built:
    """Programs and components that the build of a package makes."""

    programs: list[BuiltProgram]
    components: list[str]
    """Classes that the package registers as components."""
    is_partial: bool
    """True if there may be more executables, with names that the text of the files does not say."""
    words: set[str]
    """Words in the text of the files."""


def built_by(folder: Path, classes: Mapping[str, ClassFacts], build_type: str) -> Built:
    """Return what the build of the package in a folder makes.

    ``classes`` are the classes of the package, to find the one that a program's main function uses. ``build_type`` is
    that of its manifest, or empty: nothing runs the setup.py of an ament_cmake package, or the CMakeLists.txt of an
    ament_python one.
    """
    bases = {_short(name): {*map(_short, facts.bases)} for name, facts in classes.items()}
    nodes = {name for name, of in bases.items() if any(base.endswith("Node") for base in of)}
    while more := {name for name, of in bases.items() if of & nodes} - nodes:
        nodes |= more
    reader = _Build(folder, {_short(name): name for name in classes}, nodes)
    for path in sorted(folder.rglob("CMakeLists.txt")) if build_type != "ament_python" else ():
        if not {"test", "benchmark"} & set(path.relative_to(folder).parts):
            reader.read(path)
    for name in ("setup.cfg",) if build_type == "ament_cmake" else ("setup.py", "setup.cfg"):
        if (folder / name).is_file():
            reader.read_entry_points((folder / name).read_text(encoding="utf-8", errors="replace"), name)
    is_other = not any((folder / name).is_file() for name in ("CMakeLists.txt", "setup.py"))
    spelled = {reader.names.get(target, target): program for target, program in reader.programs.items()}
    programs = [replace(program, name=name) for name, program in spelled.items() if "$" not in name]
    is_partial = is_other or reader.is_partial or len(programs) < len(spelled)
    return Built(
        sorted(programs, key=lambda program: program.name), sorted(set(reader.components)), is_partial, reader.words
    )


def _short(class_name: str) -> str:
    return class_name.rpartition("::")[2]


class _Build:
    """Reader of the CMakeLists.txt of a package."""

    def __init__(self, folder: Path, short: Mapping[str, str], nodes: Set[str]) -> None:
        self._folder, self._short, self._nodes = folder, short, nodes
        self.programs: dict[str, BuiltProgram] = {}
        self.components: list[str] = []
        self.names: dict[str, str] = {}
        self.is_partial = False
        self.words: set[str] = set()
        self._read: set[Path] = set()

    def read(self, path: Path) -> None:
        """Add what a CMakeLists.txt builds, with the files of the package that it includes."""
        self._read_part(path, path.parent, {"PROJECT_NAME": self._folder.name})

    def _read_part(self, path: Path, folder: Path, variables: dict[str, str]) -> None:
        text = _COMMENT.sub("", path.read_text(encoding="utf-8", errors="replace"))
        self.words |= set(_NAME.findall(text))
        for function, words in _calls(text, variables):
            if function in _OPEN:
                self.is_partial = True
            elif function == "set" and len(words) > 1:
                variables[words[0]] = words[1]
            elif function == "project" and words:
                variables["PROJECT_NAME"] = words[0]
            elif function == "include" and words:
                self._include(words[0], folder, variables)
            elif function in _BUILDING and "IMPORTED" not in words and words:
                self.programs[words[0]] = BuiltProgram(words[0], self._class_of(folder, words[1:]))
            elif function == "set_target_properties" and "OUTPUT_NAME" in words:
                self.names[words[0]] = words[words.index("OUTPUT_NAME") + 1]
            elif function == "rclcpp_components_register_nodes":
                self.components += words[1:]
            elif function == "rclcpp_components_register_node" and "PLUGIN" in words:
                class_name = words[words.index("PLUGIN") + 1]
                self.components.append(class_name)
                if "EXECUTABLE" in words:
                    name = words[words.index("EXECUTABLE") + 1]
                    self.programs[name] = BuiltProgram(name, class_name)
            elif function == "install" and words:
                self._installed(folder, words)

    def _include(self, name: str, folder: Path, variables: dict[str, str]) -> None:
        """Read an included file, wherever in the package it is: CMAKE_MODULE_PATH, or a path, says where."""
        found = sorted(self._folder.rglob(f"{Path(name).name.removesuffix('.cmake')}.cmake"))
        self.is_partial |= not found and name.endswith(".cmake")
        for path in [path for path in found if path not in self._read]:
            self._read.add(path)
            self._read_part(path, folder, variables)

    def read_entry_points(self, text: str, name: str) -> None:
        """Add the programs of a setup.py or setup.cfg."""
        self.words |= set(_NAME.findall(_COMMENT.sub("", text)))
        texts = [text]
        if name == "setup.py":
            try:
                tree = ast.parse(text)
            except (SyntaxError, ValueError, RecursionError):
                self.is_partial = True
                return
            # The syntax tree joins texts that stand side by side. A text that is put together, or a file that is
            # copied to lib/, may be one more program.
            texts = list(_texts_in(tree))
            computed = (node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr | ast.BinOp))
            self.is_partial |= any(":" in part for node in computed for part in _texts_in(node))
            self.is_partial |= any(part == "lib" or part.startswith("lib/") for part in texts)
        found = [entry for part in texts for entry in _ENTRY_POINT.findall(part)]
        self.programs |= {program: BuiltProgram(program, module=module) for program, module in found}

    def _class_of(self, folder: Path, files: Iterable[str]) -> str:
        """Return the class of the node that a program's main function creates: not of what the node gets."""
        paths = [folder / name for name in files]
        texts = [path.read_text(encoding="utf-8", errors="replace") for path in paths if path.is_file()]
        for text in [text for text in texts if _MAIN.search(text)] or texts:
            begin = _MAIN.search(text)
            main = text[begin.start() if begin else 0 :]
            words = [self._short[word] for word in re.findall(r"\b(\w+)\s+\w+\s*[({;]", main) if word in self._short]
            made: list[str] = [*_MADE.findall(main), *_MADE.findall(text), *words]
            if made:
                return next((name for name in made if _short(name) in self._nodes), made[0])
        return ""

    def _installed(self, folder: Path, words: list[str]) -> None:
        """Add the scripts that a package installs as programs."""
        destination = words[words.index("DESTINATION") + 1] if "DESTINATION" in words[:-1] else ""
        if "lib/" not in destination and not destination.startswith("$"):
            return
        if "RENAME" in words or words[0] in ("DIRECTORY", "FILES"):
            self.is_partial = True
        if words[0] == "PROGRAMS":
            for word in words[1 : words.index("DESTINATION")]:
                path = Path(word)
                inside = (folder / path).relative_to(self._folder) if not path.is_absolute() else path
                module = ".".join(inside.with_suffix("").parts) if path.suffix == ".py" else ""
                self.programs[path.name] = BuiltProgram(path.name, module=module)


def _texts_in(node: ast.AST) -> Iterator[str]:
    for part in ast.walk(node):
        if isinstance(part, ast.Constant) and isinstance(part.value, str):
            yield part.value


def _calls(text: str, variables: Mapping[str, str]) -> Iterator[tuple[str, list[str]]]:
    for match in _CALL.finditer(text):
        words = [quoted or plain for quoted, plain in _WORD.findall(match[2])]
        yield match[1].lower(), [_VARIABLE.sub(lambda found: variables.get(found[1], found[0]), word) for word in words]
