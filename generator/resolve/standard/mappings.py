"""Resolver of topics with standard messages, such as sensor_msgs/Imu: from the table's entries to the IR."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.interfaces import BoardTime, Constant, Interface, Moment
from roverlink.generator.protos.schema import Schema
from roverlink.generator.resolve.interfaces import definitions
from roverlink.generator.resolve.standard import standard_rules
from roverlink.generator.resolve.standard.filling import Filling
from roverlink.generator.resolve.standard.inverse import invert, sources_of
from roverlink.generator.resolve.standard.message_fields import Places, short
from roverlink.generator.resolve.standard.payload_fields import Sources
from roverlink.generator.resolve.standard.unset import Tree
from roverlink.generator.table import Row, StandardTopicSettings, Table
from roverlink.suggestions import nearest

_HEADER = "std_msgs/msg/Header"


class StandardTopics:
    """Builder of the standard topics of all rows: the topics with a standard message, such as sensor_msgs/Imu.

    It also collects the definitions of all messages that these topics need.
    """

    def __init__(self, table: Table, schema: Schema, report: Callable[[Diagnostic], None]) -> None:
        self._distro, self._schema, self._report, self._table = table.ros.distro or "", schema, report, table
        self._clocks: dict[tuple[str, str], tuple[BoardTime, Span]] = {}  # by peer and board
        self._definitions: dict[str, Interface] = {}

    @property
    def interfaces(self) -> tuple[Interface, ...]:
        """Definitions of the topics' standard messages, and of all messages inside them, sorted by name."""
        return tuple(interface for _, interface in sorted(self._definitions.items()))

    def of(self, row: Row) -> tuple[StandardTopic | None, tuple[StandardTopic, ...]]:
        """Return the row's own topic with its standard message, and the extra topics that the row lists under `also`.

        The first result is None if the row has a generated message, or if its standard message is unknown. Extra topics
        with an unknown message are left out.
        """
        if row.standard is None:
            self._check_own_message(row)
        sources = Sources(self._schema, self._schema.messages[row.proto], self._report)
        made = [self._standard(row, settings, sources) for settings in row.standard_topics]
        if row.standard and row.inbound:
            self._check_used(row, sources, [standard for standard in made if standard])
        own = made.pop(0) if row.standard else None
        return own, tuple(standard for standard in made if standard)

    def _standard(self, row: Row, settings: StandardTopicSettings, sources: Sources) -> StandardTopic | None:
        root = self._root(settings)
        if root is None:
            return None
        filling = Filling(Places(root, self._definition, self._report), sources, self._report)
        for path, form in settings.fields.items():
            filling.add(tuple(path.split(".")), form)
        self._add_header(row, settings, root, filling)
        fields = Tree(filling, settings, self._report).fields()
        self._check_ignored(settings, sources)
        back = invert(fields)
        lost = [
            path for path in sources.paths() if not _covers(back.found, path) and not _covers(settings.ignore, path)
        ]
        if not row.inbound:
            self._check_inverse(row, settings, back.obstacle, lost)
        file = self._schema.messages[row.proto].file
        return StandardTopic(
            settings.topic,
            settings.profile,
            row.proto,
            self._schema.packages.get(file, ""),
            file,
            root.name,
            fields,
            back.recovered,
            back.obstacle,
            tuple(lost),
        )

    def _check_own_message(self, row: Row) -> None:
        """Report keys that need a standard message, such as `frame_id`, in a row with a generated message."""
        for key in ("frame_id", "stamp", "unset"):
            if key in row.spans:
                message = f"`{key}` is for standard messages, but {row.ros!r} is not a standard message"
                help = "write a message with its package under `ros`, or move the key to an entry of `also`"
                self._report(standard_rules.KeyWithoutStandardMessage.at(row.at(key), message, help))

    # --- definitions ---

    def _root(self, settings: StandardTopicSettings) -> Interface | None:
        """Return the definition of a topic's standard message; if the message is unknown, report it and return None.

        The definition is added to `interfaces`, together with the definitions of all messages inside the message.
        """
        name, span = definitions.full_name(settings.ros), settings.at("ros")
        try:
            root = definitions.interface(name, self._distro)
            if root is not None:
                self._add_definition(root)
                return root
        except definitions.DistributionsDisagreeError as error:
            help = "if every machine has the same distribution, set `distro` under `ros`"
            self._report(standard_rules.DistributionsDisagree.at(span, str(error), help))
            return None
        help = nearest(settings.ros, definitions.names(), "for example sensor_msgs/Imu or geometry_msgs/Twist")
        self._report(standard_rules.UnknownStandardMessage.at(span, f"unknown standard message {settings.ros!r}", help))
        return None

    def _add_definition(self, interface: Interface) -> None:
        self._definitions[interface.name] = interface
        for field in interface.fields:
            if field.type.is_message and field.type.name not in self._definitions:
                nested = definitions.interface(field.type.name, self._distro)
                if nested is not None:
                    self._add_definition(nested)

    def _definition(self, name: str) -> Interface:
        return self._definitions[name]

    # --- the header ---

    def _add_header(self, row: Row, settings: StandardTopicSettings, root: Interface, filling: Filling) -> None:
        if not any(field.name == "header" and field.type.name == _HEADER for field in root.fields):
            for key, given in (("frame_id", settings.frame_id), ("stamp", settings.stamp)):
                if given is not None:
                    message = f"{short(root.name)} has no header, so it has no `{key}`"
                    self._report(standard_rules.MappingDoesNotFit.at(settings.at(key), message, f"remove `{key}`"))
            return
        if settings.frame_id is not None or ("header", "frame_id") not in filling.expressions:
            filling.put(("header", "frame_id"), Constant(settings.frame_id or ""), settings.at("frame_id"))
            if settings.frame_id is None and row.inbound:
                message = f"{short(root.name)} has a header, but the coordinate frame of its values is not given"
                help, rests_on = "add `frame_id`, for example imu_link", [row.at("direction")]
                self._report(standard_rules.FrameIdMissing.at(settings.span, message, help, rests_on=rests_on))
        if settings.stamp is not None or ("header", "stamp") not in filling.expressions:
            self._add_stamp(row, settings, filling)

    def _add_stamp(self, row: Row, settings: StandardTopicSettings, filling: Filling) -> None:
        path, span = ("header", "stamp"), settings.at("stamp")
        place = filling.places.find(path, span)
        if settings.stamp is None:
            filling.put(path, Moment(None), span)
        elif place is not None:
            moment = filling.stamp(place, settings.stamp)
            if isinstance(moment, BoardTime):
                self._check_clock(row, moment, span)
            filling.put(path, moment, span)

    def _check_clock(self, row: Row, moment: BoardTime, span: Span) -> None:
        """Report a stamp by the clock of a board if it is not known which board, or if the board has another clock."""
        board, peer = self._table.board_of(row), self._table.peers_by_name().get(row.peer)
        if not row.inbound:
            message, help = f"{row.peer!r} measures nothing in a message that goes to it", "remove `clock`"
            self._report(standard_rules.ClockOfNoBoard.at(span, message, help, rests_on=[row.at("direction")]))
            return
        if not board and peer is not None and (len(peer.prefixes) > 1 or peer.boards):
            message = f"{row.peer!r} has several boards with a clock each, but the row {row.name!r} belongs to none"
            self._report(standard_rules.ClockOfNoBoard.at(span, message, "add `board` to the row"))
            return
        first, where = self._clocks.setdefault((row.peer, board), (moment, span))
        if (first.nanoseconds, first.counter.bits) != (moment.nanoseconds, moment.counter.bits):
            message = f"the clock of {board or row.peer} has {_unit(moment)} here, but {_unit(first)} in another stamp"
            also = [(where, "the other stamp is here")]
            self._report(standard_rules.OtherBoardClock.at(span, message, "use one counter for all stamps", also))

    # --- the payload's fields ---

    def _check_used(self, row: Row, sources: Sources, standard_topics: list[StandardTopic]) -> None:
        """Report fields of the payload that no topic of the row publishes, and that the row does not ignore."""
        ignored = [path for settings in row.standard_topics for path in settings.ignore]
        used = {source for standard in standard_topics for source in _sources_of(standard)}
        if len(standard_topics) < len(row.standard_topics):
            return  # a topic with mistakes is missing; the fields that it uses are unknown
        rests_on = [row.at("direction"), *(span for settings in row.standard_topics for span in _entries(settings))]
        for path in sources.paths():
            if not _covers(ignored, path) and path not in used:
                message = f"no topic of the row {row.name!r} publishes the field {path!r}"
                help = f"use {path!r} in an entry under `fields`, or list it under `ignore`"
                self._report(standard_rules.SourceFieldUnused.at(row.at("fields"), message, help, rests_on=rests_on))

    def _check_inverse(self, row: Row, settings: StandardTopicSettings, obstacle: str, lost: list[str]) -> None:
        """Report a standard message from which the payload, or a field of the payload, cannot be computed.

        Only a row to a peer needs this computation. ``obstacle`` is the reason why the payload cannot be computed,
        or empty. ``lost`` has the paths of the fields that cannot be computed.
        """
        span, rests_on = settings.at("fields"), [row.at("direction"), *_entries(settings)]
        if obstacle:
            message = f"{settings.ros!r} on the topic {settings.topic!r} cannot be converted to the payload: {obstacle}"
            help = f"change the entries under `fields`, or write `direction: {row.peer}_to_ros`"
            self._report(standard_rules.NoWayBack.at(span, message, help, rests_on=rests_on))
        elif lost:
            fields = ", ".join(map(repr, lost))
            message = f"{settings.ros!r} on the topic {settings.topic!r} has no value for {fields} of the payload"
            help = f"map {fields} under `fields`, or list it under `ignore`, or write `direction: {row.peer}_to_ros`"
            self._report(standard_rules.SourceFieldUnused.at(span, message, help, rests_on=rests_on))

    def _check_ignored(self, settings: StandardTopicSettings, sources: Sources) -> None:
        for path in settings.ignore:
            if not sources.leads_somewhere(path):
                span = settings.spans.get(f"ignore.{path}", settings.span)
                help = nearest(path, sources.paths(), "")
                self._report(
                    standard_rules.UnknownSourceField.at(
                        span, f"the proto message {sources.proto!r} has no field {path!r}", help
                    )
                )


def _entries(settings: StandardTopicSettings) -> Iterator[Span]:
    """Yield the place in mapping.yaml of each entry under `fields`, at any depth."""
    forms = list(settings.fields.values())
    for form in forms:  # the list grows while it is read
        yield form.span
        forms += [*(form.entries or {}).values(), *(form.items or ())]


def _covers(paths: Iterable[str], path: str) -> bool:
    """Return True if ``paths`` contains the path, or the path of a message around it: ``accel`` for ``accel.x``."""
    return any(path == other or path.startswith(f"{other}.") for other in paths)


def _unit(moment: BoardTime) -> str:
    return f"{moment.counter.bits} bits and units of {moment.nanoseconds} ns"


def _sources_of(standard: StandardTopic) -> set[str]:
    return {source.dotted for source in sources_of(standard.fields)}
