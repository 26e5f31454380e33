"""Statements of a .proto file: finds the end of each one, even if semicolons or braces are missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from roverlink.generator.protos.parser.tokens import Comment, Kind, Token

# A statement ends with `;` or `{`. Where one of these is missing, the next line begins another statement, and its first
# words have to tell. That is less simple than it looks, because protobuf has no reserved words: `message = 4` is an
# enum value, `optional message x = 1` is a field of a type called `message`. So a keyword counts as the beginning of a
# declaration only together with the tokens that it needs (`Tokens.declares`), and only at the beginning of a line.
#
# Everything is decided with four tokens of lookahead at most, which keeps the time linear in the length of the text.

BLOCKS = frozenset(["message", "enum", "service", "oneof"])
LABELS = frozenset(["optional", "required", "repeated"])
VISIBILITIES = frozenset(["export", "local"])
_AHEAD = 4  # the largest lookahead, in tokens
_OUTERMOST = frozenset(["message", "enum", "service", "extend", "import", "syntax", "edition", "package"])


class Tokens:
    """The tokens of a file. They know which opening and closing braces have no partner."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        # The end of the file is repeated, so that no lookahead has to test for it.
        self._tokens = [*tokens, *[tokens[-1]] * _AHEAD]
        opened: list[int] = []
        self.last_unopened = -1
        """Index of the last closing brace that has no opening brace; -1 if there is none."""
        for index, token in enumerate(tokens):
            if token.text == "{":
                opened.append(index)
            elif token.text == "}":
                if opened:
                    opened.pop()
                else:
                    self.last_unopened = index
        self.unclosed = frozenset(opened)
        """Indices of the opening braces that have no closing brace."""

    def __getitem__(self, index: int) -> Token:
        """Return the token at an index. Up to four indices after the last token are allowed."""
        return self._tokens[index]

    def between(self, start: int, end: int) -> Sequence[Token]:
        """Return the tokens from the index ``start`` up to, but not including, ``end``."""
        return self._tokens[start:end]

    def declares(self, index: int) -> bool:
        """Return True if a declaration begins at an index: a keyword with the tokens that must follow it."""
        if self[index].text in VISIBILITIES and self[index + 1].text in BLOCKS:
            index += 1
        word, second, third = self[index], self[index + 1], self[index + 2]
        if word.kind is not Kind.NAME:
            return False
        text = word.text
        if text in BLOCKS:
            return second.kind is Kind.NAME and third.is_symbol("{")
        if text in LABELS or text == "extend":
            wanted = (Kind.NAME, "{.") if text == "extend" else (Kind.NAME, ".")
            return _names(second) and (third.kind is wanted[0] or third.text in wanted[1])
        return _needs(word, second, third)

    def assigns(self, index: int) -> bool:
        """Return True if a name with a number begins at an index: ``name = 4``."""
        number = self[index + 3] if self[index + 2].is_symbol("-") else self[index + 2]
        return self[index].kind is Kind.NAME and self[index + 1].is_symbol("=") and number.kind is Kind.NUMBER

    def declares_outermost(self, index: int) -> bool:
        """Return True if a top-level declaration begins at an index, in the first column of its line."""
        word = self[index]
        known = word.text in _OUTERMOST or word.text in VISIBILITIES
        return word.column == 1 and word.first and known and self.declares(index)


def _names(token: Token) -> bool:
    return token.kind is Kind.NAME or token.is_symbol(".")


def _needs(word: Token, second: Token, third: Token) -> bool:
    """Return True if two tokens may follow the keyword ``word``: for example ``=`` and a string after ``syntax``."""
    text = word.text
    if text in ("syntax", "edition"):
        # Indented, `syntax = 1` may be an enum value or a field.
        return word.column == 1 and second.is_symbol("=") and third.kind is Kind.STRING
    if text == "package":
        return word.column == 1 and second.kind is Kind.NAME and third.text in (".", ";")
    if text == "import":
        return second.kind is Kind.STRING or third.kind is Kind.STRING
    if text in ("reserved", "extensions"):
        return second.kind in (Kind.NUMBER, Kind.STRING) or second.is_symbol("-")
    if text == "option":
        return second.is_symbol("(") or (second.kind is Kind.NAME and third.text in ("=", "."))
    return (text == "map" and second.is_symbol("<")) or (text == "rpc" and third.is_symbol("("))


