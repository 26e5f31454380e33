"""The parser of .proto files: reads one statement after another, and keeps the open blocks on a stack."""

from __future__ import annotations

from dataclasses import replace

from roverlink.generator.protos.parser.blocks import Block, SkippedBlock
from roverlink.generator.protos.parser.message_blocks import Declarations, Scope
from roverlink.generator.protos.parser.parsed_file import File, Import
from roverlink.generator.protos.parser.phrases import Words
from roverlink.generator.protos.parser.source_text import Source
from roverlink.generator.protos.parser.statements import BLOCKS, VISIBILITIES, Statement, StatementReader
from roverlink.generator.protos.parser.tokens import Kind, Token

# Braces decide where blocks end, as long as every brace has a partner; then this parser agrees with protoc. A file with
# a missing or a surplus brace has several readings, and the braces do not tell which one was meant. People do, by
# layout:
# - A closing brace that starts a line closes the block whose declaration starts at the same column. All blocks inside
#   that one were not closed.
# - A top-level keyword (`message`, `enum`, `import`...) in column 1 is outside of all blocks, if the outermost open
#   block is never closed. Otherwise one missing brace would nest the rest of the file in one message, with other full
#   names.
# - A surplus closing brace is dropped where it stands at an unusual place: in the middle of a line, or indented deeper
#   than the block.
# - A declaration without its opening brace opens a block if the next line is indented deeper.
#
# Old states in git matter as much as the file of today, so a wrong guess must stay small: it may misplace one block,
# but never lose the numbers after it.

_DEEPEST = 32  # protoc's own limit of nested messages


def parse(text: str) -> File:
    """Parse the text of a .proto file, and return all declarations that can be read.

    Any text is accepted. The time is linear in the length of the text.
    """
    return _Parser(Source(text)).run()


class FileBlock(Scope):
    """The file as a block, which contains all other blocks."""

    def __init__(self, source: Source) -> None:
        # A file is no statement; this one stands for its beginning, so that it has a place.
        super().__init__(source, Statement(0, -1, [source.tokens[0]], "", ()))
        self.indentation = 0
        self.messages, self.enums, self.extends = [], [], []
        self.syntax = self.package = ""
        self.imports: list[Import] = []

    def read(self, statement: Statement) -> Block | None:
        """Read a statement outside of all messages and enums: ``syntax``, ``import``, the beginning of a message..."""
        tokens, source = statement.tokens, self.source
        if statement.ending == "{":
            service = tokens[0].text == "service"
            return self.open(statement) or (SkippedBlock(source, statement) if service else self.unknown(statement))
        if not (self._read_head(statement) and statement.ending):
            source.unreadable(statement, "not a declaration")
        return None

    def _read_head(self, statement: Statement) -> bool:
        """Read a ``syntax``, ``edition``, ``package``, ``import`` or ``option`` statement.

        Returns False if its syntax is wrong.
        """
        words = Words(statement.tokens)
        keyword = words.skip()
        if keyword.text in ("syntax", "edition"):
            words.take("=")
            self.syntax = words.string() or self.syntax
        elif keyword.text == "package":
            self.package = words.type_name() or self.package
        elif keyword.text == "import":
            kind, path = words.take("public", "weak", "option"), words.string()
            if path is None:
                return False
            self.imports.append(Import(path, kind, keyword.line, keyword.column))
        else:
            return keyword.text == "option" and bool(words.option()[1])
        return words.done

    def build(self) -> File:
        """Return the declarations and problems that were found in the file."""
        found = Declarations()
        self.collect(self.package, found)
        return File(
            syntax=self.syntax,
            package=self.package,
            imports=tuple(self.imports),
            messages=tuple(found.messages),
            enums=tuple(found.enums),
            extensions=tuple(found.extensions),
            problems=self.source.problems,
        )


