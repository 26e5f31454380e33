"""Which comment belongs to which declaration, as protoc decides it; and what of a comment is text."""

from __future__ import annotations

import re

from generator.declarations.tokens import Comment, Token

_LINE_START = re.compile(r"\n[ \t\r\v\f]*\*?")


def clean(comment: str) -> str:
    """A comment's text without the space after its slashes and without empty lines at its ends."""
    lines = [line.removeprefix(" ").rstrip() for line in comment.splitlines()]
    return "\n".join(lines).strip("\n")


def text_of(comment: Comment, text: str) -> str:
    """What a comment says; in a block, without the stars that its lines begin with."""
    said = text[comment.start : comment.end]
    return _LINE_START.sub("\n", said) if comment.block else said + "\n"


class Gap:
    """Whose the comments are that stand between the end of a declaration and the next token.

    A comment that starts on the line of the ended declaration *trails* it; so does the first one below it, if an empty
    line or another comment parts it from what follows. The last one *leads* what follows, if no empty line is between.
    Line comments below each other are one.
    """

    def __init__(self, text: str, previous: Token | None, next: Token) -> None:
        self.trailing = self.leading = ""
        self._pending: list[Comment] = []
        self._text = text
        self._settled = 0
        self._may_trail = previous is not None
        last_line = previous.line if previous else 0
        same_line_end = 0
        for comment in next.comments:
            self._part(comment, last_line)
            self._pending.append(comment)
            if previous and comment is next.comments[0] and comment.line == previous.line:
                same_line_end = comment.end_line
                self._settle()
            last_line = comment.end_line
        if next.line - last_line > 1:
            self._settle(apart=True)
        if not next.text or any(map(next.is_symbol, "}])")):
            self._settle()
        if next.text and next.line in (previous.line if previous else 0, same_line_end):
            self._leave_a_single_one_alone()
        self.leading = self._pending_text()

    def _part(self, comment: Comment, last_line: int) -> None:
        if comment.line - last_line > 1:
            self._settle(apart=True)
        elif self._pending and (comment.block or self._pending[-1].block):
            self._settle()

    def _pending_text(self) -> str:
        return "".join(text_of(comment, self._text) for comment in self._pending)

    def _settle(self, apart: bool = False) -> None:
        """What is pending does not lead what follows."""
        if self._pending:
            self._settled += 1
            if self._may_trail:
                self.trailing = self._pending_text()
                self._may_trail = False
            self._pending = []
        if apart:
            self._may_trail = False

    def _leave_a_single_one_alone(self) -> None:
        """On one line with both declarations, it could be either's, so it is nobody's."""
        if self._settled + bool(self._pending) == 1:
            self.trailing = ""
            self._pending = []
