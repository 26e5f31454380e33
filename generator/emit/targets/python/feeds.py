"""One class a topic with a standard message: a feed of its row, or the row's own handler."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Iterable, Iterator

from roverlink.generator import ir
from roverlink.generator.emit.extra_topic_names import named_feeds
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import interfaces, layout, spelling
from roverlink.generator.emit.targets.python.feed_spelling import FeedSpelling
from roverlink.generator.emit.targets.python.layout import Group, Item
from roverlink.generator.emit.targets.python.routes import route_arguments, runtime_names
from roverlink.generator.ir import Feed
from roverlink.generator.ir.interfaces import Constant, Interface, InterfaceField, Parts, Path, TargetField, Unset


def emit(bridge: ir.Bridge) -> Files:
    """The feeds of the rows, and the handlers of the rows that are feeds themselves."""
    for route in bridge.routes:
        if route.feed:
            text = _module(bridge, route, route.feed, spelling.handler_class(route))
            yield f"generated/handlers/{spelling.module(route.name)}.py", text
    named = named_feeds(bridge)
    for one in named:
        yield f"generated/feeds/{one.file}.py", _module(bridge, one.route, one.feed, one.name)
    if named:
        yield (
            "generated/feeds/__init__.py",
            render(
                "package.py.j2",
                header=header(bridge.table),
                docstring='"""The feeds: further topics of the rows, with messages of the common interfaces."""',
                imports=layout.in_import_order(
                    layout.import_from(f"{bridge.python_package}.feeds.{one.file}", [one.name]) for one in named
                ),
                names=sorted(one.name for one in named),
            ),
        )


def _module(bridge: ir.Bridge, route: ir.Route, feed: Feed, name: str) -> str:
    spell = FeedSpelling(feed, bridge.python_package)
    payload = f"{spelling.proto_module(feed.file)}.{feed.local_name}"
    message = interfaces.reference(feed.message)
    to_ros = layout.statement(_returned(spell.message(feed.fields, feed.message)), 8)
    from_ros = spell.statements()
    pack = _Pack(bridge, feed, spell)
    imports: dict[str, set[str]] = {}
    own = spelling.proto_package(bridge.python_package, feed.file), spelling.proto_module(feed.file)
    wanted = {*spell.imports, *pack.imports, own, ("roverlink.runtime.interfaces", "Time")}
    wanted |= {("roverlink.runtime.core.feed", "Feed"), ("roverlink.runtime.core.feed", "UNSTAMPED")}
    wanted |= {("roverlink.runtime.core.handler", name) for name in runtime_names(route)}
    for source, imported in wanted:
        imports.setdefault(source, set()).add(imported)
    constants = [*spell.constants(), *pack.constants]
    unstamped = "" if "=stamp" in to_ros else "_"
    what = f"{feed.local_name} {'to' if route.inbound else 'from'} {feed.message}"
    return render(
        "feed.py.j2",
        header=header(f"{bridge.table} (row {route.name}) and {feed.file}"),
        docstring=layout.docstring(f"{route.name} ({route.number}): {what} on {route.topic}.", 0),
        uses_math=any("math." in text for text in (*constants, to_ros, *from_ros, *spell.locals, pack.statement)),
        imports=layout.in_import_order(layout.import_from(source, names) for source, names in imports.items()),
        constants=constants,
        class_line=layout.statement(Group(f"class {name}(", [Group("Feed[", [payload, message], "]")], "):")),
        class_docstring=layout.docstring(_about(route, feed), 4),
        route=layout.statement(Group("route = Route(", list(route_arguments(route)), ")"), 4),
        payload_type=layout.line(f"payload_type = {payload}", 4),
        message_type=layout.line(f"message_type = {message}", 4),
        to_ros_signature=layout.signature(
            "to_ros",
            [_parameter("payload", payload, to_ros), f"{unstamped}stamp: Time = UNSTAMPED"],
            message,
            4,
        ),
        to_ros=to_ros,
        from_ros_signature=layout.signature(
            "from_ros", [_parameter("message", message, "\n".join(from_ros))], payload, 4
        ),
        from_ros_docstring=layout.docstring(_way_back(feed), 8),
        from_ros=from_ros,
        pack=pack.statement,
        pack_locals=spell.locals,
        pack_signature=layout.signature(
            "pack",
            ["self", f"payload: {payload}", f"{'' if 'stamp.' in pack.statement else '_'}stamp: Time = UNSTAMPED"],
            "bytes",
            4,
        ),
    )


def _returned(group: Group) -> Group:
    return dataclasses.replace(group, head=f"return {group.head}")


def _parameter(name: str, type: str, body: str) -> str:
    return f"{name}: {type}" if f"{name}." in body else f"_{name}: {type}"


def _about(route: ir.Route, feed: Feed) -> str:
    arrow = "to" if route.inbound else "from"
    return f"{feed.local_name} {arrow} {feed.message.replace('/msg/', '/')} on the topic {route.topic}."


def _way_back(feed: Feed) -> str:
    """What the docstring says of the way back."""
    if feed.obstacle:
        return f"There is no way back: {feed.obstacle}."
    if not feed.recovered:
        return "An empty payload: the message tells none of its fields."
    if not feed.lost:
        return "The payload that says what the message says."
    lost = textwrap.fill(f"It says nothing of {', '.join(feed.lost)}.", layout.LINE_LENGTH - 8)
    return f"The payload that says what the message says.\n\n{lost}"


class _Pack:
    """The hot path: one `struct` call for what varies, between the bytes of what does not."""

    def __init__(self, bridge: ir.Bridge, feed: Feed, spell: FeedSpelling) -> None:
        self._definitions = {interface.name: interface for interface in bridge.interfaces}
        self.constants: list[str] = []
        self.statement = ""
        self.imports: set[tuple[str, str]] = set()
        leaves = [leaf for field in feed.fields for leaf in self._leaves(field, (field.name,))]
        if not any(varies for _, varies in leaves) or any(varies is None for _, varies in leaves):
            return
        self.imports = {("roverlink.runtime.core", "cdr")}
        gaps = list(self._gaps([(path, bool(varies)) for path, varies in leaves]))
        fixed = spell.message(feed.fields, feed.message, varying=False)
        paths = Group("[", [f'"{path}"' for path in _varying(feed.fields, ())], "]")
        self.constants.append(layout.statement(Group("_CDR = cdr.template(", [fixed, paths], ")")))
        constants = [name for name in gaps if name]
        targets = f"({constants[0]},)" if len(constants) == 1 else ", ".join(constants)
        unpacking = f"{targets} = _CDR.constants"
        self.constants.append(layout.line(unpacking, 0) if len(unpacking) <= layout.LINE_LENGTH else "")
        if not self.constants[-1]:
            self.constants[-1] = "\n".join(["(", *(f"    {name}," for name in constants), ") = _CDR.constants"])
        self.constants.append("_PACK = _CDR.layout.pack")
        self.statement = layout.statement(Group("return _PACK(", list(self._arguments(feed, spell, gaps)), ")"), 8)

    def _leaves(self, field: TargetField, path: Path) -> Iterator[tuple[Path, bool | None]]:
        """Each part with a place in the message, and whether it varies; None where that has no fixed size."""
        value, type = field.value, field.type
        if isinstance(value, Parts):
            for part in value.fields:
                yield from self._leaves(part, (*path, part.name))
        elif isinstance(value, (Constant, Unset)):
            yield path, False
        elif type.is_message and not type.is_many:
            yield from ((leaf, True) for leaf in self._primitives(self._definitions[type.name], path))
        else:
            yield path, None if type.is_sequence or type.name == "string" or type.is_message else True

    def _primitives(self, interface: Interface, path: Path) -> Iterator[Path]:
        for field in interface.fields:
            yield from self._below(field, (*path, field.name))

    def _below(self, field: InterfaceField, path: Path) -> Iterator[Path]:
        if field.type.is_message:
            yield from self._primitives(self._definitions[field.type.name], path)
        else:
            yield path

    def _gaps(self, leaves: list[tuple[Path, bool]]) -> Iterator[str]:
        """Before each value that varies, and at the end: the name of the constant there, or nothing."""
        fixed = True  # the encapsulation header
        for path, varies in leaves:
            if varies:
                yield f"_UP_TO_{'_'.join(path).upper()}" if fixed else ""
            fixed = not varies
        yield "_REST" if fixed else ""

    def _arguments(self, feed: Feed, spell: FeedSpelling, gaps: list[str]) -> Iterator[Item]:
        place = 0
        for field in feed.fields:
            for item, width in self._items(field, (field.name,), spell):
                if gaps[place]:
                    yield gaps[place]
                yield item
                place += width
        if gaps[-1]:
            yield gaps[-1]

    def _items(self, field: TargetField, path: Path, spell: FeedSpelling) -> Iterator[tuple[Item, int]]:
        """The arguments of a field, and for how many leaves each stands."""
        if isinstance(field.value, Parts):
            for part in field.value.fields:
                yield from self._items(part, (*path, part.name), spell)
            return
        leaves = len([leaf for leaf in self._leaves(field, path) if leaf[1]])
        items = spell.values(field)
        yield from ((item, leaves if len(items) == 1 else 1) for item in items)


def _varying(fields: Iterable[TargetField], path: Path) -> Iterator[str]:
    """The paths of what varies; a message of which everything does by its own."""
    for field in fields:
        own = (*path, field.name)
        if isinstance(field.value, Parts):
            if _varies(field):
                yield ".".join(own)
            else:
                yield from _varying(field.value.fields, own)
        elif _varies(field):
            yield ".".join(own)


def _varies(field: TargetField) -> bool:
    """Whether everything in it varies."""
    if isinstance(field.value, Parts):
        return bool(field.value.fields) and all(_varies(part) for part in field.value.fields)
    return not isinstance(field.value, (Constant, Unset))
