"""Elements of YAML and XML launch files, with the places of their attributes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

import yaml

from roverlink import bounded_files
from roverlink.generator.diagnostics import Span


class UnreadableFileError(Exception):
    """Raised for a file that cannot be read, or that is no YAML or XML; has the place."""

    def __init__(self, place: Span, message: str) -> None:
        super().__init__(message)
        self.place = place

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.place, str(self))


FAST_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast, where PyYAML has it
_DEEPEST = 100
_OF_XML = re.compile(r"<(?:launch|arg|group|include|let|node)\b")
"""Elements of a launch file in XML; Eclipse and others have files with the same ending."""
_OF_YAML = re.compile(r"^[\"']?launch[\"']?\s*:|\b(?:pkg|exec|include)\b", re.MULTILINE)
"""The list of a launch file in YAML, or a word of one whose list is misspelt."""
_MOST_NODES = 200_000


@dataclass(slots=True)
class Attribute:
    """A value of an element, with its type in YAML; in XML, all values are texts."""

    value: Any
    place: Span
    """Place of the value."""
    key: Span
    """Place of the attribute's name."""


@dataclass(slots=True)
class Entity:
    """An element: ``<node pkg="x">`` in XML, ``- node: {pkg: x}`` in YAML."""

    name: str
    place: Span
    attributes: dict[str, Attribute] = field(default_factory=dict)
    children: list[Entity] = field(default_factory=list)


def read_entities(path: Path, shown: str) -> list[Entity]:
    """Read the elements of a launch file; ``shown`` is its name in places. Raises `UnreadableFileError`."""
    text = text_of_file(path, shown)
    return _of_xml(text, shown) if text.lstrip().startswith("<") else list(_of_yaml(text, shown))


def is_declarative(path: Path) -> bool:
    """Return false for a YAML or XML file in which nothing is for `ros2 launch`: its name has another reason."""
    try:
        text = bounded_files.read(path).decode("utf-8-sig", errors="replace")
    except OSError:
        return True  # so that the check says why
    return (_OF_XML if text.lstrip().startswith("<") else _OF_YAML).search(text) is not None


def text_of_file(path: Path, shown: str) -> str:
    """Return the text of a file; ``shown`` is its name in places. Raises `UnreadableFileError`."""
    try:
        return bounded_files.read_text(path)
    except OSError as error:
        raise UnreadableFileError(Span(shown), f"cannot read the file: {error.strerror or error}") from error


def _of_yaml(text: str, shown: str) -> Iterator[Entity]:
    root = compose(text, shown)
    entries = dict(_pairs(root, shown)) if isinstance(root, yaml.MappingNode) else {}
    launch = next((value for key, value in entries.items() if key.value == "launch"), None)
    if not isinstance(launch, yaml.SequenceNode):
        raise UnreadableFileError(Span(shown, 1, 1), "the file has no list 'launch'")
    for item in launch.value:
        yield from _yaml_entity(item, shown)


def compose(text: str, shown: str, of_parameters: bool = False) -> yaml.Node | None:
    """Return the nodes of a YAML text, which know their lines and columns. Raises `UnreadableFileError`.

    ``of_parameters`` joins the documents of a text: rcl_yaml_param_parser reads all of them (Jazzy, run).
    """
    try:
        _check_size(text, shown)
        roots = list(yaml.compose_all(text, FAST_LOADER)) if of_parameters else [yaml.compose(text, FAST_LOADER)]
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Span(shown, mark.line + 1, mark.column + 1) if mark else Span(shown)
        raise UnreadableFileError(place, f"not valid YAML: {error.problem or error.context}") from error
    except yaml.YAMLError as error:
        raise UnreadableFileError(Span(shown), f"not valid YAML: {error}") from error
    first, *others = roots or [None]
    for other in others:
        if isinstance(first, yaml.MappingNode) and isinstance(other, yaml.MappingNode):
            first.value += other.value
    return first


