"""Reader for a tree of .proto files: finds the envelope, and the files that compile together with it.

It also decides if `roverlink generate` may write the envelope's file.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import source_files
from roverlink.generator.adopt.missing_imports import with_help
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, shown
from roverlink.generator.emit.render import carries_header
from roverlink.generator.init_rules import NoSuchEnvelope, NothingToTakeOver
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.files import read_protos
from roverlink.generator.protos.parser import SCALARS, File, map_types, resolve_type
from roverlink.generator.protos.parser.tokens import Kind, Lexer, Token
from roverlink.generator.protos.proto_rules import ProtoDoesNotCompile, UnimportableProtoPath
from roverlink.generator.protos.protoc import compile_protos
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

_MOST_NAMED = 3  # messages in a text that could name all of them


@dataclass(frozen=True, slots=True)
class Tree:
    """Content of a folder with .proto files: the envelope, and the files that compile together with it."""

    root: Path
    files: Mapping[str, File]
    """Content of every .proto file that can be read, by path."""
    schema: Schema
    """Schema of the files that compile together, with the envelope."""
    exclude: Mapping[str, str]
    """Files that do not compile with the envelope; each path with the reason."""
    envelope: ProtoMessage
    oneof: str
    doubt: str
    """Reason why the choice of the envelope is a guess; empty if it is certain."""

    @property
    def members(self) -> list[ProtoField]:
        """Members of the oneof that are messages, sorted by number. These are the payloads."""
        found = [field for field in self.envelope.fields if field.oneof == self.oneof and field.type == "message"]
        return sorted(found, key=lambda field: field.number)

    @property
    def scalars(self) -> list[str]:
        """Names of the oneof's members that are not messages."""
        return [field.name for field in self.envelope.fields if field.oneof == self.oneof and field.type != "message"]


def read_tree(root: Path, shown_root: str, file: str, message: str, oneof: str, foreign: str = "") -> Tree:
    """Read the .proto files below a folder, and find the envelope.

    ``file``, ``message`` and ``oneof`` name the envelope; each one that is empty is guessed. ``shown_root`` is the
    folder's name in diagnostics, and ``foreign`` the reason why this project must not write to it; empty if it may.
    Raises `DiagnosticsError` if there is no envelope, or if it does not compile.
    """
    findings: list[Diagnostic] = []
    files = read_protos(root, shown_root, findings) if root.is_dir() else {}
    if findings or not files:
        help = (
            "give the folder of your .proto files with --from; `git submodule update --init` gets those of a submodule"
        )
        none = NothingToTakeOver.at(Span(shown_root), "the folder contains no .proto file", help)
        raise DiagnosticsError(findings or [none])
    candidates = dict(_envelopes(files, file, message))
    if not candidates:
        raise DiagnosticsError([_no_envelope(files, file, message, shown_root, foreign)])
    name = _outermost(candidates, files)
    schema, exclude = _compiled_together(root, files, candidates[name], shown_root)
    envelope = schema.messages[name]
    chosen, *oneofs = _oneofs(envelope, oneof, shown_root)
    doubts = [
        *_doubt("it", [other for other in candidates if other != name]),
        *([] if oneof else _doubt("the oneof", oneofs)),
    ]
    doubt = f"guessed: {'; '.join(doubts)}" if doubts else ""
    return Tree(root, files, schema, exclude, envelope, chosen, doubt)


def _doubt(what: str, others: Sequence[str]) -> list[str]:
    """Return a text about the others that a guess could have chosen, in a list that is empty if there are none."""
    more = [f"{len(others) - _MOST_NAMED} others"] if len(others) > _MOST_NAMED else []
    return [f"{what} could be {' or '.join([*others[:_MOST_NAMED], *more])}"] if others else []


def _envelopes(files: Mapping[str, File], wanted_file: str, wanted: str) -> Iterator[tuple[str, str]]:
    """Yield full name and file of each message that may be the envelope; the message with the largest oneof first.

    A message whose oneof contains the message itself, such as an expression, comes after all others. If ``wanted_file``
    or ``wanted`` is set, only messages in this file or with this name are considered.
    """
    found = []
    payloads = _messages_inside(files, of_oneofs=True)
    for path, file in files.items():
        for message in file.messages:
            recursive = message.full_name in payloads[message.full_name]
            named = message.full_name == wanted or message.full_name.endswith(f".{wanted}")
            size = _size_of_oneof(message)
            if (not wanted_file or path == wanted_file) and (named if wanted else size):
                found.append((recursive, -size, path, message.full_name))
    yield from ((name, path) for *_, path, name in sorted(found))


