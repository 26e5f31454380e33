"""``roverlink``: from mapping.yaml to a running bridge."""

from __future__ import annotations

import argparse
import importlib
import os
import signal
import sys
from collections.abc import Sequence
from typing import Any

from roverlink.console import OK, UNABLE, complain
from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.node import ros_args

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
"""In the order of the help."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command. Returns 0 where all is well, 1 for findings or failed checks, 2 where it cannot run."""
    own, ros = ros_args.split(list(sys.argv[1:] if argv is None else argv))
    parser = command_line(own)
    arguments = parser.parse_args(own)
    arguments.ros_args = ros
    if ros and not arguments.takes_ros_args:
        parser.error(f"{own[0]} takes no --ros-args")
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        code = int(arguments.run(arguments))
        sys.stdout.flush()  # here, where a reader that has gone is no error
    except RoverlinkError as error:
        complain(str(error))
        return UNABLE
    except KeyboardInterrupt:
        return OK
    except BrokenPipeError:
        # Whoever read our output has had enough; what Python still holds of it must not complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OK
    return code


def _interrupt(*_: object) -> None:
    """End on SIGTERM as on SIGINT: whatever is open is closed, a bridge of the demo's among it."""
    raise KeyboardInterrupt


class _Version(argparse.Action):
    """Prints the version, which is looked up only here: that is slow."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from roverlink.installed_packages import installed_version

        print(f"roverlink {installed_version('roverlink') or '(not installed, but run from its files)'}")
        parser.exit()


class _AnyOrderParser(argparse.ArgumentParser):
    """Takes options among the positional arguments too, as `ros2 topic pub` does."""

    _in_any_order = True

    def add_subparsers(self, **options: Any) -> Any:
        """Have subcommands, whose own parsers take their options in any order."""
        self._in_any_order = False
        return super().add_subparsers(**options)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        if not self._in_any_order:
            return super().parse_known_args(args, namespace)
        self._in_any_order = False  # it calls this method for what is left when the options are out
        try:
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self._in_any_order = True


def command_line(arguments: Sequence[str] = ()) -> argparse.ArgumentParser:
    """Return the parser of a command line: with the command that it calls, else with all of them.

    A command is imported only if it is called, since the generator is slow to import.
    """
    parser = argparse.ArgumentParser(
        prog="roverlink",
        description="One table from protobuf over UDP to ROS 2 topics.",
        epilog="example: roverlink generate && roverlink run",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version of roverlink and exit")
    parser.set_defaults(takes_ros_args=False)
    commands = parser.add_subparsers(required=True, metavar="command", parser_class=_AnyOrderParser)
    called = [name for name in COMMANDS if name in arguments[:1]]
    for name in called or COMMANDS:
        importlib.import_module(f"roverlink.commands.{name.replace('-', '_')}").add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())