def _check_size(text: str, shown: str) -> None:
    """Raise `UnreadableFileError` for YAML that is nested too deeply, or too large with its anchors in place."""
    sizes: dict[str, int] = {}  # nodes of each anchor that is complete
    open_nodes: list[tuple[str | None, int]] = [(None, 0)]  # anchor and nodes of what is being read

    def refuse(event: yaml.Event, reason: str) -> UnreadableFileError:
        mark = event.start_mark
        return UnreadableFileError(Span(shown, mark.line + 1, mark.column + 1) if mark else Span(shown), reason)

    def add(event: yaml.Event, count: int) -> None:
        anchor, before = open_nodes[-1]
        open_nodes[-1] = anchor, before + count
        if before + count > _MOST_NODES:
            raise refuse(event, f"the file has more than {_MOST_NODES} values with its anchors in place")

    for event in yaml.parse(text, Loader=FAST_LOADER):
        if isinstance(event, yaml.CollectionStartEvent):
            open_nodes.append((event.anchor, 1))
            if len(open_nodes) > _DEEPEST:
                raise refuse(event, "it is nested too deeply")
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, count = open_nodes.pop()
            if anchor:
                sizes[anchor] = count
            add(event, count)
        elif isinstance(event, yaml.AliasEvent):
            if any(event.anchor == anchor for anchor, _ in open_nodes):
                raise refuse(event, f"the anchor '{event.anchor}' contains itself")
            add(event, sizes.get(str(event.anchor), 1))
        elif isinstance(event, yaml.ScalarEvent):
            add(event, 1)


def place_of(node: yaml.Node, shown: str) -> Span:
    """Return the place of a YAML node."""
    return Span(shown, node.start_mark.line + 1, node.start_mark.column + 1)


def _pairs(node: yaml.MappingNode, shown: str) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
    if any(key.tag == "tag:yaml.org,2002:merge" for key, _ in node.value):
        loader = yaml.SafeLoader("")
        try:
            loader.flatten_mapping(node)
        except yaml.constructor.ConstructorError as error:
            raise UnreadableFileError(place_of(node, shown), f"not valid YAML: {error.problem}") from error
        finally:
            loader.dispose()
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise UnreadableFileError(place_of(key, shown), "a key must be a text")
        yield key, value


def _yaml_entity(item: yaml.Node, shown: str) -> Iterator[Entity]:
    if not isinstance(item, yaml.MappingNode) or len(item.value) != 1:
        raise UnreadableFileError(place_of(item, shown), "an action is a mapping with one key, such as `- node: {...}`")
    key, value = next(iter(_pairs(item, shown)))
    yield from _named_entities(key, value, shown)


def _named_entities(key: yaml.ScalarNode, value: yaml.Node, shown: str) -> Iterator[Entity]:
    entity = Entity(key.value, place_of(key, shown))
    if isinstance(value, yaml.SequenceNode):
        for child in value.value:
            entity.children += _yaml_entity(child, shown)
    elif isinstance(value, yaml.MappingNode):
        for name, inner in _pairs(value, shown):
            if name.value == "children" and isinstance(inner, yaml.SequenceNode):
                for child in inner.value:
                    entity.children += _yaml_entity(child, shown)
            elif isinstance(inner, yaml.SequenceNode) and any(
                isinstance(part, yaml.MappingNode) for part in inner.value
            ):
                for child in inner.value:  # `param`, `remap`, `arg`: a list of elements with the same name
                    entity.children += _named_entities(name, child, shown)
            elif isinstance(inner, yaml.MappingNode):
                entity.children += _named_entities(name, inner, shown)
            else:
                entity.attributes[name.value] = Attribute(plain(inner), place_of(inner, shown), place_of(name, shown))
    yield entity


def plain(node: yaml.Node) -> Any:
    """Return the Python value of a YAML node, as YAML types it."""
    loader = yaml.SafeLoader("")
    try:
        return loader.construct_document(node)
    except (yaml.YAMLError, ValueError):
        return node.value if isinstance(node, yaml.ScalarNode) else None
    finally:
        loader.dispose()


def _of_xml(text: str, shown: str) -> list[Entity]:
    parser = expat.ParserCreate()
    lines = text.splitlines()
    root = Entity("", Span(shown))
    stack = [root]

    def started(name: str, attributes: dict[str, str]) -> None:
        place = Span(shown, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
        entity = Entity(name, place)
        for key, value in attributes.items():
            at = _attribute_place(lines, place, key)
            entity.attributes[key] = Attribute(value, at, at)
        stack[-1].children.append(entity)
        stack.append(entity)

    parser.StartElementHandler = started
    parser.EndElementHandler = lambda _: stack.pop()
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:  # also for entities that grow without end
        raise UnreadableFileError(Span(shown, error.lineno, error.offset + 1), f"not valid XML: {error}") from error
    top = root.children[0]
    if top.name != "launch":
        raise UnreadableFileError(top.place, f"the first element is <{top.name}>, not <launch>")
    return top.children


def _attribute_place(lines: list[str], place: Span, name: str) -> Span:
    """Find the attribute of an element; expat tells only where the element begins."""
    for line in range(place.line, min(place.line + 20, len(lines)) + 1):
        text = lines[line - 1]
        start = place.column - 1 if line == place.line else 0
        found = text.find(f"{name}=", start)
        if found >= 0:
            return Span(place.file, line, found + 1)
        if ">" in text[start:]:
            break
    return place