def _outermost(candidates: Iterable[str], files: Mapping[str, File]) -> str:
    """Return the first of the candidates for the envelope, or the outermost one whose oneof leads to it.

    A oneof leads to the messages in it, and to all messages inside these. What arrives is the outermost message.
    """
    first, *others = candidates
    if not others:
        return first
    holders: dict[str, list[str]] = {}
    for name, inside in _messages_inside(files, of_oneofs=False).items():
        for one in inside:
            holders.setdefault(one, []).append(name)
    payloads = _messages_inside(files, of_oneofs=True)
    chosen = [first]
    while True:
        waiting, leading = [chosen[-1]], {chosen[-1]}  # messages that contain the one chosen last
        while waiting:
            new = [name for name in holders.get(waiting.pop(), ()) if name not in leading]
            leading.update(new)
            waiting += new
        free = (name for name in others if name not in chosen and name not in payloads[name])
        outer = next((name for name in free if payloads[name] & leading), None)
        if outer is None:
            return chosen[-1]
        chosen.append(outer)


def _messages_inside(files: Mapping[str, File], *, of_oneofs: bool) -> dict[str, set[str]]:
    """Return the messages and enums that are the types of each message's fields, or only of those in its oneofs."""
    messages = [message for file in files.values() for message in file.messages]
    names = frozenset(message.full_name for message in messages)
    found: dict[str, set[str]] = {}
    for message in messages:
        fields = [field for field in message.fields if field.oneof or not of_oneofs]
        types = {(map_types(field.type) or ("", field.type))[1] for field in fields}
        resolved = {resolve_type(type, message.full_name, names) for type in types}
        found.setdefault(message.full_name, set()).update(name for name in resolved if name)
    return found


def _size_of_oneof(message: ProtoMessage) -> int:
    """Return the number of messages in the message's largest oneof."""
    held = [field.oneof for field in message.fields if field.oneof and field.type not in SCALARS]
    return max(Counter(held).values(), default=0)


def _no_envelope(files: Mapping[str, File], file: str, message: str, shown_root: str, foreign: str) -> Diagnostic:
    if file and file not in files:
        return NoSuchEnvelope.at(
            Span(shown_root), f"the folder contains no file {file!r}", f"known files: {', '.join(sorted(files))}"
        )
    known = sorted({message.full_name for name in files for message in files[name].messages if message.oneofs})
    fault = f"no message {message!r} is declared" if message else "no message with a oneof is declared"
    help = f"messages with a oneof: {', '.join(known)}" if known else _beginning(files, shown_root, foreign)
    return NoSuchEnvelope.at(Span(shown(shown_root, file) if file else shown_root), fault, help)


def _beginning(files: Mapping[str, File], shown_root: str, foreign: str) -> str:
    """Return the help for a tree that has no envelope yet: the text of one, with some of its messages.

    ``foreign`` is not empty if the text must not be written into the tree's own folder.
    """
    inside = {name for names in _messages_inside(files, of_oneofs=False).values() for name in names}
    whole = [(path, message.full_name) for path, file in files.items() for message in file.outermost]
    payloads = [(path, name) for path, name in whole if name not in inside][:_MOST_NAMED]
    imports = [f'import "{path}";' for path in dict.fromkeys(path for path, _ in payloads)]
    members = [
        f"    {name} {ros_names.field_name(name.rpartition('.')[2])} = {number};"
        for number, (_, name) in enumerate(payloads, 1)
    ]
    text = ['syntax = "proto3";', *imports, "message Envelope {", "  oneof payload {", *members, "  }", "}"]
    ours, link = shown_root, ""
    if foreign:
        ours = "proto" if shown_root != "proto" else "protos"
        target = os.path.relpath(shown_root, ours)
        link = (
            f"link to the files, which another repository tracks: `mkdir {ours} && (cd {ours} && ln -s {target}/* .)`; "
        )
    return (
        f"the envelope is a message with a oneof of all payloads; to begin, {link}write into "
        f"{shown(ours, 'envelope.proto')}:\n"
        + "".join(f"    {line}\n" for line in text)
        + f"  and run `roverlink init --from {ours}`; `roverlink lint {shown_root}` needs no envelope"
    )


def _oneofs(envelope: ProtoMessage, wanted: str, shown_root: str) -> list[str]:
    """Return the names of the oneofs with messages: first ``wanted``, or if empty, the one with the most messages.

    Raises `DiagnosticsError` if the envelope has no such oneof.
    """
    counted = Counter(field.oneof for field in envelope.fields if field.oneof and field.type == "message")
    names = [name for name, _ in counted.most_common()]
    if not names or (wanted and wanted not in names):
        named = f"no oneof {wanted!r}" if wanted else "no oneof"
        message = f"the message {envelope.full_name!r} has {named} that contains messages"
        help = "name the envelope with --message, and its oneof with --oneof"
        raise DiagnosticsError([NoSuchEnvelope.at(envelope.span or Span(shown_root), message, help)])
    return sorted(names, key=lambda name: name != wanted)  # the sort keeps the order of the others


# --- files that compile together --------------------------------------------------------------------------------