class _Parser:
    """The loop over the tokens of a file. Only this class opens and closes blocks."""

    def __init__(self, source: Source) -> None:
        self._source, self._tokens = source, source.tokens
        self._index = 0
        self._file = FileBlock(source)
        self._open: list[Block] = []
        """The open blocks. The innermost block is the last."""

    def run(self) -> File:
        """Read all tokens and return the parsed file."""
        while (token := self._tokens[self._index]).kind is not Kind.END:
            if self._open and self._open[0].unclosed and self._tokens.declares_outermost(self._index):
                self._abandon(0)
            if token.is_symbol("}"):
                self._close(token)
            else:
                self._read(StatementReader(self._tokens, self._index).read())
        if self._open:
            self._innermost.claim(token.comments)
        self._abandon(0)
        return self._file.build()

    @property
    def _innermost(self) -> Block:
        return self._open[-1] if self._open else self._file

    def _read(self, statement: Statement) -> None:
        self._innermost.claim(statement.comments)
        self._index = statement.end + (1 if statement.ending else 0)
        statement = self._with_missing_brace(self._without_stray_start(statement))
        opened = self._innermost.take(statement)
        if opened is None:
            return
        if len(self._open) >= _DEEPEST:
            self._source.problem(opened.opening, f"more than {_DEEPEST} nested blocks")
            opened = SkippedBlock(self._source, statement)
        self._open.append(opened)

    def _without_stray_start(self, statement: Statement) -> Statement:
        """Separate a broken statement from the block that begins after it: ``float x message Imu {``.

        The innermost open block reads the broken part. Returns the rest, ``message Imu {``, or the whole statement if
        nothing is broken.
        """
        tokens, size = statement.tokens, len(statement.tokens)
        if statement.ending != "{" or size < 3 or tokens[-2].text not in BLOCKS or tokens[0].text in VISIBILITIES:
            return statement
        self._innermost.take(replace(statement, end=statement.end - 2, tokens=tokens[:-2], ending=""))
        return replace(statement, start=statement.end - 2, tokens=tokens[-2:])

    def _with_missing_brace(self, statement: Statement) -> Statement:
        """Return the statement, changed to one that opens a block if its opening brace seems to be missing.

        A brace seems to be missing after ``message Imu`` at the start of a line, if the next line is indented more.
        """
        tokens, next = statement.tokens, self._tokens[statement.end]
        if statement.ending or len(tokens) < 2 or tokens[0].text not in BLOCKS or tokens[1].kind is not Kind.NAME:
            return statement
        if not tokens[0].first or next.column <= tokens[0].column or next.kind is not Kind.NAME:
            return statement
        self._source.unreadable(statement, "an opening brace is missing")
        return replace(statement, ending="{", end=statement.end - 1)

    # --- closing braces ---------------------------------------------------------------------------------------------

    def _close(self, token: Token) -> None:
        block = self._innermost
        block.claim(token.comments)
        fitting = self._fitting(token)
        if not self._open or (fitting is None and self._is_surplus(token)):
            self._source.problem(token, "a surplus closing brace")
        # Only a file in which the outermost block is never closed needs the indentation. Elsewhere braces count,
        # whatever the layout.
        elif fitting is not None and self._open[0].unclosed:
            self._abandon(fitting + 1)
            self._open.pop()
        elif block.depth:
            block.depth -= 1
        else:
            self._open.pop()
        self._index += 1

    def _fitting(self, token: Token) -> int | None:
        """Return the index of the innermost open block that is indented like a closing brace.

        Returns None if there is no such block, or if the brace is not the first token of its line.
        """
        blocks = range(len(self._open) - 1, -1, -1) if token.first else ()
        return next((index for index in blocks if self._open[index].indentation == token.column), None)

    def _is_surplus(self, token: Token) -> bool:
        """Return True if a closing brace probably closes no block, so that it must be ignored.

        This is so if there are too many closing braces from here on, and if this one stands at an unusual place: after
        other text in its line, or indented deeper than the block.
        """
        # After the last brace without a partner, every closing brace closes something.
        if self._index > self._tokens.last_unopened:
            return False
        if not token.first:
            return self._tokens[self._index - 1].text not in (";", "{", "}")
        block = self._innermost
        return not block.depth and token.column > block.indentation > 0

    def _abandon(self, size: int) -> None:
        """Close the innermost blocks until ``size`` blocks are open, and report each: its closing brace is missing."""
        while len(self._open) > size:
            self._source.problem(self._innermost.opening, "a block that is not closed")
            self._open.pop()
