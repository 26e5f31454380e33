"""Command line of ``roverlink``: its parser, completion in a shell, and the run of a command.

A command is imported only if the command line names it. Whatever is slow to import and not always needed is imported
where it is used, so that `roverlink --version` and a misspelled command end at once.
"""

from __future__ import annotations

import argparse
import importlib
import os
import signal
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from roverlink.console import Subparsers

GROUPS = {
    "the table": ("init", "add", "generate", "lint", "explain", "number"),
    "the bridge": ("run", "deploy", "link", "send", "listen", "echo", "pub", "simulate", "demo", "zenoh-router"),
    "watching and recording": ("top", "doctor", "record", "recording"),
}
"""Names of roverlink's own commands by their job, in the order in which ``roverlink --help`` lists them."""
ELSEWHERE = {
    "roverkit": {
        "aruco": "vision",
        "objects": "detect",
        "rocks": "vision",
        "video": "video",
        "fuse": "fusion",
        **dict.fromkeys(("drive", "odometry", "mission", "simulate-rover"), ""),
    },
    "check-launch": {"check-launch": ""},
}
"""Names of the commands that other packages of this repository add, each with the extra that it needs, if any."""
FOLDERS = {"roverkit": "rover", "check-launch": "check_launch"}
"""Folders of these packages in the repository."""
COMMANDS = tuple(name for names in (*GROUPS.values(), *ELSEWHERE.values()) for name in names)
"""Names of all commands."""
ENTRY_POINTS = "roverlink.commands"
"""Group of entry points of the packages that add commands: each is a module with a function ``add``."""


_COMPLETION = "_ARGCOMPLETE"
"""Environment variable that is set while a shell asks argcomplete for the completions of a command line."""


def parse(argv: Sequence[str] | None) -> argparse.Namespace:
    """Parse a command line, and return its options; their attribute ``run`` is the function of the command.

    ``argv`` is the command line without the program's name; None for that of this process. Exits with code 2 if the
    command line has a mistake or is empty, and with code 0 after ``--help``, ``--version`` or a completion.
    """
    if _COMPLETION in os.environ:
        _complete()
    own, ros = list(sys.argv[1:] if argv is None else argv), list[str]()
    if not own:
        command_line(["--help"]).print_help()
        raise SystemExit(2)
    if own[0] == "help":
        command_line([]).error(f"unknown command 'help'; did you mean `{' '.join(['roverlink', *own[1:], '--help'])}`?")
    if "--ros-args" in own:
        from roverlink.runtime.ros_arguments import ros_args

        own, ros = ros_args.split(own)
    parser = command_line(own)
    arguments, unknown = parser.parse_known_args(own)
    if unknown:
        parser.prog += f" {own[0]}"  # its help has the arguments
        of_ros = next((word for word in unknown if word in ("-p", "-r")), "") if arguments.takes_ros_args else ""
        hint = f"; write --ros-args before {of_ros}" if of_ros else ""
        parser.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
    arguments.ros_args = ros
    if ros and not arguments.takes_ros_args:
        parser.error(f"{own[0]} does not take --ros-args")
    return arguments


def run(arguments: argparse.Namespace) -> int:
    """Run the command of a parsed command line, and return its exit code.

    Ctrl-C is the normal end of a command like `run`. A command like `generate` has not done its work then, so that a
    script must not go on as if it had: ``roverlink generate --check && deploy``.
    """
    from roverlink.console import INTERRUPTED, OK

    # systemd and docker stop a program with SIGTERM, a terminal that is closed with SIGHUP, unless nohup ignores it. A
    # program in the background of a script ignores SIGQUIT.
    signal.signal(signal.SIGTERM, _interrupt)
    for number in (signal.SIGHUP, signal.SIGQUIT):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _interrupt)
    try:
        with _all_threads_alive():
            code = int(arguments.run(arguments))
        sys.stdout.flush()  # here, so that a closed pipe is handled below
    except KeyboardInterrupt:
        return OK if arguments.runs_until_stopped else INTERRUPTED
    except BrokenPipeError:
        # The reader of our output has closed the pipe (`| head`). Python flushes stdout at exit, which must not fail.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OK
    return code


