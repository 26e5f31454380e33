"""Entry point of ``roverlink``: parse the command line and run the command."""

from __future__ import annotations

import argparse
import importlib
import os
import signal
import sys
from collections.abc import Sequence
from typing import Any

from roverlink.console import OK, UNABLE, print_error
from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.ros_arguments import ros_args

COMMANDS = (
    "init",
    "generate",
    "add",
    "lint",
    "explain",
    "retire",
    "next-number",
    "history",
    "run",
    "send",
    "listen",
    "echo",
    "pub",
    "simulate",
    "record",
    "replay",
    "export",
    "info",
    "top",
    "doctor",
    "aruco",
    "demo",
)
"""Commands in the order of the help."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command. Returns 0 for success, 1 for findings or failed checks, 2 if the command cannot run."""
    own, ros = ros_args.split(list(sys.argv[1:] if argv is None else argv))
    parser = command_line(own)
    arguments = parser.parse_args(own)
    arguments.ros_args = ros
    if ros and not arguments.takes_ros_args:
        parser.error(f"{own[0]} does not take --ros-args")
    # systemd and docker stop a program with SIGTERM.
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        code = int(arguments.run(arguments))
        sys.stdout.flush()  # here, so that a closed pipe is handled below
    except RoverlinkError as error:
        print_error(str(error))
        return UNABLE
    except KeyboardInterrupt:
        return OK
    except BrokenPipeError:
        # The reader of our output has closed the pipe (`| head`). Python flushes stdout at exit, which must not fail.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OK
    return code


def _interrupt(*_: object) -> None:
    """Handle SIGTERM like SIGINT: raise KeyboardInterrupt, so that all context managers close what they have opened.

    An example is the bridge process of the demo.
    """
    raise KeyboardInterrupt


class _Version(argparse.Action):
    """Action of the option ``--version``. It looks the version up only when it is called, because that is slow."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from roverlink.installed_packages import installed_version

        print(f"roverlink {installed_version('roverlink') or '(not installed; running from its source files)'}")
        parser.exit()


class _AnyOrderParser(argparse.ArgumentParser):
    """Parser that accepts options between positional arguments, as `ros2 topic pub` does."""

    _in_any_order = True

    def add_subparsers(self, **options: Any) -> Any:
        """Add subcommands. Then only the parsers of the subcommands accept options in any order, not this parser."""
        self._in_any_order = False
        return super().add_subparsers(**options)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        if not self._in_any_order:
            return super().parse_known_args(args, namespace)
        self._in_any_order = False  # parse_known_intermixed_args calls this method again for the remaining arguments
        try:
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self._in_any_order = True


def command_line(arguments: Sequence[str] = ()) -> argparse.ArgumentParser:
    """Return the parser for a command line.

    The parser has only the command that ``arguments`` call, or all commands if they call none. Importing a command can
    be slow, because it may import the generator.
    """
    parser = argparse.ArgumentParser(
        prog="roverlink",
        description="Bridge protobuf datagrams over UDP and ROS 2 topics, by the table mapping.yaml.",
        epilog="example: roverlink generate && roverlink run",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version of roverlink and exit")
    parser.set_defaults(takes_ros_args=False)
    commands = parser.add_subparsers(required=True, metavar="command", parser_class=_AnyOrderParser)
    # Only the first argument names a command: `roverlink explain run` calls `explain`.
    called = [name for name in COMMANDS if name in arguments[:1]]
    for name in called or COMMANDS:
        importlib.import_module(f"roverlink.commands.{name.replace('-', '_')}").add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())
