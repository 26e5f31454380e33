"""Runs `roverlink` in forks of one process that has loaded it, because loading takes longer than most commands.

A script, run as ``forking.py PROJECT BYTES SECONDS``. It checks this project once, and then reads lines of JSON: a
folder, and the arguments of a command in it. It prints exit code, standard output and standard error of each,
as JSON. A command has BYTES of address space and SECONDS of time.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import signal
import sys
import tempfile

from roverlink.__main__ import main


def _serve(project: str, size: int, seconds: int) -> None:
    os.chdir(project)
    with contextlib.redirect_stdout(sys.stderr):
        assert [main(["generate", "--check"]), main(["lint"])] == [0, 0]
    for line in sys.stdin:
        folder, arguments = json.loads(line)
        with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
            child = os.fork()
            if not child:
                os.dup2(os.pipe()[0], 0)  # as a terminal at which nobody types
                os.dup2(output.fileno(), 1)
                os.dup2(errors.fileno(), 2)
                os.chdir(folder)
                resource.setrlimit(resource.RLIMIT_AS, (size, size))
                signal.alarm(seconds)
                sys.exit(main(arguments))
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            said = [file.seek(0) or file.read() for file in (output, errors)]
            print(json.dumps([code, *said]), flush=True)


if __name__ == "__main__":
    _serve(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
