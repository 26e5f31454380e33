"""Facts of one package, read from its folder alone: classes, executables, components and plugins."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from check_launch.catalogue.facts import Parameter, Plugin
from check_launch.expansion.child_process import AT_ONCE, DEFAULT_LIMITS, ChildEndedError, started
from check_launch.extraction.class_facts import ClassFacts, EndpointFact, ParameterFact, facts_of_package
from check_launch.extraction.cmake_files import built_by
from check_launch.extraction.plugin_descriptions import plugins_of_package
from check_launch.extraction.python_nodes import python_nodes
from check_launch.extraction.source_texts import texts_of_sources

_BUILD_TYPE = re.compile(r"<build_type>\s*(\w+)\s*</build_type>")
_VERSION = re.compile(r"<version>\s*([\w.-]+)\s*</version>")
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


@dataclass(slots=True)
class PackageFacts:
    """Facts about a package, from its files."""

    version: str = ""
    classes: dict[str, ClassFacts] = field(default_factory=dict)
    programs: dict[str, str] = field(default_factory=dict)
    """Name of the node class, as it is written, by the name of the executable; empty if it is not known."""
    components: list[str] = field(default_factory=list)
    plugins: dict[str, Plugin] = field(default_factory=dict)
    is_partial: bool = False
    """True if the package may have more executables."""
    build_words: list[str] = field(default_factory=list)
    """Words in the build files."""
    texts: list[str] = field(default_factory=list)
    """Texts in the sources that may be names."""

    def stored(self) -> Any:
        """Return the facts as JSON values, from which `from_stored` makes them again."""
        return json.loads(json.dumps(asdict(self), default=sorted))  # sets become lists

    @classmethod
    def from_stored(cls, data: Any) -> PackageFacts:
        """Return the facts that `stored` has made JSON values of."""
        return cls(
            **{**data, "classes": {name: _class(facts) for name, facts in data["classes"].items()}}
            | {
                "plugins": {
                    name: Plugin(**{**plugin, "message_types": tuple(plugin["message_types"])})
                    for name, plugin in data["plugins"].items()
                }
            }
        )


def _class(data: Any) -> ClassFacts:
    return ClassFacts(
        **{
            **data,
            "bases": tuple(data["bases"]),
            "parts": {name: set(topics) for name, topics in data["parts"].items()},
            "parameters": {name: _parameter(facts) for name, facts in data["parameters"].items()},
            "endpoints": [EndpointFact(**facts) for facts in data["endpoints"]],
        }
    )


def _parameter(data: Any) -> ParameterFact:
    stated = data["stated"]
    known = Parameter(**{**stated, "choices": tuple(stated["choices"])}) if stated else None
    return ParameterFact(data["type"], data["default"], known)


def read_packages(folders: Sequence[Path]) -> dict[Path, PackageFacts]:
    """Read the files of the packages in folders, on several processors."""
    shares = [folders[start::AT_ONCE] for start in range(min(AT_ONCE, len(folders)))]
    begun = [started(partial(_read_each, share), DEFAULT_LIMITS) for share in shares[1:]]
    found = dict(_read_each(folders[::AT_ONCE]))
    for results in begun:
        with suppress(ChildEndedError):  # what a child does not read is read here
            found |= results
    return {folder: found.get(folder) or read_package(folder) for folder in folders}


def _read_each(folders: Iterable[Path]) -> Iterator[tuple[Path, PackageFacts]]:
    for folder in folders:
        yield folder, read_package(folder)


def read_package(folder: Path) -> PackageFacts:
    """Read the files of the package in a folder."""
    manifest = _COMMENT.sub("", (folder / "package.xml").read_text(encoding="utf-8", errors="replace"))
    version = _VERSION.search(manifest)
    classes, python = facts_of_package(folder), python_nodes(folder)
    build_type = _BUILD_TYPE.search(manifest)
    built = built_by(folder, classes, build_type[1] if build_type else "")
    programs = {
        program.name: python.of_module.get(program.module, "") if program.module else program.class_name
        for program in built.programs
    }
    return PackageFacts(
        version[1] if version else "",
        {**classes, **python.classes},
        programs,
        built.components,
        dict(plugins_of_package(folder)),
        built.is_partial,
        sorted(built.words),
        sorted(set(texts_of_sources(folder))),
    )
