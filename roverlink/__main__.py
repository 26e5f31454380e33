"""Entry point of ``roverlink``.

It imports nothing before it has prepared for Ctrl-C, because imports are the longest part of a command's start. Even
``from __future__`` would read a file, and so would ``typing``. Python itself has imported ``os``.
"""

import os

_UNABLE, _INTERRUPTED = 2, 130  # those of `console`, which is slow to import
TYPE_CHECKING = False  # type checkers know the name
if TYPE_CHECKING:
    from collections.abc import Sequence


def main(argv: "Sequence[str] | None" = None) -> int:
    """Run the command that ``argv`` names, and return its exit code.

    ``argv`` is the command line without the program's name, such as ``["lint", "--history"]``; None for that of this
    process. Exit code 0 means success, 1 that the command found problems, 2 that it could not run, and 130 that Ctrl-C
    ended it before its work was done.

    This is the only guard around the commands of all packages: an error of a file or a value that no command expected
    ends it with one line and code 2. Other exceptions are bugs of ours, and Python prints their traceback. If the
    environment variable ROVERLINK_DEBUG is set, every error has its traceback.
    """
    try:
        import signal  # may be interrupted already

        # A program in the background of a script ignores SIGINT, and has to go on doing so.
        takes_interrupts = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if takes_interrupts:
            signal.signal(signal.SIGINT, _end_at_once)
        try:
            from roverlink import command_line

            arguments = command_line.parse(argv)
            if takes_interrupts:
                signal.signal(signal.SIGINT, signal.default_int_handler)
            return command_line.run(arguments)
        finally:
            # Python would print a traceback if Ctrl-C came while it shuts down. A caller in this process goes on.
            if takes_interrupts:
                signal.signal(signal.SIGINT, signal.SIG_IGN if argv is None else signal.default_int_handler)
    except KeyboardInterrupt:
        return _INTERRUPTED
    except Exception as error:
        from roverlink import error_lines

        if not error_lines.print_line(error):
            raise
        return _UNABLE


def _end_at_once(*_: object) -> None:
    """Handle Ctrl-C until the command line is parsed: end this process.

    Nothing is open yet that must be closed. An exception instead would pass through the imports of other packages, and
    some of them print or swallow it.
    """
    os._exit(_INTERRUPTED)


if __name__ == "__main__":
    raise SystemExit(main())
