"""Golden cases of the lint, the files below `cases/`: small projects, and what `roverlink lint` says about each.

A file holds the cases of a family of rules by name. `<ID>_bad_...` has a finding of the rule, `<ID>_good_...` has none.
Keys of a case:

- `why` is the sentence that the case proves.
- `now` has the files of the project, `before` those of an earlier state, for `--against before`.
- `finds` has the findings that are printed, as `golden.in_brief` shortens them; without it, no problems are found.
- `prints` has everything that is printed, in the few cases that show the layout.

The files of a state are texts by path, as `folded` describes them; a path without a dot is that of a .proto file in the
proto root. A text alone is `robot.proto`, in a tree without a table. A state with a table has more keys and defaults:

- `table` is mapping.yaml. Sections that it lacks are filled in. It may be the name of one of the file's `tables`;
  `change` has texts that stand in it once, each with what stands there instead.
- `ledger` is mapping.lock: the name of one of the file's `ledgers`, or of a file in `shared/ledgers/`.
- A message of a row that no file of the state declares is in a file of its own, with one field.
- `envelope`, if it is not given, has the rows of the table as its members.

To write the expectations of new cases, or all of them after a change of messages, give each case `finds: |` and a line,
run `pytest tests/lint/test_lint_cases.py --update-cases`, and review.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from folded import unfold
from golden import in_brief

_CASES = Path(__file__).parent / "cases"
_LEDGERS = Path(__file__).parents[1] / "shared" / "ledgers"
_BASE = {
    "version": "version: 1",
    "proto": "proto: {root: proto}",
    "envelope": "envelope: {file: envelope.proto, message: Envelope, oneof: payload}",
    "ros": "ros: {package: rover}",
    "peers": "peers: {board: {}}",
}
_ROWS = "messages:\n  - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}"
_FIELDS = {"Drive": "float speed = 1;", "Note": "string text = 1;"}

State = dict[str, Any]


@dataclass(frozen=True)
class LintCase:
    """A case of a file, whose `tables` and `ledgers` it may name."""

    name: str
    file: Path
    family: dict[str, Any]
    entry: dict[str, Any]

    @property
    def arguments(self) -> list[str]:
        """Arguments of `roverlink lint`."""
        root = [] if _has_table(self.entry["now"]) else ["proto"]
        return [*root, "--against", "before"] if "before" in self.entry else root

    def write(self, folder: Path) -> Path:
        """Write the files of both states; return the folder."""
        for name, root in (("now", folder), ("before", folder / "before")):
            state = self.entry.get(name, {})
            protos = root / "proto" if _has_table(state) or name == "now" else root
            for path, text in self._files(state).items():
                file = root / path if "." in path else protos / f"{path}.proto"
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text, encoding="utf-8")
        return folder

    def expected(self, printed: str) -> tuple[str, str]:
        """Return the part of what was printed that the case shows, and what is expected there."""
        if "prints" in self.entry:
            return printed, self.entry["prints"]
        if "finds" in self.entry:
            return in_brief(printed), self.entry["finds"]
        return printed, "No problems found.\n"

    def update(self, printed: str) -> None:
        """Replace in the file what the case expects; a case that finds nothing stays as it is."""
        text = self.file.read_text(encoding="utf-8")
        shown, _ = self.expected(printed)
        block = "".join(f"      {line}".rstrip() + "\n" for line in shown.splitlines())
        pattern = rf"(?m)(?<=^  {self.name}:\n)((?:(?:    .*)?\n)*?    (?:finds|prints): \|\n)(?:(?:      .*)?\n)*"
        self.file.write_text(re.sub(pattern, lambda match: match[1] + block, text), encoding="utf-8")

    def _files(self, state: State | str) -> dict[str, str]:
        if isinstance(state, str):
            return {"robot": unfold(state)}
        given = {path: text for path, text in state.items() if path not in ("table", "change", "ledger")}
        files = {path: text if "." in path else text and unfold(text) for path, text in given.items()}
        if _has_table(state):
            table = self._table(state)
            files = {**_protos(yaml.load(table, yaml.CSafeLoader), files), "mapping.yaml": table}
        if ledger := state.get("ledger"):
            ledgers = self.family.get("ledgers", {})
            files["mapping.lock"] = ledgers.get(ledger) or (_LEDGERS / f"{ledger}.lock").read_text(encoding="utf-8")
        return {path: text for path, text in files.items() if text is not None}

    def _table(self, state: State) -> str:
        text = self.family.get("tables", {}).get(state["table"], state["table"])
        for old, new in state.get("change", {}).items():
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        given = set(re.findall(r"^(\w+):", text, re.MULTILINE))
        rows = [] if "messages" in given else [_ROWS]
        lacking = [section for name, section in _BASE.items() if name not in given]
        return "\n".join([*lacking, *filter(None, [text.rstrip("\n")]), *rows]) + "\n"


def _has_table(state: State | str) -> bool:
    return isinstance(state, dict) and "table" in state


def _protos(table: dict[str, Any], given: dict[str, str]) -> dict[str, str]:
    """Add the messages of the rows and the envelope to the .proto files of a state."""
    protos = dict(given)
    declaring: dict[str, str] = {}
    for row in table["messages"]:
        last = row["proto"].rpartition(".")[2]
        files = [path for path, text in protos.items() if text and re.search(rf"^message {last} ", text, re.MULTILINE)]
        declaring[row["proto"]] = files[0] if files else last.lower()
        if not files:
            protos[last.lower()] = unfold(f"message {last} {{ {_FIELDS.get(last, 'float x = 1;')} }}")
    imports = "".join(f'import "{file}.proto"; ' for file in sorted(set(declaring.values())))
    members = " ".join(f"{row['proto']} {row['name']} = {row['number']};" for row in table["messages"])
    return {"envelope": unfold(f"{imports}message Envelope {{ oneof payload {{ {members} }} }}"), **protos}


def lint_cases() -> list[LintCase]:
    """Read all cases, sorted by family."""
    files = {file: yaml.load(file.read_bytes(), yaml.CSafeLoader) for file in sorted(_CASES.glob("*.yaml"))}
    return [
        LintCase(name, file, family, entry) for file, family in files.items() for name, entry in family["cases"].items()
    ]
