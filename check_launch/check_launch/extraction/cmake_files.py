"""Executables and components of a ROS 2 package, from its CMakeLists.txt or setup.py."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

_COMMENT = re.compile(r"#[^\n]*")
_CALL = re.compile(r"\b(\w+)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)")
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_WORD = re.compile(r'"([^"]*)"|([^\s"]+)')
_ENTRY_POINT = re.compile(r"['\"]\s*([\w-]+)\s*=\s*[\w.]+:\w+\s*['\"]")
_MADE = re.compile(r"(?:make_shared|make_unique)\s*<\s*([\w:]+)")


@dataclass(frozen=True, slots=True)
class BuiltProgram:
    """An executable of a package, with the class of its node as it is written (empty if it is not known)."""

    name: str
    class_name: str


def programs_and_components(folder: Path, classes: Iterable[str]) -> tuple[list[BuiltProgram], list[str]]:
    """Return the executables of the package in a folder, and the classes that it registers as components.

    ``classes`` are the classes of the package, to find the one that a program's main function uses.
    """
    programs: dict[str, str] = {}
    components: list[str] = []
    names: dict[str, str] = {}
    short = {name.rpartition("::")[2]: name for name in classes}
    for path in sorted(folder.rglob("CMakeLists.txt")):
        if "test" in path.relative_to(folder).parts or "benchmark" in path.relative_to(folder).parts:
            continue
        variables = {"PROJECT_NAME": folder.name}
        for function, words in _calls(path.read_text(encoding="utf-8", errors="replace"), variables):
            if function == "set" and len(words) > 1:
                variables[words[0]] = words[1]
            elif function == "project" and words:
                variables["PROJECT_NAME"] = words[0]
            elif function == "add_executable" and "IMPORTED" not in words and len(words) > 1:
                programs[words[0]] = _class_of(path.parent, words[1:], short)
            elif function == "set_target_properties" and "OUTPUT_NAME" in words:
                names[words[0]] = words[words.index("OUTPUT_NAME") + 1]
            elif function == "rclcpp_components_register_nodes":
                components += words[1:]
            elif function == "rclcpp_components_register_node" and "PLUGIN" in words:
                class_name = words[words.index("PLUGIN") + 1]
                components.append(class_name)
                if "EXECUTABLE" in words:
                    programs[words[words.index("EXECUTABLE") + 1]] = class_name
            elif function == "install" and words and words[0] == "PROGRAMS":
                programs |= {Path(word).name: "" for word in words[1:] if word.endswith(".py")}
    setup = folder / "setup.py"
    if setup.is_file():
        programs |= dict.fromkeys(_ENTRY_POINT.findall(setup.read_text(encoding="utf-8")), "")
    spelled = {names.get(target, target): class_name for target, class_name in programs.items()}
    built = [BuiltProgram(name, class_name) for name, class_name in spelled.items() if "$" not in name]
    return sorted(built, key=lambda program: program.name), sorted(set(components))


def _calls(text: str, variables: Mapping[str, str]) -> Iterator[tuple[str, list[str]]]:
    for match in _CALL.finditer(_COMMENT.sub("", text)):
        words = [quoted or plain for quoted, plain in _WORD.findall(match[2])]
        yield match[1].lower(), [_VARIABLE.sub(lambda found: variables.get(found[1], found[0]), word) for word in words]


def _class_of(folder: Path, files: Iterable[str], short: Mapping[str, str]) -> str:
    """Return the class of the node that a program's main function creates."""
    for name in files:
        path = folder / name
        if not path.is_file():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if made := _MADE.search(text):
            return made[1]
        main = text[max(0, text.find("main(")) :]
        for word in re.findall(r"\b(\w+)\s+\w+\s*[({;]", main):
            if word in short:
                return short[word]
    return ""
