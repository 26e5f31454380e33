"""Projects made of the examples of rules; `roverlink.generator.diagnostics.Rule` says how examples are written."""

from __future__ import annotations

import re
from pathlib import Path

from roverlink.generator.diagnostics import Rule

_BASE = {
    "version": "version: 1",
    "proto": "proto: {root: proto}",
    "envelope": "envelope: {file: envelope.proto, message: Envelope, oneof: payload}",
    "ros": "ros: {package: rover}",
    "peers": "peers: {board: {}, base: {}, hardware: {}, basestation: {}}",
    "messages": "messages:\n  - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}",
}
_TABLE = "mapping.yaml"
_HEADING = re.compile(r"(?:#|//) (\S+\.(?:yaml|proto|options|j2))")
_PROTO = re.compile(r"(syntax|import|message|enum|oneof|//)\b|//")
_CONSOLE = re.compile(r"\$ |\S+: (fatal|error|warning)\[")
_BEFORE = re.compile(r"(.*?) *// before")
_OLD_SYNTAX = re.compile(r"\b(required|default|extensions|message_set_wire_format)\b")


def example(rule: type[Rule], verdict: str) -> str:
    """Return the example under ``Bad::`` or ``Good::``, without its indentation."""
    _, _, rest = rule.documentation.partition(f"\n{verdict}::\n\n")
    lines = []
    for line in rest.splitlines():
        if line and not line.startswith("    "):
            break
        lines.append(line[4:])
    return "\n".join(lines).strip("\n")


def is_console(text: str) -> bool:
    """Tell whether an example is what a terminal shows, which no project can hold."""
    return bool(_CONSOLE.match(text))


def states(rule: type[Rule], verdict: str) -> tuple[str, str] | None:
    """Return a .proto file before and after a change; None for a rule whose examples are not about one."""
    bad = example(rule, "Bad").splitlines()
    before = [found[1] for line in bad if (found := _BEFORE.fullmatch(line))]
    if not before:
        return None
    after = bad if verdict == "Bad" else example(rule, "Good").splitlines()
    now = [line for line in after if not _BEFORE.fullmatch(line)]
    return _file("\n".join(before)), _file("\n".join(now))


def write_project(text: str, folder: Path) -> None:
    """Write the project that an example is a part of; what it leaves out is filled in."""
    files = _files(text)
    table = _table(files.pop(_TABLE, ""))
    if not any(path.endswith(".proto") for path in files):
        for name in dict.fromkeys(re.findall(r"proto: (\w+)[,}\n]", table)):
            files[f"proto/{name.lower()}.proto"] = f"message {name} {{ float x = 1; }}"
    elif "messages:" not in files and (found := re.search(r"message (\w+)", "".join(files.values()))):
        table = table.replace(_BASE["messages"], _BASE["messages"].replace("proto: Imu", f"proto: {found[1]}"))
    for path, content in {_TABLE: table, **files}.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(_file(content) if path.endswith(".proto") else f"{content}\n", encoding="utf-8")


def _file(text: str) -> str:
    if "syntax =" in text:
        return f"{text}\n"
    return f'syntax = "{"proto2" if _OLD_SYNTAX.search(text) else "proto3"}";\n{text}\n'


def _files(text: str) -> dict[str, str]:
    """Split an example at the comments that name files."""
    path = "proto/example.proto" if _PROTO.match(text) else _TABLE
    files: dict[str, list[str]] = {}
    for line in text.splitlines():
        if found := _HEADING.fullmatch(line):
            path = found[1] if "/" in found[1] or found[1] == _TABLE else f"proto/{found[1]}"
        else:
            files.setdefault(path, []).append(line)
    return {path: "\n".join(lines).strip("\n") for path, lines in files.items()}


def _table(text: str) -> str:
    """Fill in the sections that a table lacks; rows alone become its messages."""
    if text.startswith("- "):
        text = "messages:\n" + "\n".join(f"  {line}" for line in text.splitlines())
    given = set(re.findall(r"^(\w+):", text, flags=re.MULTILINE))
    rest = [section for name, section in _BASE.items() if name not in given]
    if found := re.match(r"peers:\s*\{?\s*(\w+):", text):
        rest = [section.replace("board_to_ros", f"{found[1]}_to_ros") for section in rest]
    return "\n".join([*rest, text]).strip("\n")
