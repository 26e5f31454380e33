r"""Test cases as text: the sentence that they prove, the files that go in, and what comes out.

The format is Go's txtar: a comment, then files, each below a line with its path.

    Two rows cannot have the same number.

    use: shared/imu.proto as proto/imu.proto

    -- mapping.yaml --
    version: 1
    -- stderr --
    mapping.yaml:9:14: error[ENV101] ...

- A line `use: FILE as PATH` of the comment adds a file that several cases share. FILE is relative to tests/.
- The sections `stderr`, `found` and `lines/...` are the expectations. All other sections are inputs.
- Below `-- path (escaped) --` stands a file that plain text cannot hold: `\xNN` is a byte, `\\` is a backslash, and
  a backslash at the end of a line joins it with the next one, or with the end of the file.
- Below `-- path (proto3) --` stands a .proto file without its first line, `syntax = "proto3";`.
- Below `-- table --` stand the sections of mapping.yaml that differ from `USUAL_TABLE`. They follow those that do not.

A file `*.txtar` is one case. A file `*.cases` has many short ones; a line begins each, with its name and its sentence:

    use: shared/a_b_c.proto as proto/a.proto

    == number_taken: Two rows cannot have the same number.
    -- table --
    messages:
      - {number: 1, name: a, proto: A, topic: a, direction: board_to_ros}
      - {number: 1, name: b, proto: B, topic: b, direction: board_to_ros}
    -- found --
    mapping.yaml:8:14: error[ENV101] ...

What stands before the first of these lines belongs to all of them. A file of a case replaces a shared one; but a
section `table` changes or continues the table so far.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

USUAL_TABLE = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: rover}
peers: {board: {}}
messages:
  - {number: 1, name: a, proto: A, topic: a, direction: board_to_ros}
"""
"""The mapping.yaml that a section `table` changes."""
_TESTS = Path(__file__).parent
_HEADING = re.compile(r"^== (\w+): (.+\n)", re.MULTILINE)
_MARKER = re.compile(r"^-- (.+?)( \(escaped\))? --\n", re.MULTILINE)
_USE = re.compile(r"^use: (\S+) as (\S+)$", re.MULTILINE)
_EXPECTATION = re.compile(r"stderr|found|lines/.*")
_PROTO3 = " (proto3)"
_PROTO3_LINE = b'syntax = "proto3";\n'
_ESCAPE = re.compile(rb"\\(?:x([0-9a-f]{2})|(\\)|\n)")
# Carriage returns, surrogates (bytes that are no UTF-8), other control characters; what would read as a marker or a
# heading.
_UNFIT = re.compile(r"[^\n\t -\U0010ffff]|[\x7f\ud800-\udfff]|^-(?=- .+ --$)|^=(?== \w+: )", re.MULTILINE)


