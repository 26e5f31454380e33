"""Reference of the commands: a page for each, read from the command line's own parser."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from roverlink.command_line import COMMANDS, command_line
from roverlink.console import SUMMARY

INDEX = "reference/commands/index.md"


def path(command: str) -> str:
    """Return the path of a command's page."""
    return f"reference/commands/{command}.md"


def paths() -> list[str]:
    """Return the paths of the pages of all commands, in the order of `roverlink --help`."""
    return [path(command) for command in COMMANDS]


def pages() -> dict[str, str]:
    """Return the pages of all commands, and the list of them, by path."""
    parser = command_line()
    commands = _subcommands(parser)
    rows = [
        f"| [`roverlink {name}`]({name}.md) | {_cell(one.get_default(SUMMARY))} |"
        for name, one in commands.choices.items()
    ]
    overview = ["# Commands", "", "| command | what it does |", "|---|---|", *rows, ""]
    texts = {path(name): "\n".join(_page(one)) for name, one in commands.choices.items()}
    return {INDEX: "\n".join(overview), **texts}


def _page(parser: argparse.ArgumentParser, level: int = 1) -> Iterator[str]:
    """Return the lines of a command's page; subcommands follow as sections."""
    yield from (f"{'#' * level} {parser.prog}", "", _prose(parser.description or ""), "")
    yield from ("```text", parser.format_usage().strip(), "```", "")
    actions = [action for action in parser._actions if action.help is not argparse.SUPPRESS]
    positional = [action for action in actions if not action.option_strings and not isinstance(action, _Subcommands)]
    optional = [action for action in actions if action.option_strings and action.dest != "help"]
    yield from _table("argument", positional, parser)
    yield from _table("option", optional, parser)
    if parser.epilog:
        examples = parser.epilog.removeprefix("example: ").splitlines()
        yield from ("Example:", "", "```console", *(f"$ {example.strip()}" for example in examples), "```", "")
    for action in actions:
        if isinstance(action, _Subcommands):
            for subparser in action.choices.values():
                yield from _page(subparser, level + 1)


def _table(heading: str, actions: list[argparse.Action], parser: argparse.ArgumentParser) -> Iterator[str]:
    if actions:
        yield from (f"| {heading} | meaning |", "|---|---|")
        yield from (f"| {_spelling(action, parser)} | {_meaning(action, parser)} |" for action in actions)
        yield ""


def _spelling(action: argparse.Action, parser: argparse.ArgumentParser) -> str:
    formatter = parser._get_formatter()
    return f"`{formatter._format_action_invocation(action)}`".replace("|", "\\|")


def _meaning(action: argparse.Action, parser: argparse.ArgumentParser) -> str:
    return _cell(parser._get_formatter()._expand_help(action) if action.help else "")


def _cell(text: str) -> str:
    return _prose(" ".join(text.split())).replace("|", "\\|")


def _prose(text: str) -> str:
    """Return a help text as Markdown that shows it as it is; what stands in back quotes stays code."""
    parts = text.split("`")
    return "`".join(part if index % 2 else _escaped(part) for index, part in enumerate(parts))


def _escaped(text: str) -> str:
    return "".join(f"\\{letter}" if letter in "\\*_[]<>#" else letter for letter in text)


def _subcommands(parser: argparse.ArgumentParser) -> argparse._SubParsersAction[argparse.ArgumentParser]:
    return next(action for action in parser._actions if isinstance(action, _Subcommands))


_Subcommands = argparse._SubParsersAction  # argparse offers no public way from a parser to its commands