def _compiled_together(
    root: Path, files: Mapping[str, File], envelope: str, shown_root: str
) -> tuple[Schema, dict[str, str]]:
    """Return the schema of all files that compile together with the envelope's file.

    Also returns the other files, each with the reason why it does not compile. Raises `DiagnosticsError` if the
    envelope's file or one of its imports does not compile.
    """
    needed = _closure(envelope, files)
    kept = [
        *needed,
        *(file for file in files if file not in needed),
    ]  # if two files declare the same name, protoc reports the later one
    exclude: dict[str, str] = {}
    while True:
        try:
            return compile_protos(root, kept, {}, shown_root).schema, dict(sorted(exclude.items()))
        except DiagnosticsError as error:
            faults = _faults(error, kept, files, exclude, shown_root)
            if not faults or any(file in needed for file in faults):
                raise DiagnosticsError(list(with_help(error.findings, root, shown_root))) from error
            exclude |= faults
            kept = [file for file in kept if file not in faults]


def _closure(file: str, files: Mapping[str, File]) -> list[str]:
    """Return a file and all files that it imports, also indirectly.

    Every file comes after the files that it imports.
    """
    found: list[str] = []

    def add(path: str) -> None:
        if path in files and path not in found and path not in waiting:
            waiting.add(path)
            for needed in files[path].imports:
                add(needed.path)
            found.append(path)

    waiting: set[str] = set()
    add(file)
    return found


def _faults(
    error: DiagnosticsError, kept: Iterable[str], files: Mapping[str, File], exclude: Mapping[str, str], shown_root: str
) -> dict[str, str]:
    """Return the files in which protoc reports errors, each with protoc's message.

    If protoc names none of the files, returns the files that import an excluded file.
    """
    by_file = {
        finding.span.file: finding
        for finding in reversed(error.findings)
        if finding.rule in (ProtoDoesNotCompile, UnimportableProtoPath)
    }
    faults = {file: by_file[shown(shown_root, file)].message for file in kept if shown(shown_root, file) in by_file}
    if faults:
        return faults
    return {
        file: f"imports {imported.path}, which is excluded"
        for file in kept
        for imported in files[file].imports
        if imported.path in exclude
    }


# --- owner of the envelope's file -------------------------------------------------------------------------------


def owner(tree: Tree, reserved: Iterable[int], reserved_names: Iterable[str], foreign: str) -> tuple[str, str]:
    """Return the owner of the envelope's file, ``mapping`` or ``proto``, and the reason.

    With ``mapping``, `roverlink generate` writes the file from the table. With ``proto``, it only checks the file. The
    owner is ``mapping`` only if nothing in the file would be lost.

    ``reserved`` and ``reserved_names`` are the numbers and names that the table will reserve. ``foreign`` is the reason
    why this project must not write to the file's folder; empty if it may.
    """
    envelope, file = tree.envelope, tree.files[tree.envelope.file]
    # `reserved 5 to max` would be half a billion numbers.
    numbers = {number for first, last in envelope.reserved for number in range(first, min(last, first + 10_000) + 1)}
    beside = [field.name for field in envelope.fields if field.oneof != tree.oneof]
    declared = [message for message in file.messages if message.full_name == envelope.full_name]
    text = source_files.read(tree.root, tree.envelope.file).decode("utf-8", errors="replace")
    lexer = Lexer(text)
    lexer.run()
    commented = not carries_header(text) and any(token.comments for token in lexer.tokens)
    options = [
        envelope.options,
        tree.schema.file_options.get(envelope.file),
        *(field.options for field in envelope.fields),
    ]
    # Each of these would be lost, because the envelope's file is written from rows, and rows have none of it.
    reasons = {
        foreign: bool(foreign),
        f"it has members outside the oneof ({', '.join(beside)})": bool(beside),
        f"its oneof has members that are not messages ({', '.join(tree.scalars)})": bool(tree.scalars),
        "its file declares more than the envelope": len([*file.messages, *file.enums]) > 1
        or not _UNWRITTEN.isdisjoint(_outermost_names(lexer.tokens)),
        "it reserves numbers that the table does not know": bool(
            numbers - set(reserved) or set(envelope.reserved_names) - set(reserved_names)
        ),
        "a comment in it claims a number": any(message.claims for message in declared),
        "it has options": any(options),
        "it can be extended": envelope.extendable,
        "it is not written in proto3": file.syntax != "proto3",
        "it has comments": commented,
    }
    why = next((reason for reason, holds in reasons.items() if holds), "")
    if why:
        return "proto", f"generate only checks the file, because {why}"
    return "mapping", "generate writes the file from the rows, because it contains only the oneof"


_UNWRITTEN = frozenset({"service", "extend", "public", "weak"})
"""Keywords outside of messages that the generated envelope never has (``public`` and ``weak`` are kinds of imports)."""


def _outermost_names(tokens: Iterable[Token]) -> Iterator[str]:
    """Yield the keywords and names outside of all braces."""
    depth = 0
    for token in tokens:
        depth += token.is_symbol("{") - token.is_symbol("}")
        if depth == 0 and token.kind is Kind.NAME:
            yield token.text
