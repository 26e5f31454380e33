"""Rules about the settings that keep a rover from moving by mistake: deadman, rates, and sources of peers."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule

MISPLACED = Rule(
    "SAF101",
    "misplaced-guard",
    """A row has `deadman` or `priority`, but cannot use it.

Both settings are for topics that are sent to a peer, so a row from a peer cannot use them. If a row to a peer has extra
topics under `also`, `deadman` would not notice that one topic is silent while another one is active.

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

A wrong stop message must be found now, not when the rover has to stop.

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
    """A peer has a `source_rate`, but no `sources`.

The rate is a limit for each source. Without a list of sources, datagrams cannot be counted by source.

Bad::

    peers: {board: {source_rate: 100}, base: {}}

Good::

    peers: {board: {source_rate: 100, sources: [10.0.0.7]}, base: {}}
""",
)
