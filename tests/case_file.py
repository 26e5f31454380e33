r"""Test cases in one file each: the sentence that they prove, the files that go in, and everything that comes out.

The format is Go's txtar: a comment, then files, each below a line with its path.

    Two rows cannot have the same number.

    use: shared/imu.proto as proto/imu.proto

    -- mapping.yaml --
    version: 1
    -- exit --
    1
    -- stderr --
    mapping.yaml:9:14: error[ENV101] ...

- A line `use: FILE as PATH` of the comment adds a file that several cases share. FILE is relative to tests/.
- The sections `exit`, `stdout`, `stderr` and `expected/...` are the expectations. All other sections are inputs.
- Below `-- path (escaped) --` stands a file that plain text cannot hold: `\xNN` is a byte, `\\` is a backslash, and
  a backslash at the end of a line joins it with the next one, or with the end of the file.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

_TESTS = Path(__file__).parent
_MARKER = re.compile(r"^-- (.+?)( \(escaped\))? --\n", re.MULTILINE)
_USE = re.compile(r"^use: (\S+) as (\S+)$", re.MULTILINE)
_EXPECTATION = re.compile(r"exit|stdout|stderr|expected/.*")
_ESCAPE = re.compile(rb"\\(?:x([0-9a-f]{2})|(\\)|\n)")
# Carriage returns, surrogates (bytes that are no UTF-8), other control characters; and what would read as a marker.
_UNFIT = re.compile(r"[^\n\t -\U0010ffff]|[\x7f\ud800-\udfff]|^-(?=- .+ --$)", re.MULTILINE)


@dataclass(frozen=True)
class CaseFile:
    """A case in a file."""

    path: Path

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.path.stem

    @cached_property
    def inputs(self) -> dict[str, bytes]:
        """Files that the case starts with, by path; the shared ones first."""
        shared = {path: (_TESTS / file).read_bytes() for file, path in _USE.findall(self._comment)}
        return shared | self._own_inputs

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
        sections = self._own_inputs | {name: expectations[name].encode() for name in order}
        self.path.write_bytes(render(self._comment, sections).encode())

    @property
    def _comment(self) -> str:
        return self._parsed[0]

    @property
    def _sections(self) -> dict[str, bytes]:
        return self._parsed[1]

    @property
    def _own_inputs(self) -> dict[str, bytes]:
        return {name: content for name, content in self._sections.items() if name not in self.expectations}

    @cached_property
    def _parsed(self) -> tuple[str, dict[str, bytes]]:
        return parse(self.path.read_bytes().decode())


def case_files(folder: Path) -> list[CaseFile]:
    """Read the cases of a folder, sorted by name."""
    return [CaseFile(path) for path in sorted(folder.glob("*.txtar"))]


def outcome(code: int, **streams: str) -> dict[str, str]:
    """Return the exit code of a run and what it printed as sections; an empty stream has none."""
    return {"exit": f"{code}\n"} | {name: text for name, text in streams.items() if text}


def parse(text: str) -> tuple[str, dict[str, bytes]]:
    """Split a case into its comment and its sections."""
    comment, *rest = _MARKER.split(text)
    sections: dict[str, bytes] = {}
    for name, escaped, body in zip(rest[::3], rest[1::3], rest[2::3], strict=True):
        if name in sections:
            raise ValueError(f"the section {name} stands twice")
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


def _escaped(text: str) -> str:
    text = _UNFIT.sub(_spelled, text.replace("\\", "\\\\"))
    return text if text.endswith("\n") else text + "\\\n"


def _spelled(match: re.Match[str]) -> str:
    return "".join(f"\\x{byte:02x}" for byte in match[0].encode("utf-8", "surrogateescape"))


def _unescaped(match: re.Match[bytes]) -> bytes:
    return bytes.fromhex(match[1].decode()) if match[1] else match[2] or b""
