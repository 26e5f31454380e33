"""The text of a .proto file, with the tokens that it was cut into and the problems found so far."""

from __future__ import annotations

from roverlink.generator.diagnostics import Span
from roverlink.generator.protos.parser.parsed_file import Problem
from roverlink.generator.protos.parser.statements import Statement, Tokens
from roverlink.generator.protos.parser.tokens import Lexer, Token

_LONGEST_QUOTE = 60


class Source:
    """The text and the tokens of a .proto file, and the list of its problems."""

    def __init__(self, text: str) -> None:
        lexer = Lexer(text)
        lexer.run()
        self.text, self.tokens = text, Tokens(lexer.tokens)
        self._problems = lexer.problems

    @property
    def problems(self) -> tuple[Problem, ...]:
        """The problems, sorted by their place in the file."""
        return tuple(sorted(set(self._problems)))

    def problem(self, token: Token, what: str) -> None:
        """Add a problem to the list; ``what`` describes the problem, and the token tells its place."""
        self._problems.append(Problem(token.line, token.column, what))

    def unreadable(self, statement: Statement, why: str) -> None:
        """Add a problem about a statement that cannot be read, or can only be read in part.

        The text of the problem is ``why``, followed by the beginning of the statement.
        """
        first = self.tokens[statement.start]
        last = statement.tokens[-1] if statement.tokens else first
        # Joined in one line, and cut: the quote becomes part of a diagnostic's line.
        quote = " ".join(self.text[first.start : min(last.end, first.start + _LONGEST_QUOTE)].split())
        self.problem(first, f"{why}: {quote}")

    def span(self, statement: Statement) -> Span:
        """Return the place of a statement's first token. Its file name is empty: the parser does not know it."""
        first = statement.tokens[0]
        return Span("", first.line, first.column)
