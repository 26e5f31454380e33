"""Rules about input that the lint cannot read: an earlier state, the .proto files, git's history, or pins.

A pin is the commit of the .proto files that another project uses.
"""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

DEEPEN = "`git fetch --unshallow origin '+refs/heads/*:refs/remotes/origin/*'` (on GitHub: fetch-depth: 0)"
"""Help for a shallow clone, which has one branch and a part of its commits."""
CLONE = "install git, and run the command in a clone of the repository"
"""Help if git cannot be run, or if the folder is in no repository."""


class NoSuchState(Rule, id="STA101", severity=Severity.FATAL):
    """`--against` names something that is not a folder, a file or a git ref.

    `--against` names the earlier state of the project with which the lint compares. Without this state, the lint cannot
    check any change.

    Bad::

        $ roverlink lint --against mian

    Good::

        $ roverlink lint --against main
    """


class UnreadableState(Rule, id="STA102", severity=Severity.FATAL):
    """The earlier state, or a file of it, cannot be read or does not compile.

    The lint cannot check changes of messages that it cannot read in the earlier state. If only some files of the state
    cannot be read, this is a hint, because nobody can change the earlier state any more.

    Bad::

        old.binpb: fatal[STA102] the file is not a descriptor set

    Good::

        $ protoc --include_imports -o old.binpb -I proto proto/imu.proto
    """


class NoProtos(Rule, id="STA103", severity=Severity.FATAL):
    """The folder that the lint has to check is no folder, is outside the git repository, or has no `.proto` file.

    A lint run that read no file must not succeed.

    Bad::

        $ roverlink lint protos
        protos: fatal[STA103] the folder contains no .proto file

    Good::

        $ roverlink lint proto
    """


class NoEnvelopeMessage(Rule, id="STA104", severity=Severity.FATAL):
    """The envelope's message is not named, or no file declares it, in a folder without a mapping.yaml.

    The numbers of the payloads are field numbers of the envelope, so the lint has to know this message.

    Bad::

        $ roverlink number next proto

    Good::

        $ roverlink number next proto --message PBEnvelope
    """


class UnreadableHistory(Rule, id="STA105", severity=Severity.FATAL):
    """git's history cannot be read.

    The folder is in no git repository, or git is not installed.

    Bad::

        $ cd ~/download/rover-main && roverlink lint --history

    Good::

        $ git clone https://example.com/rover && cd rover && roverlink lint --history
    """


class LimitedHistory(Rule, id="STA106", severity=Severity.WARNING):
    """A part of git's history is missing, or an old state of a file cannot be read.

    A number that was used only in the missing part looks unused. Many CI systems clone without history by default.

    Bad::

        $ git clone --depth 1 https://example.com/rover

    Good::

        $ git fetch --unshallow origin '+refs/heads/*:refs/remotes/origin/*'
    """


class WrongProtoRoot(Rule, id="STA107", severity=Severity.FATAL):
    """The imports of the `.proto` files start at another folder than the given proto root.

    protoc looks for every import below the proto root. From a wrong one, it cannot compile the files that import
    others.

    Bad::

        $ roverlink lint .
        .: fatal[STA107] 2 of 2 imports, such as 'common/header.proto' in 'proto/imu.proto', are not found from here;
        they start at 'proto'

    Good::

        $ roverlink lint proto
    """


class PastNotFollowed(Rule, id="STA108", severity=Severity.HINT):
    """The earlier history of a `.proto` file is not read, because the file was not moved in one commit.

    The lint follows a file from elsewhere in the repository to the proto root if one commit deletes the one and adds
    the other. If one commit copies the file and another one deletes the original, the file may as well be a copy of
    another project's file. Its earlier numbers are then not known. Nor are those of files that were put in the place of
    a submodule, because their history is in another repository.

    Bad::

        $ git log --stat   # "Copy api/imu.proto to proto/", and later "Delete api/"

    Good::

        $ git mv api/imu.proto proto/imu.proto && git commit
    """


class UnreadablePins(Rule, id="PIN101", severity=Severity.FATAL):
    """A source of pins cannot be read, contains no pin, or names a commit that the repository does not have.

    A pin names the commit of the .proto files that another project uses. If this commit is unknown, the project may use
    numbers with other meanings, and the lint cannot see it.

    Bad::

        $ roverlink lint --pins pins.txt   # `rover 0000000`

    Good::

        $ roverlink lint --pins pins.txt   # `rover 4f1c2ab`
    """
