"""Signals as a terminal gives them, for the programs that tests start."""

import signal


def restore_default_signals() -> None:
    """Let this process, and the programs that it starts, end at Ctrl-C and the like.

    A program inherits the signals that are ignored, and a script ignores SIGINT and SIGQUIT of what it starts with `&`.
    """
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler if number is signal.SIGINT else signal.SIG_DFL)
