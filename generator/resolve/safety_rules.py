"""Rules about the settings that keep a rover from moving by mistake: deadman, rates, and sources of peers."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule


class MisplacedGuard(Rule, id="SAF101"):
    """A row has `deadman`, `send` or `priority`, but its direction or its extra topics do not allow the setting.

    `deadman` is the payload that stops a peer when the row's topic is silent. `send` says which messages are sent.
    `priority` is the order in which messages to peers are sent. These settings are for topics that are sent to a peer,
    so a row from a peer cannot use them, except for `priority` of a row with `forward`. If a row to a peer has extra
    topics under `also`, `deadman` would stop the peer while one of the topics is still active, and `send` would repeat
    the old message of another topic.

    Bad::

        - {number: 1, name: drive, proto: Drive, topic: drive, direction: board_to_ros, priority: 9}

    Good::

        - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board, priority: 9}
    """


class UnknownStopField(Rule, id="SAF102"):
    """A path under `deadman.send` names no field of the payload.

    The bridge sends this payload when the row's topic is silent. With a wrong path, it would not contain the value that
    stops the actuator.

    Bad::

        - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board,
           deadman: {after: 1s, send: {sped: 0}}}

    Good::

        - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board,
           deadman: {after: 1s, send: {x: 0}}}
    """


class StopValue(Rule, id="SAF103"):
    """A field cannot hold the value that `deadman.send` gives it.

    The bridge sends this payload when the row's topic is silent. A wrong value must be found now, not when the rover
    has to stop.

    Bad::

        - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board,
           deadman: {after: 1s, send: {x: slow}}}

    Good::

        - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board,
           deadman: {after: 1s, send: {x: 0}}}
    """


class RateSlowerThanDeadman(Rule, id="SAF104"):
    """The `max_rate` of a row is so low that its topic counts as silent between two messages.

    If no message comes for the time `deadman.after`, the bridge sends the payload that stops the peer. The interval
    between two messages must be shorter than this time. Otherwise the bridge stops the peer all the time.

    Bad::

        - number: 1
          name: drive
          proto: Drive
          topic: drive
          direction: ros_to_board
          max_rate: 2
          deadman: {after: 500ms, send: {x: 0}}

    Good::

        - number: 1
          name: drive
          proto: Drive
          topic: drive
          direction: ros_to_board
          max_rate: 10
          deadman: {after: 500ms, send: {x: 0}}
    """


class RateWithoutSources(Rule, id="SAF105"):
    """A peer has a `source_rate`, but no `sources`.

    `source_rate` is the largest number of datagrams per second from each IP address in `sources`. Without this list,
    datagrams cannot be counted by address.

    Bad::

        peers: {board: {source_rate: 100}, base: {}}

    Good::

        peers: {board: {source_rate: 100, sources: [10.0.0.7]}, base: {}}
    """


class SignWithoutSigning(Rule, id="SAF106"):
    """A peer must sign its datagrams, but the envelope has no field for a signature.

    `signing` gives this field its number. The number is permanent, as that of a payload.

    Bad::

        peers: {board: {sign: required}}

    Good::

        peers: {board: {sign: required}}
        signing: {number: 22}
    """


class SendWithDeadman(Rule, id="SAF107"):
    """A row has both `send` and `deadman`.

    With `send`, a command that does not change is not sent, or the last one is sent again when the topic is silent. The
    deadman does the opposite: it stops the peer when the topic is silent.

    Bad::

        - number: 1
          name: drive
          proto: Drive
          topic: drive
          direction: ros_to_board
          send: {on_change: true}
          deadman: {after: 500ms, send: {x: 0}}

    Good::

        - number: 1
          name: drive
          proto: Drive
          topic: drive
          direction: ros_to_board
          deadman: {after: 500ms, send: {x: 0}}
    """
