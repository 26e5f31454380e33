"""Reader of OpenCV's FileStorage in XML. It gives the same nodes as the YAML of the same content.

<opencv_storage>
<image_width>640</image_width>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows> <cols>3</cols> <dt>d</dt>
  <data> 920. 0. 319.5 0. 920. 239.5 0. 0. 1.</data></camera_matrix>
</opencv_storage>
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

import yaml

from roverlink.runtime.text.strict_yaml import YamlTextError

_WORD = re.compile(r'"(?:\\.|[^"\\])*"|\S+')
_OF_A_LIST = "_"
"""Name of the elements of a list. Parameters have no such lists, so only the last element is kept."""


@dataclass
class _Element:
    """Element of the file, with the words of its text."""

    name: str
    mark: yaml.Mark
    entries: dict[str, tuple[yaml.Node, yaml.Node]] = field(default_factory=dict)
    words: list[yaml.Node] = field(default_factory=list)

    def node(self) -> yaml.Node:
        """Return the content as a YAML node: a mapping, a list, or one word."""
        if self.entries:
            return yaml.MappingNode("tag:yaml.org,2002:map", [*self.entries.values()], self.mark, self.mark)
        if len(self.words) == 1 and self.name != "data":
            return self.words[0]
        return yaml.SequenceNode("tag:yaml.org,2002:seq", self.words, self.mark, self.mark)


def compose_xml(text: str) -> yaml.Node:
    """Parse the text of a FileStorage in XML into YAML nodes. Raises `YamlTextError` for anything else."""
    parser = expat.ParserCreate()
    whole = _Element("", _mark(0, 0))
    open_elements = [whole]

    def here() -> yaml.Mark:
        return _mark(parser.CurrentLineNumber - 1, parser.CurrentColumnNumber)

    def start(name: str, _: dict[str, str]) -> None:
        open_elements.append(_Element(name, here()))

    def end(name: str) -> None:
        element = open_elements.pop()
        entries = open_elements[-1].entries
        if name in entries and name != _OF_A_LIST:
            raise YamlTextError(f"the key {name} occurs twice; keep one of them", element.mark)
        entries[name] = (_scalar(name, element.mark), element.node())

    def characters(line: str) -> None:  # expat calls it for each line of a text
        place = here()
        open_elements[-1].words += [
            _scalar(word[0], _mark(place.line, place.column + word.start())) for word in _WORD.finditer(line)
        ]

    def refuse(*_: object) -> None:
        # OpenCV writes none, and a document type can define entities that expand to gigabytes.
        raise YamlTextError("the file has a document type (DOCTYPE), which OpenCV does not write; remove it", here())

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = characters, refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        place = _mark(error.lineno - 1, error.offset)
        raise YamlTextError(f"not valid XML: {expat.ErrorString(error.code)}", place) from error
    ((root, content),) = whole.entries.values()
    if root.value != "opencv_storage":
        raise YamlTextError(
            f"the file is <{root.value}>, and no FileStorage of OpenCV (<opencv_storage>)", root.start_mark
        )
    return content


def _mark(line: int, column: int) -> yaml.Mark:
    return yaml.Mark("", 0, line, column, None, 0)


def _scalar(word: str, mark: yaml.Mark) -> yaml.ScalarNode:
    is_quoted = word.startswith('"')
    value = word[1:-1] if is_quoted else word
    resolver: Any = yaml.resolver.Resolver()  # types-PyYAML leaves its methods without types
    tag = resolver.resolve(yaml.ScalarNode, value, (not is_quoted, is_quoted))
    return yaml.ScalarNode(tag, value, mark, mark, '"' if is_quoted else None)
