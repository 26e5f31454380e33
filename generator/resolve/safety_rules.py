"""The rules of the settings that keep a rover from moving by mistake: deadman, rates, sources."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule

MISPLACED = Rule(
    "SAF101",
    "misplaced-guard",
    """A row has `deadman` or `priority` where it cannot work.

Both are for topics that are sent to a peer. A row from a peer has nothing to send; and with further topics under
`also`, a silent commander would go unnoticed while another topic speaks.

Bad::

    - {number: 1, name: drive, proto: Drive, topic: drive, direction: board_to_ros, priority: 9}

Good::

    - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board, priority: 9}
""",
)

UNKNOWN_STOP_FIELD = Rule(
    "SAF102",
    "unknown-stop-field",
    """A path under `deadman.send` names no field of the payload.

The stop message would not contain the value that stops the actuator.

Bad::

    - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board,
       deadman: {after: 1s, send: {sped: 0}}}

Good::

    - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board, deadman: {after: 1s, send: {x: 0}}}
""",
)

STOP_VALUE = Rule(
    "SAF103",
    "stop-value",
    """A field cannot hold the value that `deadman.send` gives it.

The stop message must be valid at start, not on the day on which it is needed.

Bad::

    - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board,
       deadman: {after: 1s, send: {x: slow}}}

Good::

    - {number: 1, name: drive, proto: Drive, topic: drive, direction: ros_to_board, deadman: {after: 1s, send: {x: 0}}}
""",
)

SLOWER_THAN_DEADMAN = Rule(
    "SAF104",
    "rate-slower-than-deadman",
    """With this `max_rate`, the topic counts as silent between two messages.

The deadman would stop the peer all the time.

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
""",
)

RATE_WITHOUT_SOURCES = Rule(
    "SAF105",
    "rate-without-sources",
    """A peer has a `source_rate`, but names no `sources`.

The rate is a limit for each source; without a list of sources no datagram can be counted against it.

Bad::

    peers: {board: {source_rate: 100}, base: {}}

Good::

    peers: {board: {source_rate: 100, sources: [10.0.0.7]}, base: {}}
""",
)