@dataclass(frozen=True)
class CaseFile:
    """A case: a file, or a part of a file with many cases."""

    path: Path
    part: str = ""
    """Name of the case in its file; empty if the file is one case."""

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.part or self.path.stem

    @property
    def text(self) -> str:
        """Text of the case, from its sentence on."""
        return _texts(self.path)[self.part]

    @cached_property
    def inputs(self) -> dict[str, bytes]:
        """Files that the case starts with, by path; the shared ones first."""
        files: dict[str, bytes] = {}
        table = USUAL_TABLE
        shared = parse(_texts(self.path)[""]) if self.part else ("", {})
        for comment, sections in (shared, self._parsed):
            files |= {path: (_TESTS / file).read_bytes() for file, path in _USE.findall(comment)}
            own = {name: content for name, content in sections.items() if not _EXPECTATION.fullmatch(name)}
            files |= {name.removesuffix(_PROTO3): _PROTO3_LINE * name.endswith(_PROTO3) + own[name] for name in own}
            if "table" in files:
                table = changed_table(table, files.pop("table").decode())
                files["mapping.yaml"] = table.encode()
        return files

    @cached_property
    def expectations(self) -> dict[str, str]:
        """Sections that a run has to reproduce, by name."""
        return {name: content.decode() for name, content in self._sections.items() if _EXPECTATION.fullmatch(name)}

    def write_inputs(self, folder: Path) -> Path:
        """Write the files that the case starts with; return the folder."""
        for path, content in self.inputs.items():
            target = folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        return folder

    def update(self, expectations: Mapping[str, str]) -> None:
        """Replace the expectations in the file; short ones come first."""
        order = sorted(expectations, key=lambda name: ("/" in name, name))
        kept = {name: content for name, content in self._sections.items() if name not in self.expectations}
        texts = _texts(self.path)
        texts[self.part] = render(self._comment, kept | {name: expectations[name].encode() for name in order})
        headings = {name: f"== {name}: " if name else "" for name in texts}
        self.path.write_bytes("".join(headings[name] + text for name, text in texts.items()).encode())
        _texts.cache_clear()

    @property
    def _comment(self) -> str:
        return self._parsed[0]

    @property
    def _sections(self) -> dict[str, bytes]:
        return self._parsed[1]

    @cached_property
    def _parsed(self) -> tuple[str, dict[str, bytes]]:
        return parse(self.text)


@cache
def _texts(path: Path) -> dict[str, str]:
    """Return the text of each case in a file, by name; that before the first one has the name ""."""
    first, *rest = _HEADING.split(path.read_bytes().decode())
    return {"": first} | {name: sentence + text for name, sentence, text in zip(rest[::3], rest[1::3], rest[2::3])}


def case_files(folder: Path) -> list[CaseFile]:
    """Read the cases of a folder, sorted by the names of the files."""
    found = [CaseFile(path) for path in folder.glob("*.txtar")]
    found += [CaseFile(path, name) for path in folder.glob("*.cases") for name in _texts(path) if name]
    return sorted(found, key=lambda case: case.path.name)


def parse(text: str) -> tuple[str, dict[str, bytes]]:
    """Split a case into its comment and its sections."""
    comment, *rest = _MARKER.split(text)
    sections: dict[str, bytes] = {}
    for name, escaped, body in zip(rest[::3], rest[1::3], rest[2::3], strict=True):
        assert name not in sections, f"the section {name} stands twice"
        sections[name] = _ESCAPE.sub(_unescaped, body.encode()) if escaped else body.encode()
    return comment, sections


def render(comment: str, sections: Mapping[str, bytes]) -> str:
    """Join a comment and sections to a case; `parse` reads the same again."""
    parts = [comment]
    for name, content in sections.items():
        text = content.decode("utf-8", "surrogateescape")
        if _UNFIT.search(text) or (text and not text.endswith("\n")):
            parts.append(f"-- {name} (escaped) --\n{_escaped(text)}")
        else:
            parts.append(f"-- {name} --\n{text}")
    return "".join(parts)


def usual_table(changes: str) -> str:
    """Return a small table with some sections of its own."""
    return changed_table(USUAL_TABLE, changes)


def changed_table(table: str, changes: str) -> str:
    """Remove the sections of a table that the changes contain, and append the changes."""
    for name in re.findall(r"^(\w+):", changes, re.MULTILINE):
        table = re.sub(rf"^{name}:.*\n(?: .*\n)*", "", table, flags=re.MULTILINE)
    return table + changes


def _escaped(text: str) -> str:
    text = _UNFIT.sub(_spelled, text.replace("\\", "\\\\"))
    return text if text.endswith("\n") else text + "\\\n"


def _spelled(match: re.Match[str]) -> str:
    return "".join(f"\\x{byte:02x}" for byte in match[0].encode("utf-8", "surrogateescape"))


def _unescaped(match: re.Match[bytes]) -> bytes:
    return bytes.fromhex(match[1].decode()) if match[1] else match[2] or b""