@dataclass(frozen=True, slots=True)
class Statement:
    """A statement: its tokens, without the ``;`` or ``{`` at its end."""

    start: int
    end: int
    """Index of the first token after the statement. This is the ``;`` or ``{`` if the statement has one."""
    tokens: Sequence[Token]
    ending: str
    """The ``;`` or ``{`` that ends the statement; empty if it is missing."""
    comments: tuple[Comment, ...]
    """The comments before each token of the statement, and before its end."""


class StatementReader:
    """Reader of one statement: it starts at a token and finds the end of the statement."""

    def __init__(self, tokens: Tokens, start: int) -> None:
        self._tokens, self._start, self._index = tokens, start, start
        self._is_option = tokens[start].text == "option"
        self._is_block = tokens[start].text in BLOCKS
        self._braces = self._brackets = 0
        self._assigned = False

    def read(self) -> Statement:
        """Return the statement. It has at least one token, or consists only of its ending, ``;`` or ``{``."""
        ending, all_tokens = None, self._tokens
        comments: list[Comment] = []
        previous = None
        while True:
            token = all_tokens[self._index]
            if previous and (previous.cut_off or (token.first and self._is_broken_off(token, previous))):
                ending = ""
            elif token.kind is Kind.SYMBOL:
                ending = self._symbol(token.text)
            elif token.kind is Kind.END:
                ending = ""
            if ending is not None:
                break
            comments += token.comments
            previous = token
            self._index += 1
        if ending:
            comments += token.comments
        tokens = all_tokens.between(self._start, self._index)
        return Statement(self._start, self._index, tokens, ending, tuple(comments))

    def _symbol(self, text: str) -> str | None:
        """Return the ending that a symbol means: ``;``, ``{``, or an empty text if the ending is missing.

        Returns None if the statement continues after the symbol.
        """
        if text == "=":
            self._assigned = True
        elif text in "{}":
            if not self._braces:
                if text == "}":
                    return ""
                # An option's value in text format, `{ max: 3 }`, also has braces. They belong to the statement, in
                # `option x = {...};` and inside of `[...]`.
                if self._is_block or not (self._brackets or self._is_option):
                    return "{"
            self._braces += 1 if text == "{" else -1
        elif not self._braces:
            if text == ";":
                return ";"
            if text in "[]":
                # A surplus `]` must not make the next `[` invisible.
                self._brackets = max(0, self._brackets + (1 if text == "[" else -1))
        return None

    def _is_broken_off(self, token: Token, previous: Token) -> bool:
        """Return True if a token at the start of a line cannot belong to the statement before it.

        Then the ``;`` or ``{`` of that statement is missing.
        """
        if self._braces:  # an option's value may have fields called like keywords; distrust them if a brace is missing
            return bool(self._tokens.unclosed) and self._tokens.declares(self._index)
        if token.kind is Kind.NAME and token.text != "to" and self._is_complete(previous):
            return True
        if self._tokens.declares(self._index):
            return previous.text not in VISIBILITIES
        return token.kind is Kind.NAME and not self._brackets and self._begins_declaration(previous)

    def _is_complete(self, previous: Token) -> bool:
        """Return True if the statement is complete after a token.

        Then a name on the next line starts a new statement.
        """
        if previous.kind is Kind.NAME:
            head, size = self._tokens[self._start].text, self._index - self._start
            is_listed = head in ("reserved", "extensions") and size > 1 and previous.text != "to"
            return self._assigned or is_listed or (self._is_block and size == 2)
        if previous.text == "=":
            return not (self._is_option or self._brackets)
        return previous.kind in (Kind.NUMBER, Kind.STRING) or previous.text in ("]", "}")

    def _begins_declaration(self, previous: Token) -> bool:
        """Return True if a field or an enum value begins at the current token, on the line after a broken statement.

        ``previous`` is the last token of the broken statement; its end is missing.
        """
        if self._tokens.assigns(self._index):
            return previous.kind is Kind.SYMBOL and previous.text not in (".", ">", ",")
        is_labelled = previous.text in LABELS and self._index - self._start == 1
        is_part = previous.is_symbol(".") and self._tokens[self._index - 2].kind is Kind.NAME
        return self._tokens.assigns(self._index + 1) and not (is_labelled or is_part or previous.is_symbol(","))
