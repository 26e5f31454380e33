"""Show all facts about a row, or the documentation of a rule or of a key of the table.

Show all facts about a row of mapping.yaml: its sizes, the conversion of each field, its topic, its
peers, and the bytes of an example. ROW is the row's name, number, topic or message. Use it to see how a
protobuf message becomes a ROS 2 message, or to compare the bytes with those of a board.

With the ID of a rule of `roverlink lint` or `roverlink check-launch`, such as ENV101, show the rule's
documentation: what the rule finds, why that is a problem, and how to solve it.

With a key of mapping.yaml, such as max_rate or qos.depth, show what the key means, which values it takes,
and its default.

Example: roverlink explain imu_info
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from functools import cache
from typing import Any

from roverlink.completion import complete, rows, topics
from roverlink.console import FINDINGS, OK, Subparsers, add_table, documented_command, table_file
from roverlink.diagnostic_text import show_error
from roverlink.generator.diagnostics import DiagnosticsError, Rule, Severity
from roverlink.generator.lint.rules import lint_rules
from roverlink.generator.lock import ACCEPTED_NAME
from roverlink.generator.rule_catalogue import rules as own_rules
from roverlink.generator.table import Table, key_text
from roverlink.generator.table.parts import object_of
from roverlink.generator.table.value_types import Key
from roverlink.installed_packages import entry_points
from roverlink.numerals import counted
from roverlink.runtime.core.errors import SetupError, nearest

RULES = "roverlink.rules"
"""Group of entry points; each is a function that returns the rules of a package by their ids."""


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    what = parser.add_argument(
        "what", nargs="?", metavar="ROW|ID|KEY", help="a row, the ID of a rule, or a key (default: list all rules)"
    )
    complete(what, rows, topics, lambda _: all_rules())
    parser.add_argument("--json", action="store_true", help="with a row: print the facts as a JSON object")
    parser.add_argument(
        "--history", action="store_true", help="with a row: show also which payloads its number had in git's history"
    )
    add_table(parser)
    parser.set_defaults(run=run)


def all_rules() -> dict[str, type[Rule]]:
    """Return the rules of the lint, and those of installed packages such as check-launch, by their ids."""
    return dict(own_rules()) | {id: rule for entry in entry_points(RULES) for id, rule in entry.load()().items()}


def run(arguments: argparse.Namespace) -> int:
    """Print the facts about a row, or the documentation of a rule or a key, or without an argument a list of rules."""
    rules = all_rules()
    if arguments.what is None:
        for rule in rules.values():
            print(f"{rule.id} {rule.severity.value:<8} {rule.name}")
        return OK
    by_name = {rule.name: rule for rule in rules.values()}
    found = rules.get(arguments.what.upper()) or by_name.get(arguments.what)
    if found is not None:
        _print_rule(found)
        return OK
    return _explain_row(arguments, [*rules, *by_name])


def _print_rule(rule: type[Rule]) -> None:
    print(f"{rule.id} {rule.name} ({rule.severity.value})\n\n{rule.explanation}")
    if rule.id in lint_rules() and rule.severity in (Severity.ERROR, Severity.WARNING):
        print(
            f"\nTo make it a hint in a project, write `{rule.id}: {{severity: hint, reason: ...}}` under `lint` in "
            "mapping.yaml.\nIn a folder without a table, run `roverlink lint PROTO_ROOT --accept "
            f"{rule.id} --reason ...`, or `--accept {rule.id}:TYPE`\n"
            f"for one message, enum or file, and commit the file {ACCEPTED_NAME}."
        )


def _print_keys(word: str) -> bool:
    """Print the documentation of each key whose path is ``word`` or ends with it; return false if there is none."""
    paths = [path for path in _keys() if f".{path.replace('[]', '')}".endswith(f".{word.replace('[]', '')}")]
    for path in paths:
        key = _keys()[path]
        print(f"{path}: {key_text.holds(key.type)} (default: {key_text.default_of(key)})\n  {key.meaning.text}")
        if key.meaning.see:
            print(f"  see docs/{key.meaning.see}")
    return bool(paths)


@cache
def _keys() -> dict[str, Key]:
    """Return the keys of the table by their paths."""
    return dict(key_text.keys_below(object_of(Table)))


def _explain_row(arguments: argparse.Namespace, rules: list[str]) -> int:
    # Imported here: documentation of a rule does not need the slow import of the compiler.
    from roverlink.row_explanation import Project

    table, what = table_file(arguments.table), arguments.what
    project = fault = None
    try:
        project = Project(table, history=arguments.history) if table.exists() else None
    except DiagnosticsError as error:
        fault = error
    row = project.find(what) if project else None
    if project and row:
        said = project.explain(row)
        print(json.dumps(said, indent=2)) if arguments.json else _print_row(said)
        return OK
    if project and (taken := project.taken(what)):
        print(f"{what} {taken}")
        return FINDINGS
    if _print_keys(what):
        return OK
    if fault:
        show_error(fault, table.parent)
        return FINDINGS
    if project is None:
        hint = nearest(what, rules)
        raise SetupError(f"unknown rule {what!r} ({hint}), and no rows to look up: {table} does not exist")
    hint = nearest(what, [*project.known(), *rules, *(path.rpartition(".")[2] for path in _keys())])
    raise SetupError(
        f"{what!r} is neither a row or key of {table} nor a rule ({hint}); `roverlink explain` lists installed rules"
    )


def _print_row(said: dict[str, Any]) -> None:
    """Print the facts about a row as text; ``said`` is the result of `Project.explain`."""
    peer, ros = said["peer"], said["ros"]
    _line("row", f"{said['name']}, number {said['number']} in {said['envelope']['message']}")
    _line("proto", f"{said['proto']['message']} ({said['proto']['file']})")
    _line("ros", ros["message"])
    if ros["type_hash"]:
        _line("", ros["type_hash"])
    _line("topic", f"{said['topic']} ({', '.join(_qos(said['qos']))})")
    _line("direction", f"{said['direction']}; {_peer(peer)}")
    for target in said["forward"]:
        _line("forwarded", "; ".join(filter(None, (f"raw to {_peer(target)}", target["limits"]))))
    if said["send"]:
        _line("sent", said["send"])
    if said["max_rate"]:
        _line("limited", f"to {counted(said['max_rate'], 'message')} a second")
    if said["expect_rate"]:
        _line("expected", f"at least {counted(said['expect_rate'], 'message')} a second")
    if deadman := said["deadman"]:
        values = ", ".join(f"{path}: {value}" for path, value in deadman["send"].items()) or "all fields 0"
        _line("deadman", f"after {deadman['after_ms']} ms of silence, every {deadman['repeat_ms']} ms: {values}")
    if said["priority"]:
        _line("priority", str(said["priority"]))
    for text in _request(said["request"]):
        _line("request", text)
    _line("size", _size(said["size"], peer))
    for translation in said["translation"]:
        _line("translated", _translation(translation))
    _line("published", "; ".join(said["published"]) or "never, according to mapping.lock")
    for usage in said["history"] or []:
        _line("history", usage)
    print("\nfields")
    _table([_field(field) for field in said["fields"]] or [("none", "", "")])
    for path in said["ignored"]:
        print(f"  {path} has no ROS field")
    for standard in said["standard"]:
        print(f"\n{standard['message']} on {standard['topic']}")
        _table([(field["ros"], field["takes"].replace("`", "")) for field in standard["fields"]])
    print("\nfiles")
    for path in said["files"]:
        print(f"  {path}")
    example = said["example"]
    sent = counted(len(example["bytes"] or "") // 2, "byte")
    print(f"\nexample: {example['missing'] or f'{sent}, as `roverlink simulate` sends it'}")
    _table([(f"{'  ' * line['depth']}{line['bytes']}", line["meaning"]) for line in example["lines"]])


def _request(request: dict[str, Any] | None) -> Iterator[str]:
    if request is None:
        return
    by = f"with the same {request['field']}" if request["field"] else "one at a time"
    yield f"answered by {request['response']}, {by}"
    times = counted(request["attempts"], "time")
    yield f"sent up to {times}, again for the first time after {request['timeout_ms']} ms"
    if service := request["service"]:
        yield f"service {service['name']} ({service['type']})"


def _translation(translation: dict[str, Any]) -> str:
    reason = translation["in_python"]
    by = f"by Python, because {reason}" if reason else "by the native core"
    return f"{by} ({translation['topic']})"


def _line(head: str, text: str) -> None:
    print(f"{head:<10} {text}")


def _qos(qos: dict[str, Any]) -> list[str]:
    history = f"keep_last {qos['depth']}" if qos["history"] == "keep_last" else qos["history"]
    return [qos["reliability"], qos["durability"], history]


def _peer(peer: dict[str, Any]) -> str:
    budget = f"; budget: {peer['budget'] / 1000:g} kB/s" if peer["budget"] else ""
    if line := peer["line"]:
        return f"{peer['name']} ({line['host']}{budget})"
    return f"{peer['name']} (UDP port: parameter {peer['parameter']}, default {peer['port']}{budget})"


def _size(size: dict[str, Any], peer: dict[str, Any]) -> str:
    if size["payload"] is None:
        return f"unbounded: {size['unbounded']}"
    limit = f"; {peer['name']} accepts at most {peer['max_size']} bytes" if peer["max_size"] else ""
    if line := peer["line"]:
        carried, accepted = line["largest_datagram"], size["accepted"] or math.inf
        bridge = f"the bridge accepts at most {accepted} (parameter max_datagram)"
        limit += f"; {bridge if accepted < carried else f'its line carries at most {carried}'}"
    payload = counted(size["payload"], "byte")
    return f"at most {payload}, {size['envelope']} in the envelope, computed as nanopb does{limit}"


def _field(field: dict[str, Any]) -> tuple[str, str, str]:
    number = f" = {field['number']}" if field["number"] else ""
    return (
        f"{field['proto_type']} {field['proto']}{number}",
        f"{field['ros_type']} {field['ros']}",
        "" if field["conversion"] == "the same value" else field["conversion"],
    )


def _table(rows: list[tuple[str, ...]]) -> None:
    """Print rows of texts in aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    for row in rows:
        print("  " + "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths)).rstrip())
