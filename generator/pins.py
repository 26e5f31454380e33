"""Which commit of the protos each consumer is pinned to: git submodules, CMake's FetchContent, or a plain list."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from generator.findings import Finding, Rule, Severity, Span
from generator.git import GitError, Repository

UNREADABLE_PINS = Rule("PIN101", "unreadable-pins", Severity.FATAL)

_CMAKE = ("CMakeLists.txt", ".cmake")
_DECLARE = re.compile(r"\b(?:FetchContent_Declare|ExternalProject_Add)\s*\((?P<body>[^()]*)\)", re.IGNORECASE)
_LIST_LINE = re.compile(r"(?P<name>\S+)[ \t:=]+(?P<commit>\S+)\s*(#.*)?")
_SUBMODULE = "160000"  # the mode of a submodule in a tree


@dataclass(frozen=True, slots=True)
class Pin:
    """A consumer, and the commit that it takes the protos from."""

    consumer: str
    commit: str
    """As it is written: a commit, a tag or a branch."""
    span: Span
    listed: bool = False
    """Whether a plain list says that it is the protos'; of other sources, only what this repository knows is."""


def read_pins(sources: Iterable[Path], findings: list[Finding]) -> tuple[Pin, ...]:
    """The pins in files and in repositories; one without any is a finding."""
    pins: list[Pin] = []
    for source in sources:
        found = list(_pins_of(source, findings))
        if not found:
            message = "no pin was found: no submodule, no FetchContent with a GIT_TAG, no line `name commit`"
            findings.append(UNREADABLE_PINS.at(Span(str(source)), message))
        pins += found
    return tuple(pins)


def _pins_of(source: Path, findings: list[Finding]) -> Iterator[Pin]:
    if not source.is_dir():
        yield from _pins_in_file(source, findings)
        return
    name = source.resolve().name
    yield from _submodules(source, name)
    for path in sorted(path for path in source.rglob("*") if path.name.endswith(_CMAKE) and path.is_file()):
        yield from _cmake_pins(path, _text(path, findings), name)


def _pins_in_file(path: Path, findings: list[Finding]) -> Iterator[Pin]:
    text = _text(path, findings)
    if path.name.endswith(_CMAKE):
        yield from _cmake_pins(path, text, path.resolve().parent.name)
        return
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            match = _LIST_LINE.fullmatch(line.strip())
            if match:
                yield Pin(match["name"], match["commit"], Span(str(path), number, 1), listed=True)
            else:
                findings.append(UNREADABLE_PINS.at(Span(str(path), number, 1), f"no `name commit`: {line.strip()!r}"))


def _text(path: Path, findings: list[Finding]) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        findings.append(UNREADABLE_PINS.at(Span(str(path)), f"cannot be read: {error.strerror}"))
        return ""


def _cmake_pins(path: Path, text: str, consumer: str) -> Iterator[Pin]:
    """The GIT_TAG of each declaration; comments do not count."""
    bare = re.sub(r"#[^\n]*", lambda match: " " * len(match[0]), text)
    for declared in _DECLARE.finditer(bare):
        words = declared["body"].split()
        if "GIT_TAG" in words[:-1]:
            tag = words[words.index("GIT_TAG") + 1].strip('"')
            line = bare.count("\n", 0, bare.index("GIT_TAG", declared.start())) + 1
            yield Pin(f"{consumer}/{words[0]}", tag, Span(str(path), line, 1))


def _submodules(folder: Path, consumer: str) -> Iterator[Pin]:
    repository = Repository(folder)
    try:
        listed = repository.entries("HEAD")
    except GitError:
        return
    for mode, object_id, path in listed:
        if mode == _SUBMODULE:
            yield Pin(f"{consumer}/{path}", object_id, Span(str(folder / ".gitmodules")))
