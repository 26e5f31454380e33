"""The rules of the table reader: what mapping.yaml must look like before anything else can be checked."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

UNREADABLE = Rule(
    "MAP101",
    "unreadable-table",
    """The table cannot be read: it is missing, empty, or not UTF-8.

Nothing can be checked without the table. A file that another editor saved in Latin-1 or UTF-16 looks right there, but
no YAML reader takes it.

Bad::

    $ cd ~ && roverlink generate
    mapping.yaml: fatal[MAP101] cannot be read: No such file or directory

Good::

    $ roverlink generate --table ~/rover/mapping.yaml
""",
    Severity.FATAL,
)

SYNTAX = Rule(
    "MAP102",
    "yaml-syntax",
    """The table is not YAML.

The position is where the YAML reader gave up; the mistake is often one line above, such as a missing bracket or a key
that is indented by one space less than its neighbours. YAML does not allow tabs for indentation.

Bad::

    ros: {package: rover

Good::

    ros: {package: rover}
""",
)

DUPLICATE_KEY = Rule(
    "MAP103",
    "duplicate-key",
    """A mapping has the same key twice.

YAML readers keep the last value and say nothing, so the first one is lost.

Bad::

    ros: {package: rover, package: rover_msgs}

Good::

    ros: {package: rover}
""",
)

UNKNOWN_KEY = Rule(
    "MAP104",
    "unknown-key",
    """A key is not part of the format; mostly it is misspelt.

A key that is ignored in silence leaves its author believing that it has an effect.

Bad::

    - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, queu: 5}

Good::

    - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, queue: 5}
""",
)

MISSING_KEY = Rule(
    "MAP105",
    "missing-key",
    """A required key is missing.

There is no value that would be right for every rover, so there is no default.

Bad::

    - {number: 1, name: imu, proto: Imu, direction: board_to_ros}

Good::

    - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
""",
)

WRONG_TYPE = Rule(
    "MAP106",
    "wrong-type",
    """A value has the wrong kind: a text instead of a number, a list instead of a mapping, and so on.

Quotes make a text of a number; brackets make a list, braces a mapping.

Bad::

    - {number: "1", name: imu, proto: Imu, topic: imu, direction: board_to_ros}

Good::

    - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
""",
)

SURPRISING_SCALAR = Rule(
    "MAP107",
    "surprising-scalar",
    """YAML reads the value as something else than it looks: `off` as false, `012` as 10.

The value in the file and the value in the program would differ.

Bad::

    - {number: 012, name: imu, proto: Imu, topic: imu, direction: board_to_ros}

Good::

    - {number: 12, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
""",
)

BAD_VALUE = Rule(
    "MAP108",
    "bad-value",
    """A value is out of range, not one of the choices, or not a name.

Numbers go into wire tags and ports, names into code and file names; each has a range or a spelling of its own.

Bad::

    peers: {board: {port: 70000}, base: {}}

Good::

    peers: {board: {port: 7000}, base: {}}
""",
)

CONFLICTING_KEYS = Rule(
    "MAP109",
    "conflicting-keys",
    """`queue` and `qos.depth` have different values.

Both set the depth of the topic's queue; only one of them could be used.

Bad::

    - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, queue: 5, qos: {depth: 6}}

Good::

    - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, qos: {depth: 6}}
""",
)
