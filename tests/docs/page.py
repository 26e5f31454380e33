"""A page of the documentation as something to follow: its fenced blocks, carried out in order.

- ``proto``: a file to create; its first line, a comment, names it.
- ``diff``: an edit of the file that ``---`` names; the lines of a hunk say where, since a page counts no lines.
- ``yaml``: a row to add at the end of `messages` in mapping.yaml.
- ``console``: commands after ``$``, each with the output that the page shows. A ``...`` in it stands for any text.
  Commands that wait for others (``roverlink run``, ``echo``, ``listen``, ``drive``, ``aruco track --loop``) stay in
  their terminal until the next heading; what they show is compared there, and what has no end is stopped by what Ctrl-C
  sends.
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from polling import PATIENCE_S, wait_until

from roverlink.dds_domain import claim_domain

ROOT = Path(__file__).parents[2]
_PROJECT = (
    *("mapping.yaml", "mapping.lock", ".gitignore", "proto", "generated", "docs"),
    *("generator", "templates", "runtime", "cpp", "native", "roverlink", "rover/docs"),
)
_READY = {
    "roverlink run": "UDP port",
    "roverlink listen": "UDP port",
    "roverlink aruco": "at a distance of",
    "roverlink drive": "is AUTO",
}
"""What a command shows as soon as it waits; `roverlink echo` shows nothing before a message comes."""
_ACTIVATE = ". .venv/bin/activate"
"""What a reader types first; the `roverlink` of this reader is on the PATH."""
_WAITING = ("roverlink run", "roverlink echo", "roverlink listen", "roverlink drive")
"""What stays in its terminal; the camera's program does where its recording is played in a loop."""
_ENDLESS = ("roverlink run", "roverlink aruco", "roverlink drive")
"""What goes on until it is stopped."""
_FENCE = re.compile(r"^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)
_HEADING = re.compile(r"^#+ .*$", re.MULTILINE)

# The reader's `roverlink`: that of the copy, over DDS, and on ports that no other test has.
_ROVERLINK = """\
#!/bin/sh
command=$1; shift
case $command:$* in
run:*--as*) set -- --middleware dds "$@" --ros-args -p listen_port:={basestation} -p rover_port:={listen} ;;
run:*) set -- --middleware dds "$@" --ros-args -p listen_port:={listen} -p dst_a_port:={basestation} \\
    -p dst_b_port:={hardware} ;;
echo:* | pub:* | drive:*) set -- --middleware dds "$@" ;;
send:*) set -- --to 127.0.0.1:{listen} "$@" ;;
listen:*)
    case "$*" in
    *6000*) set -- "$@" --port {basestation} ;;
    *) set -- "$@" --port {hardware} ;;
    esac ;;
esac
exec {python} -m roverlink "$command" "$@"
"""


@dataclass(frozen=True)
class Block:
    """A fenced block, or a heading (language ``#``)."""

    language: str
    text: str
    line: int


def blocks(page: Path, section: str = "") -> list[Block]:
    """The headings and fenced blocks of a page, or of one of its ``##`` sections, in order."""
    text = page.read_text(encoding="utf-8")
    fences = list(_FENCE.finditer(text))
    inside = [range(fence.start(), fence.end()) for fence in fences]
    headings = (one for one in _HEADING.finditer(text) if not any(one.start() in fence for fence in inside))
    found = [(fence.start(), fence["language"], fence["text"]) for fence in fences]
    found += [(heading.start(), "#", heading.group()) for heading in headings]
    every = [Block(language, part, text.count("\n", 0, start) + 1) for start, language, part in sorted(found)]
    return list(_section(every, section)) if section else every


def _section(every: list[Block], section: str) -> Iterator[Block]:
    start = next(index for index, block in enumerate(every) if block.text == f"## {section}")
    yield every[start]
    yield from itertools.takewhile(lambda block: not block.text.startswith("## "), every[start + 1 :])


@dataclass
class _Terminal:
    """A command that waits for others, and what it has to have shown when it ends."""

    command: str
    shown: str
    line: int
    log: Path
    process: subprocess.Popen[bytes]

    def output(self) -> str:
        return self.log.read_text(encoding="utf-8")


@dataclass
class Reader:
    """Somebody who follows a page in a copy of the project. A context manager: leaving it ends what still runs."""

    project: Path
    environment: dict[str, str]
    _held: ExitStack
    _terminals: list[_Terminal] = field(default_factory=list)

    @classmethod
    def in_copy(cls, folder: Path) -> Reader:
        """A reader with a copy of the project in a folder, committed where git is there."""
        project, tools = folder / "project", folder / "tools"
        project.mkdir()
        tools.mkdir()
        for name in filter(Path.exists, map(ROOT.joinpath, _PROJECT)):
            target = project / name.relative_to(ROOT)
            target.parent.mkdir(exist_ok=True)
            subprocess.run(["cp", "-a", name, target], check=True)  # roverlink/ links to the other folders
        held = ExitStack()
        domain = claim_domain(held)
        ports = dict(zip(("listen", "basestation", "hardware"), ports_of(domain)))
        roverlink = tools / "roverlink"
        roverlink.write_text(_ROVERLINK.format(python=sys.executable, **ports), encoding="utf-8")
        roverlink.chmod(0o755)
        me = "reader@example.com"
        environment = {
            **{name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "CYCLONEDDS_URI")},
            "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}",
            "HOME": str(folder),
            "PYTHONDONTWRITEBYTECODE": "1",
            "ROS_DOMAIN_ID": str(domain),
            "ROS_LOCALHOST_ONLY": "1",
            **{f"GIT_{who}_{what}": me for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")},
        }
        reader = cls(project, environment, held)
        if shutil.which("git"):
            reader._shell("git init --quiet && git add . && git commit --quiet --message before")
        return reader

    def __enter__(self) -> Reader:
        return self

    def __exit__(self, *_: object) -> None:
        for terminal in self._terminals:
            if terminal.process.poll() is None:
                terminal.process.kill()
                terminal.process.wait()
        self._held.close()

    def follow(self, page: list[Block]) -> None:
        """Do what each block says, and compare what it shows."""
        do = {"#": self._leave_terminals, "console": self._type}
        do |= {"proto": self._create, "diff": self._edit, "yaml": self._add_row}
        for block in page:
            assert block.language in do, f"line {block.line}: nobody can follow a block of {block.language!r}"
            do[block.language](block)
        self._leave_terminals()

    # --- files ---

    def _create(self, block: Block) -> None:
        path = self.project / block.text.partition("\n")[0].removeprefix("// ")
        assert not path.exists(), f"line {block.line}: {path.name} is there already"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(block.text, encoding="utf-8")

    def _edit(self, block: Block) -> None:
        header, *hunks = re.split(r"^@@.*\n", block.text, flags=re.MULTILINE)
        path = self.project / header.splitlines()[0].removeprefix("--- ")
        text = path.read_text(encoding="utf-8")
        for hunk in hunks:
            before = _side(hunk, " -")
            assert text.count(before) == 1, f"line {block.line}: {path.name} does not have this once:\n{before}"
            text = text.replace(before, _side(hunk, " +"))
        path.write_text(text, encoding="utf-8")

    def _add_row(self, block: Block) -> None:
        path, end = self.project / "mapping.yaml", "\n\nretired:"
        text = path.read_text(encoding="utf-8")
        assert text.count(end) == 1, f"line {block.line}: `messages` does not end before `retired`"
        path.write_text(text.replace(end, f"\n{block.text}{end[1:]}"), encoding="utf-8")

    # --- terminals ---

    def _type(self, block: Block) -> None:
        code = 0
        for command, shown in _commands(block.text):
            if command == "echo $?":
                assert shown == f"{code}\n", f"line {block.line}: the exit code is {code}"
                code = 0
            elif command == _ACTIVATE or (command.startswith("git ") and shutil.which("git") is None):
                continue
            else:
                assert code == 0, f"line {block.line}: exit code {code}, which the page does not show"
                code = self._run(command, shown, block.line)
        assert code == 0, f"line {block.line}: exit code {code}, which the page does not show"

    def _run(self, command: str, shown: str, line: int) -> int:
        if command.startswith(_WAITING) or "--loop" in command:
            self._terminals.append(self._open(command, shown, line))
            return 0
        done = self._shell(command)
        _compare(command, shown, done.stdout, line)
        return done.returncode

    def _shell(self, command: str) -> subprocess.CompletedProcess[str]:
        where = {"cwd": self.project, "env": self.environment}
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        return subprocess.run(["/bin/sh", "-c", command], **where, **streams, timeout=PATIENCE_S)  # type: ignore[call-overload]

    def _open(self, command: str, shown: str, line: int) -> _Terminal:
        log = self.project.parent / f"terminal-{line}.log"
        with log.open("wb") as output:
            shell, where = ["/bin/sh", "-c", f"exec {command}"], {"cwd": self.project, "env": self.environment}
            process = subprocess.Popen(shell, **where, stdout=output, stderr=subprocess.STDOUT)  # type: ignore[call-overload]
        terminal = _Terminal(command, shown, line, log, process)
        if ready := next((text for start, text in _READY.items() if command.startswith(start)), ""):
            wait_until(lambda: ready in terminal.output() or process.poll() is not None, repr(ready))
        return terminal

    def _leave_terminals(self, _: Block | None = None) -> None:
        for terminal in reversed(self._terminals):  # the bridge was opened first, and serves the others
            if terminal.command.startswith(_ENDLESS):
                terminal.process.send_signal(signal.SIGINT)
            code = terminal.process.wait(PATIENCE_S)
            _compare(terminal.command, terminal.shown, terminal.output(), terminal.line)
            assert code == 0, f"line {terminal.line}: {terminal.command} ends with exit code {code}"
        self._terminals.clear()


def ports_of(domain: int) -> tuple[int, int, int]:
    """UDP ports of a claimed DDS domain that no participant takes: they belong to whoever claimed it."""
    first = 7400 + 250 * domain
    return first + 246, first + 247, first + 248


def _side(hunk: str, marks: str) -> str:
    """The lines of a hunk before (`` -``) or after (`` +``) the edit; an empty line is context."""
    lines = [line or " " for line in hunk.splitlines()]
    return "".join(f"{line[1:]}\n" for line in lines if line[0] in marks)


def _commands(text: str) -> Iterator[tuple[str, str]]:
    """Each command of a console block, with the output that is shown for it."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, _, shown = part.partition("\n")
        while command.endswith("\\"):
            more, _, shown = shown.partition("\n")
            command = f"{command[:-1]}{more.lstrip()}"
        yield command, shown


def _compare(command: str, shown: str, real: str, line: int) -> None:
    pattern = ".*?".join(re.escape(_without_chance(part)) for part in shown.split("..."))
    assert re.fullmatch(pattern, _without_chance(real), re.DOTALL), f"line {line}: $ {command}\n{real}\nshown:\n{shown}"


def _without_chance(text: str) -> str:
    """Output without what differs from run to run: times and ports."""
    text = re.sub(r"\[\d+\.\d+\]", "[time]", text)
    return re.sub(r"(127\.0\.0\.1:|UDP port )\d+", r"\1port", text)