@contextmanager
def _all_threads_alive() -> Iterator[None]:
    """End the block with SIGTERM if a thread fails, and raise `FailedThreadError`: no program may go on half alive."""
    import threading

    from roverlink.runtime.core.errors import FailedThreadError

    failures = list[FailedThreadError]()

    def end(ended: threading.ExceptHookArgs) -> None:
        failure, thread = ended.exc_value, ended.thread
        if failure is None or isinstance(failure, SystemExit):  # a thread may end itself so
            return
        if not isinstance(failure, FailedThreadError):
            failure = FailedThreadError(thread.name if thread else "", failure)
        failures.append(failure)
        # To the main thread, so that it also ends a system call.
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)

    before, threading.excepthook = threading.excepthook, end
    try:
        yield
    except KeyboardInterrupt:
        if not failures:
            raise
    finally:
        threading.excepthook = before
    if failures:
        raise failures[0]


def _interrupt(*_: object) -> None:
    """Handle the signals SIGTERM, SIGHUP and SIGQUIT like Ctrl-C: raise KeyboardInterrupt.

    So the context managers of the command close what they have opened. For example, ``roverlink demo`` ends the process
    of its bridge.
    """
    raise KeyboardInterrupt


class _Version(argparse.Action):
    """Action of the option ``--version``: print the installed version of roverlink, and exit.

    The version is looked up only if the option is given, because the look-up is slow.
    """

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from roverlink.installed_packages import installed_version

        print(f"roverlink {installed_version('roverlink') or '(not installed; running from its source files)'}")
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """Parser that accepts options between positional arguments, as `ros2 topic pub` does, and hints at misspellings.

    A parser with subcommands needs its own options in front, because argparse cannot combine subcommands with options
    in any order. The parsers of the subcommands still accept options in any order.
    """

    _commands: Any = None
    _is_parsing = False

    def add_subparsers(self, **options: Any) -> Any:
        self._commands = super().add_subparsers(**options)
        return self._commands

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        if self._is_parsing:  # parse_known_intermixed_args calls this method again
            return super().parse_known_args(args, namespace)
        if self._commands is not None and not args:
            self.print_help()
            self.exit(2)
        self._refuse_unknown_options(args)
        self._is_parsing = True
        try:
            if self._commands is not None:
                return super().parse_known_args(args, namespace)
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self._is_parsing = False

    def error(self, message: str) -> NoReturn:
        """Print what is wrong with the command line, and exit with code 2.

        argparse would first print the usage, whose many lines hide the message.
        """
        self.exit(2, f"{self.prog}: error: {message}\nrun `{self.prog} --help` for all arguments\n")

    def _refuse_unknown_options(self, arguments: Sequence[str]) -> None:
        """Exit with an error that suggests a similar option if a long option, or one before a command, is unknown.

        argparse would first report what is missing, and name no similar option.
        """
        known = [option for option in self._option_string_actions if option.startswith("--")]
        for argument in arguments:
            if argument == "--" or (self._commands is not None and not argument.startswith("-")):
                return  # from here on, arguments are values, or belong to the subcommand
            name = argument.partition("=")[0]
            # Like argparse, take what has a space in it for a value, and the beginning of an option for the option.
            if name.startswith("--") and " " not in argument and not any(option.startswith(name) for option in known):
                self.error(f"unknown option {_with_hint(name, known)}")
            if self._commands is not None and argument[:2] not in ("--", *self._option_string_actions):
                self.error(f"unknown option {_with_hint(argument, known)}")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Raise ArgumentError with a similar choice if a value or a subcommand is not one of the choices."""
        if action.choices is None or value in action.choices:
            return
        if action is self._commands:
            package = next((name for name, commands in ELSEWHERE.items() if value in commands), None)
            if package and not self.prog.count(" "):
                extra = ELSEWHERE[package][value]
                source = f"'./{FOLDERS[package]}[{extra}]'" if extra else f"./{FOLDERS[package]}"
                cure = (
                    f"install it in roverlink's repository with `pip install {source}`, elsewhere as in docs/install.md"
                )
                raise argparse.ArgumentError(None, f"{value!r} is a command of {package}; {cure}")
            known = [*action.choices, *(option for option in self._option_string_actions if option.startswith("--"))]
            raise argparse.ArgumentError(None, f"unknown command {_with_hint(value, known)}")
        raise argparse.ArgumentError(action, f"unknown value {_with_hint(value, action.choices)}")


def _with_hint(word: str, known: Iterable[str]) -> str:
    from roverlink.runtime.core.errors import nearest

    return f"{word!r}; {nearest(word, known)}"


def command_line(arguments: Sequence[str] | None = None) -> argparse.ArgumentParser:
    """Return the parser for a command line, given as its ``arguments`` without the program's name.

    If the first argument is the name of a command, such as ``run``, the parser knows only the options of this command.
    If the arguments ask for help, or are None, it knows those of all commands, which are slow to import. Otherwise it
    knows only the names of the commands.
    """
    return _parser(arguments, _Parser)


def _parser(arguments: Sequence[str] | None, parser_class: type[argparse.ArgumentParser]) -> argparse.ArgumentParser:
    parser = parser_class(
        prog="roverlink",
        usage="roverlink [--version] [--help] command ...",
        description="Bridge between protobuf datagrams over UDP and ROS 2 topics. The table mapping.yaml lists the "
        "bridged messages:\neach row has a protobuf message, its field number in the envelope, a ROS 2 topic and a "
        "direction.\n`roverlink generate` compiles the table into code, and `roverlink run` runs the bridge.\n"
        "`roverlink COMMAND --help` explains a command.",
        epilog="example: roverlink generate && roverlink run",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version of roverlink and exit")
    parser.set_defaults(takes_ros_args=False, runs_until_stopped=False)
    commands = parser.add_subparsers(required=True, metavar="command", prog="roverlink", parser_class=parser_class)
    own = {name: f"roverlink.commands.{name.replace('-', '_')}" for group in GROUPS.values() for name in group}
    # Only the first argument names a command: `roverlink explain run` calls `explain`.
    first = next(iter(arguments or ()), "")
    if first in own:
        importlib.import_module(own[first]).add(commands)
        return parser
    from roverlink.installed_packages import entry_points  # slow

    added = {entry.name: entry for entry in entry_points(ENTRY_POINTS)}
    if first in added:
        if failure := _add(added[first], commands):
            parser.exit(2, f"roverlink: the command {first} {failure}\n")
    elif arguments is None or any(_asks_for_help(argument) for argument in arguments):
        from roverlink.console import SUMMARY

        for module in own.values():
            importlib.import_module(module).add(commands)
        for name, entry in added.items():
            if failure := _add(entry, commands):
                (commands.choices.get(name) or commands.add_parser(name)).set_defaults(**{SUMMARY: failure})
        packages = {name: entry.dist.name if entry.dist else "" for name, entry in added.items()}
        parser.epilog = _lists(commands.choices, packages) + str(parser.epilog)
        parser.formatter_class = argparse.RawDescriptionHelpFormatter
        commands.help = argparse.SUPPRESS
    else:
        for name in (*own, *added):
            commands.add_parser(name, help="")  # without a help, zsh would show the completion as `None`
    return parser


def _add(entry: EntryPoint, commands: Subparsers) -> str:
    """Add the command of another package, and return ""; if its module cannot be loaded, return why, in one line."""
    from roverlink.installed_packages import cure
    from roverlink.runtime.core.errors import SetupError

    try:
        entry.load().add(commands)
    except (ImportError, SetupError) as error:
        reason = cure(error) if isinstance(error, ImportError) else None
        return f"cannot be loaded: {' '.join((reason or str(error)).split())}"  # numpy's text has many lines
    return ""


def _lists(parsers: Mapping[str, argparse.ArgumentParser], packages: Mapping[str, str]) -> str:
    """Return the lists of the commands by their job, then of those that other packages have added."""
    from roverlink.console import SUMMARY

    groups = {**GROUPS, **{f"from {package}": () for package in packages.values()}}
    for name, package in packages.items():
        groups[f"from {package}"] += (name,)
    return "".join(
        f"{group}:\n" + "".join(f"  {name:<15} {parsers[name].get_default(SUMMARY)}\n" for name in names) + "\n"
        for group, names in groups.items()
    )


def _asks_for_help(argument: str) -> bool:
    return argument.startswith("-h") or (len(argument) > 2 and "--help".startswith(argument))


def _complete() -> NoReturn:
    """Print the completions of the command line that a shell asks for, and exit."""
    import argcomplete

    # argcomplete looks into the parser while it parses, and knows only argparse's own.
    line = os.environ["COMP_LINE"][: int(os.environ["COMP_POINT"])]
    argcomplete.autocomplete(_parser(line.split()[1:], argparse.ArgumentParser))
    raise SystemExit(0)  # not reached: argcomplete exits
