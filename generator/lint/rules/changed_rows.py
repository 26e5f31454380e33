"""Rules about published rows that have another topic, direction, deadman or limit than before."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.lint.context import ChangedSetting, Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.lock import DEADMAN, EXTRA_TOPIC, FORWARD, LIMITS, topics_of
from roverlink.generator.table import Row


class TopicChanged(LintRule, id="TAB107", severity=Severity.WARNING):
    """A published row has another topic than before, or lost an extra topic.

    Subscribers and publishers of the old topic get no error: the topic is just silent. The next `roverlink generate`
    writes the new topic into the ledger (mapping.lock), so this warning appears once.

    Bad::

        # mapping.lock says `12: gps_info SensorBoardGPSInfo on gps_data`
        - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps, direction: hardware_to_ros}

    Good::

        - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each topic with which a row of the same number and message was published."""
        topics = {topic.topic for row in context.table.rows for topic, *_ in topics_of(row)}
        for row in context.table.rows:
            before: dict[str, Span] = {}
            for entry in context.published:
                if (entry.number, entry.proto) == (row.number, row.proto) and entry.topic not in ("", row.topic):
                    before.setdefault(entry.topic, entry.span)
            if row.topic and before:
                published = " and on ".join(map(repr, before))
                message = f"{row.name!r} has the topic {row.topic!r}; it was published on {published}"
                help = "restore the old topic, or change all nodes that use it"
                also = [(span, f"{topic!r} was the topic here") for topic, span in before.items()]
                rests_on = [row.at("number"), row.at("topic")]
                yield cls.of_row(context.table, row, "topic", message, help, also, rests_on=rests_on)
            for key, change in context.changed_settings(row).items():
                topic = key.removeprefix(EXTRA_TOPIC)
                # the key of the topic's QoS has a further word
                if change.now is None and key.startswith(EXTRA_TOPIC) and " " not in topic and topic not in topics:
                    message = f"{row.name!r} has no extra topic {topic!r} any more; {change.published}"
                    help = "restore the extra topic, or change all nodes that use it"
                    rests_on, also = [row.at("number"), row.at("proto")], change.related()
                    yield cls.of_row(context.table, row, "topic", message, help, also, rests_on=rests_on)


_HELP_DIRECTION = "or update every machine that uses the row, and lower TAB109 under `lint` of the row, with the reason"


class DirectionChanged(LintRule, id="TAB109"):
    """A published row has another direction or another peer, or is no longer forwarded to a peer.

    A board that still has the old direction sends what the rover sends, too, and both wait for a payload that never
    comes. No machine reports an error. The ledger (mapping.lock) contains the direction and the `forward` list of each
    row at the last `roverlink generate`. With `--against`, those of the earlier state count, too. To change a direction
    on purpose, lower this rule in the row until the change is merged, and give the reason.

    Bad::

        # mapping.lock says `16 ControlMode direction: basestation_to_ros`
        - {number: 16, name: control_mode, proto: ControlMode, topic: control_mode, direction: ros_to_basestation}

    Good::

        - {number: 16, name: control_mode, proto: ControlMode, topic: control_mode, direction: basestation_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row with another direction, and for each row that forwards to fewer peers."""
        for row in context.table.rows:
            changed = context.changed_settings(row)
            if direction := changed.get("direction"):
                peers = {_peer(text) for text in direction.before} - {row.peer}
                kind = f"another peer, {row.peer!r}" if peers else "the opposite direction"
                message = f"{row.name!r} has {kind}: its direction is {row.direction!r}; {direction.published}"
                span = row.at("direction")
                help = f"restore the direction; {_HELP_DIRECTION}"
                yield context.diagnostic_of_change(cls, row, direction, message, help, span, rests_on=span)
            if forward := changed.get("forward"):
                before = {peer for text in forward.before for peer in text.split()}
                if lost := sorted(before - {*row.forward}):
                    peers_lost = " and ".join(map(repr, lost))
                    message = f"{row.name!r} is no longer forwarded to {peers_lost}"
                    span = row.at("forward") if row.forward else row.at("direction")
                    help = f"restore `forward`; {_HELP_DIRECTION}"
                    yield context.diagnostic_of_change(cls, row, forward, message, help, span, rests_on=span)


def _peer(direction: str) -> str:
    return direction.removesuffix("_to_ros").removeprefix("ros_to_")


_HELP_DEADMAN = "restore the deadman; or lower TAB110 under `lint` of the row, with the reason"


class DeadmanWeakened(LintRule, id="TAB110"):
    """The deadman of a published row was removed, waits longer, or sends another payload.

    The deadman stops the rover when the commanding topic falls silent. Without it, the rover goes on with its last
    command. The ledger (mapping.lock) contains the deadman of each row at the last `roverlink generate`. With
    `--against`, the deadman of the earlier state counts, too. A shorter time is no finding. To change a deadman on
    purpose, lower this rule in the row until the change is merged, and give the reason.

    Bad::

        # mapping.lock says `2 ArmControl deadman after: 500ms`
        - {number: 2, name: arm_ctrl, proto: ArmControl, topic: arm_ctrl, direction: ros_to_hardware}

    Good::

        - number: 2
          name: arm_ctrl
          proto: ArmControl
          topic: arm_ctrl
          direction: ros_to_hardware
          deadman: {after: 500ms, send: {}}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each part of a deadman that stops the peer later than before, or in another way."""
        for row in context.table.rows:
            if row.inbound:
                continue  # nothing is sent to the peer; TAB109 reports the new direction
            changed = context.changed_settings(row)
            for key in DEADMAN:
                for message, span in _weaker(row, key, changed[key]) if key in changed else ():
                    place = row.at("direction")
                    yield context.diagnostic_of_change(
                        cls, row, changed[key], message, _HELP_DEADMAN, span, rests_on=place
                    )


def _weaker(row: Row, key: str, change: ChangedSetting) -> Iterator[tuple[str, Span]]:
    if change.now is None:
        if key == DEADMAN[0]:  # the other parts are gone with it
            yield f"the deadman of {row.name!r} was removed", row.at("name")
        return
    name = key.removeprefix("deadman ")
    message = f"the deadman of {row.name!r} has `{name}` {change.now.text!r}; {change.published}"
    if name == "send" or change.now.amount > min(setting.amount for setting in change.before.values()):
        yield message, change.now.span


class SafetyLimitWeakened(LintRule, id="TAB111", severity=Severity.WARNING):
    """A published row lost a limit, or has a weaker one: `max_rate`, `priority`, `expect_rate` or `at_least`.

    `max_rate` protects a board or a slow link from too many messages, also under `forward`. `priority` lets a stop
    overtake other messages, `expect_rate` warns when a sensor falls silent, and a peer may wait for the messages that
    `at_least` repeats. The ledger (mapping.lock) contains the limits of each row at the
    last `roverlink generate`, which then writes the new ones, so this warning appears once.

    Bad::

        # mapping.lock says `2 ArmControl max_rate: 50`
        - {number: 2, name: arm_ctrl, proto: ArmControl, topic: arm_ctrl, direction: ros_to_hardware, max_rate: 500}

    Good::

        - {number: 2, name: arm_ctrl, proto: ArmControl, topic: arm_ctrl, direction: ros_to_hardware, max_rate: 50}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each limit of a row that is gone, or weaker than it was published."""
        for row in context.table.rows:
            changed = context.changed_settings(row)
            for key in changed:
                peer, _, kind = key.removeprefix(FORWARD).rpartition(" ")
                # TAB109 reports the new direction of a row that has no priority any more, and a lost forward
                gone = peer not in row.forward if peer else kind == "priority" and row.inbound and not row.forward
                if kind not in LIMITS or gone or not _is_weaker(kind, changed[key]):
                    continue
                limit = changed[key].now
                now = f"has `{key}` {limit.text!r}" if limit else f"has no `{key}`"
                message = f"{row.name!r} {now}; {changed[key].published}"
                span = limit.span if limit else row.at("name")
                help, place = "restore the limit, or check the boards and nodes that rely on it", row.at("direction")
                yield context.diagnostic_of_change(cls, row, changed[key], message, help, span, rests_on=place)


def _is_weaker(key: str, change: ChangedSetting) -> bool:
    before = [setting.amount for setting in change.before.values()]
    if change.now is None:
        return True
    return change.now.amount > min(before) if key in ("max_rate", "at_least") else change.now.amount < max(before)


class TopicTypeChanged(LintRule, id="TAB112", severity=Severity.WARNING):
    """A topic of a published row has another ROS 2 message than before.

    Topics with different types do not connect. A node that still uses the old message gets nothing, and reports no
    error. The same holds for a bag that was recorded with the old message. The next `roverlink generate` writes the new
    message into the ledger (mapping.lock), so this warning appears once.

    Bad::

        # mapping.lock says `12 SensorBoardGPSInfo ros: comms/GpsInfo`
        - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, ros: Gps, topic: gps_data, direction: hardware_to_ros}

    Good::

        - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, ros: GpsInfo, topic: gps_data,
           direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each topic that was published with another ROS 2 message."""
        for row, topic, change, _ in context.changed_topics():
            if change and change.now:
                message = f"the topic {topic!r} has the message {change.now.text!r}; {change.published}"
                help, span = "restore the old message, or change all nodes that use the topic", change.now.span
                yield context.diagnostic_of_change(cls, row, change, message, help, span, rests_on=span)


class TopicQosChanged(LintRule, id="TAB113", severity=Severity.WARNING):
    """A topic of a published row has another quality of service (QoS) than before.

    A best-effort publisher does not reach a reliable subscriber, and a volatile one no `transient_local` subscriber.
    Such a node gets nothing, and only a warning in its log. A shorter queue loses messages in a burst. The next
    `roverlink generate` writes the new QoS into the ledger (mapping.lock), so this warning appears once.

    Bad::

        # mapping.lock says `12 SensorBoardGPSInfo qos: reliable volatile keep_last 10`
        - number: 12
          name: gps_info
          proto: SensorBoardGPSInfo
          topic: gps_data
          direction: hardware_to_ros
          qos: {reliability: best_effort}

    Good::

        - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each topic that was published with another QoS."""
        for row, topic, _, change in context.changed_topics():
            if change and change.now:
                message = f"the topic {topic!r} has the QoS {change.now.text!r}; {change.published}"
                help, span = "restore the old QoS, or check all nodes that use the topic", change.now.span
                yield context.diagnostic_of_change(cls, row, change, message, help, span, rests_on=span)
