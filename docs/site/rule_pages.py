"""Reference of the rules: a page for each prefix, read from the rules' own documentation."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from roverlink.commands.explain import all_rules
from roverlink.generator.diagnostics import Rule

INDEX = "reference/rules/index.md"
_RULES = dict(sorted(all_rules().items()))
IDS = frozenset(_RULES)
_SUBJECTS = {
    "ADO": "taking over a tree of protos",
    "BUF": "buf",
    "CNV": "conversions",
    "CPP": "C++ handlers",
    "ENV": "numbers of the envelope",
    "FIX": "fixed sizes",
    "FRM": "frames of launch files",
    "HIS": "history",
    "LCH": "launch files",
    "LED": "the ledger",
    "LNK": "the link message",
    "MAP": "reading mapping.yaml",
    "NAM": "names in the protos",
    "NPB": "nanopb",
    "OUT": "writing files",
    "PAR": "parameters of nodes",
    "PIN": "pinned commits",
    "PLG": "plugins of nodes",
    "PRO": "reading the protos",
    "RAD": "budgets of slow links",
    "REQ": "requests",
    "RET": "editing the table",
    "ROS": "names in ROS 2",
    "SAF": "deadmen, rates, sources and signatures",
    "STA": "states to compare with",
    "STD": "standard messages",
    "TAB": "rows and peers",
    "TOP": "topics of launch files",
    "WIR": "changes on the wire",
}


def path(id: str) -> str:
    """Return the path of the page that documents a rule."""
    return f"reference/rules/{id[:3]}.md"


def paths() -> list[str]:
    """Return the paths of all pages, in the order of the ids."""
    return list(dict.fromkeys(path(id) for id in _RULES))


def pages() -> dict[str, str]:
    """Return the pages of all rules, and the list of them, by path."""
    groups = [(prefix, list(group)) for prefix, group in groupby(_RULES.values(), lambda rule: rule.id[:3])]
    texts = {f"reference/rules/{prefix}.md": "\n".join(_page(prefix, group)) for prefix, group in groups}
    rows = [_row(rule) for rule in _RULES.values()]
    head = ["# Rules", "", _INTRODUCTION, "", "| rule | severity | finds |", "|---|---|---|"]
    return {INDEX: "\n".join([*head, *rows, ""]), **texts}


_INTRODUCTION = "Every diagnostic that a command prints has the id of one of these rules."


def _row(rule: type[Rule]) -> str:
    link = f"[{rule.id}]({rule.id[:3]}.md#{rule.id.lower()})"
    return f"| {link} {rule.name} | {rule.severity.value} | {rule.summary} |"


def _page(prefix: str, group: list[type[Rule]]) -> Iterator[str]:
    yield from (f"# {prefix}: {_SUBJECTS[prefix]}", "")
    for rule in group:
        yield from (f"## {rule.id} {rule.name} {{: #{rule.id.lower()} }}", "", f"Severity: {rule.severity.value}", "")
        yield from _body(rule)


def _body(rule: type[Rule]) -> Iterator[str]:
    """Return a rule's documentation as Markdown: its examples, which are indented, become fenced blocks."""
    text, _, examples = rule.documentation.strip().partition("\nBad::\n")
    bad, _, good = examples.partition("\nGood::\n")
    yield from (text.strip(), "")
    for title, example in (("Bad:", bad), ("Good:", good)):
        yield from (title, "", f"```{_language(example)}", *_dedented(example), "```", "")


def _dedented(example: str) -> list[str]:
    return [line[4:] for line in example.strip("\n").splitlines()]


def _language(example: str) -> str:
    first = example.strip()
    if first.startswith("$"):
        return "console"
    if first.startswith(("import ", "from ")) and '"' not in first:
        return "python"
    if first.startswith(("syntax", "message", "//", "enum", "import")):
        return "proto"
    return "text" if "[" in first.partition(":")[2][:40] and "error[" in first else "yaml"
