"""Reference tables in the documentation, written from declarations in the code.

A table stands between two comments. The first one is ``<!-- keys: peers -->``, ``<!-- parameters -->`` for the bridge,
``<!-- parameters: drive -->`` or ``<!-- topics: drive -->`` for a program, or the name of a class whose attributes are
listed, such as ``<!-- counters -->``: see `_CLASSES`. The second one is ``<!-- end -->``.
``make docs-reference`` writes them (``python docs/site/committed_tables.py``), and a test checks that they are current.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from enum import Enum
from pathlib import Path

from class_sections import attributes, class_definition
from roverkit.simulation import simulation_declaration

from generated.registry import REGISTRY
from roverlink.generator.table import key_text
from roverlink.generator.table.keys import Table
from roverlink.generator.table.parts import object_of
from roverlink.generator.table.value_types import Key, Object
from roverlink.nodes import ExtraTopics, NodeDeclaration, Parameter, RowTopic, Topic
from roverlink.nodes.installed import declared_nodes
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.ends import LinkEvent
from roverlink.runtime.core.errors import Reason
from roverlink.runtime.net.outbox import Undelivered
from roverlink.runtime.ros_arguments import parameters

ROOT = Path(__file__).parents[2]
_CLASSES: dict[str, type] = {"counters": Account, "reasons": Reason, "events": LinkEvent, "undelivered": Undelivered}
_TABLE = re.compile(
    rf"^<!-- (?P<what>keys|parameters|topics|{'|'.join(_CLASSES)})(?:: (?P<names>[^\n]*))? -->\n.*?^<!-- end -->$",
    re.MULTILINE | re.DOTALL,
)
PAGES = tuple(
    path
    for folder in (ROOT / "docs", ROOT / "rover" / "docs")
    for path in sorted(folder.glob("*.md"))
    if _TABLE.search(path.read_text(encoding="utf-8"))
)
"""Pages that have such tables."""


def current(page: str) -> str:
    """Return the text of a page with its tables made anew."""
    return _TABLE.sub(lambda found: "\n".join([found[0].partition("\n")[0], *_rows(found), "<!-- end -->"]), page)


def documented_keys(page: str) -> list[str]:
    """Return the keys at the top of mapping.yaml that the tables of a page are about."""
    return [key for found in _TABLE.finditer(page) if found["what"] == "keys" for key in found["names"].split(", ")]


def _rows(found: re.Match[str]) -> Iterator[str]:
    names = found["names"]
    if found["what"] == "topics":
        yield from ("| topic | direction | message | content |", "|---|---|---|---|", *map(_topic, _node(names).topics))
    elif found["what"] == "parameters" and names:
        yield from ("| parameter | default | meaning |", "|---|---|---|", *map(_parameter, _node(names).parameters))
    elif found["what"] == "parameters":
        yield from ("| parameter | default | read-only | meaning |", "|---|---|---|---|", *_bridge_parameters())
    elif found["what"] in _CLASSES:
        yield from ("| name | meaning |", "|---|---|", *_attributes(_CLASSES[found["what"]]))
    else:
        keys = object_of(Table).keys
        yield from ("| key | holds | meaning | default |", "|---|---|---|---|")
        for name in names.split(", "):
            yield from (_key(path, key) for path, key in key_text.keys_below(Object({name: keys[name]})))


# --- nodes ---


def _node(program: str) -> NodeDeclaration:
    """Return the declaration of a program's node."""
    if program == "simulate_rover":  # it takes no --ros-args, so that launch files cannot start it
        return simulation_declaration.NODE
    return declared_nodes()[program]


def _topic(topic: Topic | RowTopic | ExtraTopics) -> str:
    if isinstance(topic, Topic):
        name, message = f"`{topic.name}`", " or ".join(f"`{type.replace('/msg/', '/')}`" for type in topic.type_names)
    elif isinstance(topic, RowTopic):
        message = f"that of the row `{topic.row}`"
        name = f"`{REGISTRY.by_name[topic.row].route.topic}`" if topic.row in REGISTRY.by_name else message
    else:
        name, message = f"extra topics of the row `{topic.row}`", "as the table says"
    return f"| {name} | {topic.direction.value} | {message} | {topic.meaning} |"


def _parameter(declared: Parameter) -> str:
    default = declared.default
    if default is None:  # an option or the table gives the first value
        shown = ""
    elif isinstance(default, bool):
        shown = str(default).lower()
    elif isinstance(default, float):
        shown = f"{default:.9f}".rstrip("0").rstrip(".")
    else:
        shown = str(default)
    return f"| `{declared.name}` | {shown} | {declared.meaning} |"


def _bridge_parameters() -> Iterator[str]:
    for name, declared in parameters.DECLARED.items():
        unit = f", in {declared.unit}" if declared.unit else ""
        read_only = "yes" if declared.read_only else ""
        yield f"| `{name}` | {declared.default} | {read_only} | {declared.description}{unit} |"
    for peer in REGISTRY.peers:
        meaning = f"UDP port of the peer `{peer.name}`; the table sets the name and the default"
        yield f"| `{peer.port_parameter}` | {peer.port} | | {meaning} |"


# --- attributes of a class ---


def _attributes(declared: type) -> Iterator[str]:
    """Return a row for each attribute that a text follows; a member of an enum is shown by its value."""
    for name, _, text in attributes(class_definition(declared)):
        if text:
            shown = getattr(declared, name).value if issubclass(declared, Enum) else name
            yield f"| `{shown}` | {' '.join(text.replace('``', '`').split())} |"


# --- the table's keys ---


def _key(path: str, key: Key) -> str:
    """Return the row of a key."""
    see = f" ([{key.meaning.see.partition('#')[0]}]({key.meaning.see}))" if key.meaning.see else ""
    text = key.meaning.text
    meaning = f"{text[:-1]}{see}." if see else text
    return f"| `{path}` | {key_text.holds(key.type)} | {meaning} | {key_text.default_of(key)} |"


if __name__ == "__main__":
    for _page in PAGES:
        _page.write_text(current(_page.read_text(encoding="utf-8")), encoding="utf-8")
