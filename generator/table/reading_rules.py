"""Rules about mistakes in the form of mapping.yaml, which its reader finds before all other checks."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class UnreadableTable(Rule, id="MAP101", severity=Severity.FATAL):
    """The table, mapping.yaml, cannot be read: it is missing, empty, or not UTF-8.

    Nothing can be checked without the table. A file that an editor saved in Latin-1 or UTF-16 looks right in that
    editor, but the YAML reader needs UTF-8.

    Bad::

        $ cd ~ && roverlink generate
        mapping.yaml: fatal[MAP101] the table cannot be read: No such file or directory

    Good::

        $ roverlink generate --table ~/rover/mapping.yaml
    """


class YamlSyntax(Rule, id="MAP102"):
    """The table is not valid YAML.

    The position is where the YAML reader stopped. The mistake is often one line above, such as a missing bracket or a
    key that is indented by one space less than its neighbours. YAML does not allow tabs for indentation.

    Bad::

        ros: {package: rover

    Good::

        ros: {package: rover}
    """


class DuplicateKey(Rule, id="MAP103"):
    """A mapping has the same key twice.

    Most YAML readers keep the last value without a warning, so the first value would be lost.

    Bad::

        ros: {package: rover, package: rover_msgs}

    Good::

        ros: {package: rover}
    """


class UnknownKey(Rule, id="MAP104"):
    """A key is not part of the format; usually it is misspelt.

    If an unknown key were ignored, its author would believe that it has an effect.

    Bad::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, queu: 5}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, queue: 5}
    """


class MissingKey(Rule, id="MAP105"):
    """A required key is missing.

    The key has no default, because no value would be right for every rover.

    Bad::

        - {number: 1, name: imu, proto: Imu, direction: board_to_ros}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
    """


class WrongType(Rule, id="MAP106"):
    """A value has the wrong kind: a text instead of a number, a list instead of a mapping, and so on.

    In YAML, quotes turn a number into a text; square brackets make a list, and braces a mapping.

    Bad::

        - {number: "1", name: imu, proto: Imu, topic: imu, direction: board_to_ros}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
    """


class SurprisingScalar(Rule, id="MAP107"):
    """YAML reads the value differently from how it looks: `off` as false, `012` as 10.

    YAML 1.1 reads `yes`, `no`, `on` and `off` as booleans, `012` as octal and `1:30` as base 60. The value in the
    program would differ from the value that you see in the file.

    Bad::

        - {number: 012, name: imu, proto: Imu, topic: imu, direction: board_to_ros}

    Good::

        - {number: 12, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
    """


class BadValue(Rule, id="MAP108"):
    """A value is out of range, is not one of the choices, or is not a valid name.

    Numbers become field numbers and UDP ports, and names become code and file names. Each has its own range or
    spelling.

    Bad::

        peers: {board: {port: 70000}, base: {}}

    Good::

        peers: {board: {port: 7000}, base: {}}
    """


class ConflictingKeys(Rule, id="MAP109"):
    """`queue` and `qos.depth` have different values.

    Both set the depth of the topic's queue; only one of them could be used.

    Bad::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, queue: 5, qos: {depth: 6}}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, qos: {depth: 6}}
    """
