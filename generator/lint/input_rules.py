"""The rules of a lint that cannot look at something: a state, the protos, the history, the pins."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

NO_SUCH_STATE = Rule(
    "STA101",
    "no-such-state",
    """`--against` names no folder, no file and no git ref.

Without the earlier state, no change can be judged.

Bad::

    $ roverlink lint --against mian

Good::

    $ roverlink lint --against main
""",
    Severity.FATAL,
)

UNREADABLE_STATE = Rule(
    "STA102",
    "unreadable-state",
    """The earlier state, or a file of it, cannot be read or does not compile.

Changes of messages that are unknown there cannot be judged.

Bad::

    old.binpb: fatal[STA102] is not a descriptor set

Good::

    $ protoc --include_imports -o old.binpb -I proto proto/imu.proto
""",
    Severity.FATAL,
)

NO_PROTOS = Rule(
    "STA103",
    "no-protos",
    """The folder does not exist or contains no `.proto` file.

A lint that looked at nothing must not pass.

Bad::

    $ roverlink lint protos
    protos: fatal[STA103] holds no .proto file

Good::

    $ roverlink lint proto
""",
    Severity.FATAL,
)

NO_ENVELOPE_MESSAGE = Rule(
    "STA104",
    "no-envelope-message",
    """In a tree without a table, the envelope's message is not declared, or nobody named it.

Numbers of payloads are numbers of the envelope, so the lint has to know which message it is.

Bad::

    $ roverlink next-number proto

Good::

    $ roverlink next-number proto --message PBEnvelope
""",
    Severity.FATAL,
)

UNREADABLE_HISTORY = Rule(
    "STA105",
    "unreadable-history",
    """git's history cannot be read.

There is no repository, or git is not installed.

Bad::

    $ cd ~/download/rover-main && roverlink lint --history

Good::

    $ git clone https://example.com/rover && cd rover && roverlink lint --history
""",
    Severity.FATAL,
)

LIMITED_HISTORY = Rule(
    "STA106",
    "limited-history",
    """A part of the history is not there, or some state of a file cannot be read.

A number that was used only in that part looks unused. CI systems clone without history unless they are told to.

Bad::

    $ git clone --depth 1 https://example.com/rover

Good::

    $ git fetch --unshallow
""",
    Severity.WARNING,
)

UNREADABLE_PINS = Rule(
    "PIN101",
    "unreadable-pins",
    """A source of pins cannot be read, contains none, or names a commit that the repository does not have.

A consumer whose commit is unknown could disagree with all others.

Bad::

    $ roverlink lint --pins pins.txt   # `rover 0000000`

Good::

    $ roverlink lint --pins pins.txt   # `rover 4f1c2ab`
""",
    Severity.FATAL,
)
