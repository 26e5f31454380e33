"""Rules for the steps that find and compile the .proto files."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class ProtoDoesNotCompile(Rule, id="PRO101"):
    """protoc rejects a file that the table needs.

    The text of the error comes from protoc, the protobuf compiler. Nothing can be generated from a file that protoc
    cannot read. If the envelope does not need the file, leave it out: list it under `proto.exclude`, or in a folder
    without a table name it with `--exclude`, or accept the error with `--accept PRO101:FILE`.

    Bad::

        message Imu {
          float x = 1
        }

    Good::

        message Imu {
          float x = 1;
        }
    """


class UnreadableProto(Rule, id="PRO102", severity=Severity.FATAL):
    """A `.proto` file or a folder cannot be read.

    The file is binary, has more than 8 MiB, is not accessible, or is not a regular file, such as a pipe or a device. Or
    a link leads out of the git repository, into its folder `.git`, or to a folder above the link. Such a file or folder
    is skipped: it could be private or endless. It is reported, because it could declare a number that is in use. All
    files of a folder together may have 32 MiB.

    Bad::

        proto/imu.proto: fatal[PRO102] the file cannot be read: Permission denied

    Good::

        $ chmod +r proto/imu.proto
    """


class UnknownProtoMessage(Rule, id="PRO103"):
    """No file below `proto.root` declares the message of a row.

    The name is misspelt, the package is missing from the name, or the file does not exist.

    Bad::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imuu, topic: imu, direction: board_to_ros}
        # proto/imu.proto
        message Imu { float x = 1; }

    Good::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
        # proto/imu.proto
        message Imu { float x = 1; }
    """


class ExcludedProtoMessage(Rule, id="PRO104"):
    """A message is declared only in a file that `proto.exclude` leaves out.

    Excluded files are not compiled, so the fields of the message are unknown.

    Bad::

        # mapping.yaml
        proto: {root: proto, exclude: [imu.proto]}
        # proto/imu.proto
        message Imu { float x = 1; }

    Good::

        # mapping.yaml
        proto: {root: proto}
        # proto/imu.proto
        message Imu { float x = 1; }
    """


class AmbiguousProtoMessage(Rule, id="PRO105"):
    """Several files declare the message of a row.

    The wrong declaration might be compiled. Exclude all files but one, or rename one of the messages.

    Bad::

        # proto/imu.proto
        message Imu { float x = 1; }
        # proto/old/imu.proto
        message Imu { float y = 1; }

    Good::

        # proto/imu.proto
        message Imu { float x = 1; }
        # proto/old/imu.proto
        message OldImu { float y = 1; }
    """


class UnimportableProtoPath(Rule, id="PRO106"):
    """A part of a file's path cannot be the name of a Python module, or two files have one module.

    protoc makes a Python module of each file, with underscores in place of hyphens. A leading digit, a space or a
    keyword in the path makes it impossible to import that module.

    Bad::

        # proto/2d/imu.proto
        message Imu { float x = 1; }

    Good::

        # proto/flat/imu.proto
        message Imu { float x = 1; }
    """


class NoProtoRoot(Rule, id="PRO107"):
    """`proto.root` is not a folder, or is outside the git repository.

    `proto.root` is the folder of the .proto files. The path is relative to the folder of mapping.yaml. A pull request
    must not make `generate` read files outside the repository. Add another repository as a submodule.

    Bad::

        proto: {root: protos}

    Good::

        proto: {root: proto}
    """


class NoEnvelopeFile(Rule, id="PRO108"):
    """The envelope belongs to another repository (`owner: proto`), and its file is missing.

    The numbers of the envelope are used on the wire, so `generate` must not invent them. With `owner: mapping`,
    `generate` writes the file.

    Bad::

        envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}

    Good::

        envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: mapping}
    """


class PayloadInEnvelopeFile(Rule, id="PRO109"):
    """A payload is the envelope itself, or is declared in the envelope's file, which `generate` writes.

    `generate` replaces the whole file, so the payload's declaration would be lost.

    Bad::

        # proto/envelope.proto
        message Imu { float x = 1; }

    Good::

        # proto/imu.proto
        message Imu { float x = 1; }
    """
