"""Pins: a pin says which commit of the .proto files another project, the consumer, uses.

Pins are read from git submodules, from FetchContent in CMake files, or from a text file with one pin in each line.
"""

from __future__ import annotations

import configparser
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.git import SUBMODULE, GitError, Repository
from roverlink.generator.lint.input_rules import UnreadablePins

_CMAKE = ("CMakeLists.txt", ".cmake")
_SET = re.compile(r"\bset\s*\(\s*(?P<name>\w+)\s+\"?(?P<value>[^\s\")]+)", re.IGNORECASE)
_VARIABLE = re.compile(r"\$\{(\w+)\}")
_COMMENT = re.compile(r"(\"(?:\\.|[^\"\\])*\")|#[^\n]*")
_DECLARE = re.compile(r"\b(?:FetchContent_Declare|ExternalProject_Add)\s*\((?P<body>[^()]*)\)", re.IGNORECASE)
_LIST_LINE = re.compile(r"(?P<name>\S*[^\s:=])[ \t:=]+(?P<commit>\S+)\s*(#.*)?")


@dataclass(frozen=True, slots=True)
class Pin:
    """A project that uses the .proto files (the consumer), and the commit of the .proto files that it uses."""

    consumer: str
    commit: str
    """The commit as the source of the pin writes it: an id, a tag or a branch."""
    span: Span
    source: str
    """The file or the repository from which the pin was read."""
    listed: bool = False
    """True if the pin was read from a text file with one pin in each line.

    Such a file only has pins of the .proto files. Submodules and CMake files pin other repositories, too.
    """
    address: str = ""
    """The address (URL) of the repository whose commit is pinned; empty if it is unknown."""


def read_pins(sources: Iterable[Path], findings: list[Diagnostic]) -> tuple[Pin, ...]:
    """Read the pins from files and repositories. A source without any pin is reported in ``findings``."""
    pins: list[Pin] = []
    for source in sources:
        read = len(findings)
        found = list(_pins_of(source, findings))
        if not found and len(findings) == read:
            message = "the file or folder contains no pinned commit"
            help = "name a repository with a submodule or a FetchContent with GIT_TAG, or a file of lines `name commit`"
            findings.append(UnreadablePins.at(Span(str(source)), message, help))
        pins += found
    return tuple(pins)


def _pins_of(source: Path, findings: list[Diagnostic]) -> Iterator[Pin]:
    if not source.is_dir():
        yield from _pins_in_file(source, findings)
        return
    name = source.resolve().name
    yield from _submodules(source, name)

    def unread(path: str, fault: str) -> None:
        findings.append(UnreadablePins.at(Span(str(source / path)), fault))

    paths = [source / path for path in source_files.walk(source, unread) if path.endswith(_CMAKE)]
    yield from _cmake_pins({path: _text(path, findings) for path in paths}, source, name)


def _pins_in_file(path: Path, findings: list[Diagnostic]) -> Iterator[Pin]:
    text = _text(path, findings)
    if path.name.endswith(_CMAKE):
        yield from _cmake_pins({path: text}, path, path.resolve().parent.name)
        return
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() and not line.lstrip().startswith("#"):
            match = _LIST_LINE.fullmatch(line.strip())
            if match:
                yield Pin(match["name"], match["commit"], Span(str(path), number, 1), str(path), listed=True)
            else:
                findings.append(
                    UnreadablePins.at(
                        Span(str(path), number, 1),
                        f"the line {line.strip()!r} is not a name and a commit, such as `rover 4f1c2ab`",
                    )
                )


def _text(path: Path, findings: list[Diagnostic]) -> str:
    try:
        text = source_files.read(path.parent, path.name).decode("utf-8", errors="replace")
    except OSError as error:
        help = "correct the path; --pins takes folders of projects, and files of lines `name commit`"
        findings.append(UnreadablePins.at(Span(str(path)), f"cannot be read: {error.strerror}", help))
        return ""
    if "\0" in text:
        findings.append(UnreadablePins.at(Span(str(path)), "the file is binary, and not a list of pins"))
        return ""
    return text


def _cmake_pins(texts: Mapping[Path, str], source: Path, consumer: str) -> Iterator[Pin]:
    """Yield a pin for each ``FetchContent_Declare`` or ``ExternalProject_Add`` with a ``GIT_TAG`` in CMake files.

    ``texts`` has the text of each file. ``source`` is the file or repository that the user named. Comments are
    ignored. A CMake variable is replaced by the value that ``set`` gives to it.
    """
    # Spaces take the place of a comment, so that every offset still belongs to the same line.
    bare = {path: _COMMENT.sub(lambda match: match[1] or " " * len(match[0]), text) for path, text in texts.items()}
    variables = {match["name"]: match["value"] for text in bare.values() for match in _SET.finditer(text)}
    for path, text in bare.items():
        for declared in _DECLARE.finditer(text):
            words = declared["body"].split()
            if tag := _word_after("GIT_TAG", words, variables):
                line = text.count("\n", 0, text.index("GIT_TAG", declared.start())) + 1
                address = _word_after("GIT_REPOSITORY", words, variables)
                yield Pin(f"{consumer}/{words[0]}", tag, Span(str(path), line, 1), str(source), address=address)


def _word_after(keyword: str, words: list[str], variables: Mapping[str, str]) -> str:
    """Return the word after a keyword, with known CMake variables replaced; empty if the keyword is missing."""
    if keyword not in words[:-1]:
        return ""
    word = words[words.index(keyword) + 1].strip('"')
    return _VARIABLE.sub(lambda match: variables.get(match[1], match[0]), word)


def _submodules(folder: Path, consumer: str) -> Iterator[Pin]:
    repository = Repository(folder)
    try:
        listed = repository.entries("HEAD")
    except GitError:
        return
    addresses = _addresses(folder)
    # A submodule is an entry of the tree whose object id is the commit of the other repository. So HEAD tells the pin
    # even if the submodule was never checked out; .gitmodules only adds the address (gitsubmodules(7)).
    for mode, object_id, path in listed:
        if mode == SUBMODULE:
            span = Span(str(folder / ".gitmodules"))
            yield Pin(f"{consumer}/{path}", object_id, span, str(folder), address=addresses.get(path, ""))


def _addresses(folder: Path) -> dict[str, str]:
    """Return the address of each submodule in .gitmodules, by the path of the submodule."""
    # git's format allows a section twice and a `%` in a value; configparser would raise in both cases.
    modules = configparser.ConfigParser(strict=False, interpolation=None)
    try:
        # git indents the lines of a section. For configparser, an indented line would continue the value before it.
        text = source_files.read(folder, ".gitmodules").decode("utf-8", errors="replace")
        modules.read_string("\n".join(line.strip() for line in text.splitlines()))
    except (OSError, configparser.Error):
        return {}
    return {section["path"]: section.get("url", "") for section in modules.values() if "path" in section}
