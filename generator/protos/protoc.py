"""Runs of protoc (from grpcio-tools), and the conversion of its error messages to diagnostics."""

from __future__ import annotations

import atexit
import keyword
import marshal
import os
import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import NamedTuple

from google.protobuf.descriptor_pb2 import FileDescriptorSet

from roverlink.generator import source_files
from roverlink.generator.content_digest import proto_digest
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, shown
from roverlink.generator.ir.protobuf_facts import OWN_FILES, module_path
from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.files import declarations
from roverlink.generator.protos.proto_rules import ProtoDoesNotCompile, UnimportableProtoPath
from roverlink.generator.protos.schema import Schema

# Python takes ten times as long to start as protoc to read a few files. So one process loads protoc, and forks for each
# run, which may crash. The process ends with ours, which closes its input, and with Ctrl-C.
_SERVE = """
import marshal, os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
sys.path.append(sys.argv[1])
from grpc_tools import _protoc_compiler
while sys.stdin.buffer.peek(1):
    folder, printed, arguments = marshal.load(sys.stdin.buffer)
    run = os.fork()
    if not run:
        os.chdir(folder)
        file = os.open(printed, os.O_WRONLY | os.O_CREAT)
        os.dup2(file, 1)
        os.dup2(file, 2)
        os._exit(_protoc_compiler.run_main([os.fsencode(argument) for argument in arguments]))
    print(os.waitstatus_to_exitcode(os.waitpid(run, 0)[1]), flush=True)
"""
_ONE_RUN_AT_A_TIME = threading.Lock()


@dataclass(frozen=True, slots=True)
class Compilation:
    """Result of a protoc run: the schema and the Python modules of the compiled files and their imports."""

    schema: Schema
    modules: Mapping[str, Mapping[str, str]]
    """The Python module (pb2) and the stub that protoc generated of each file: its path, then path and text of both."""
    digests: Mapping[str, str]
    """Digest of each file on disk that was compiled, by its path; without files that the table makes."""


def compile_protos(root: Path, files: Sequence[str], overlay: Mapping[str, str], shown_root: str) -> Compilation:
    """Compile .proto files and their imports with protoc, to a schema and to Python modules.

    ``overlay`` has texts, by path, that protoc reads instead of the files on disk. ``shown_root`` is the name of the
    folder ``root`` in diagnostics. Raises `DiagnosticsError` with protoc's own messages, and for files whose modules
    Python could not import.
    """
    with tempfile.TemporaryDirectory(prefix="roverlink-") as folder:
        staged, out, result = Path(folder, "staged"), Path(folder, "out"), Path(folder, "set")
        out.mkdir()
        options = [f"--python_out={out}", f"--pyi_out={out}", f"--descriptor_set_out={result}"]
        # protoc generates modules for the files in its arguments only, not for their imports.
        found = _stage(root, files, overlay, staged)
        wanted = list(dict.fromkeys([*files, *(name for name in found if not name.startswith(OWN_FILES))]))
        if findings := [*_unimportable(wanted, shown_root)]:
            raise DiagnosticsError(findings)
        _protoc(staged, wanted, options, out, shown_root)
        compiled = FileDescriptorSet.FromString(result.read_bytes())
        modules = {file: _modules(out, file) for file in sorted(wanted)}
        texts = {file: (staged / file).read_text("utf-8", "replace") for file in modules if file not in overlay}
    digests = {file: proto_digest(text) for file, text in texts.items()}
    return Compilation(schema_of(compiled, shown_root), modules, digests)


def _modules(out: Path, file: str) -> dict[str, str]:
    paths = [f"{module_path(file)}{suffix}" for suffix in (".py", ".pyi")]
    return {path: (out / path).read_text(encoding="utf-8") for path in paths}


def _unimportable(files: Sequence[str], shown_root: str) -> Iterator[Diagnostic]:
    """Report .proto files whose Python modules could not be imported, such as ``2d/imu.proto``, or have one path."""
    first: dict[str, str] = {}
    for file in files:
        span, module = Span(shown(shown_root, file)), module_path(file)
        if bad := [part for part in module.split("/") if not part.isidentifier() or keyword.iskeyword(part)]:
            message = f"protoc makes the Python module '{module}.py' of this file, but {bad[0]!r} cannot be imported"
            yield UnimportableProtoPath.at(span, message, "rename this folder or file")
        elif (other := first.setdefault(module, file)) != file:
            message = f"protoc makes the Python module '{module}.py' of this file and of {other!r}"
            yield UnimportableProtoPath.at(span, message, "rename one of the two files")


def _stage(root: Path, files: Iterable[str], overlay: Mapping[str, str], staged: Path) -> list[str]:
    """Copy the given files, and all files that they import, to the folder ``staged``, from which protoc reads them.

    protoc itself would follow an import to a pipe, or a link out of the repository. A file that does not exist or must
    not be read is left out. ``overlay`` has texts, by path, that take the place of files on disk. Returns the paths of
    the copies, the given files first.
    """
    staged.mkdir()
    waiting = list(dict.fromkeys(files))
    known = set(waiting)
    copied = []
    for name in waiting:  # the list grows during the loop
        if PurePosixPath(name).is_absolute() or {"..", "."} & set(name.split("/")):
            continue  # protoc refuses such a path
        try:
            data = overlay[name].encode() if name in overlay else source_files.read(root, name)
            (staged / name).parent.mkdir(parents=True, exist_ok=True)
            (staged / name).write_bytes(data)
        except OSError:
            continue  # protoc reports that the file does not exist
        copied.append(name)
        new = [
            imported
            for imported in declarations(data.decode("utf-8", errors="replace")).imported
            if imported not in known
        ]
        known.update(new)
        waiting += dict.fromkeys(new)
    return copied


def compile_tree(
    root: Path, files: Sequence[str], shown_root: str, overlay: Mapping[str, str] = MappingProxyType({})
) -> tuple[Schema, list[Diagnostic]]:
    """Compile all given .proto files with protoc, and leave out the files that have errors.

    ``overlay`` has texts, by path, that protoc reads instead of the files on disk. Returns the schema of the files
    without errors, and one diagnostic for each error in the other files.
    """
    findings: list[Diagnostic] = []
    left = list(files)
    # protoc writes nothing if one file has an error. So leave out the files that its errors name, and try again. Each
    # turn leaves out at least one file, or all of them if no error names a known one.
    while left:
        try:
            schema = schema_of(compile_descriptors(root, left, shown_root, overlay), shown_root)
        except DiagnosticsError as error:
            findings += [finding for finding in error.findings if finding not in findings]
            broken = {finding.span.file for finding in error.findings}
            broken |= {span.file for finding in error.findings for span, _ in finding.also}
            kept = [file for file in left if shown(shown_root, file) not in broken]
            left = kept if len(kept) < len(left) else []
        else:
            return replace(schema, uncompiled=tuple(file for file in files if file not in left)), findings
    return Schema(uncompiled=tuple(files)), findings


def compile_descriptors(
    root: Path, files: Sequence[str], shown_root: str, overlay: Mapping[str, str] = MappingProxyType({})
) -> FileDescriptorSet:
    """Compile files and their imports with protoc, to descriptors. Raises `DiagnosticsError` with protoc's messages."""
    with tempfile.TemporaryDirectory(prefix="roverlink-") as folder:
        staged, result = Path(folder, "staged"), Path(folder, "set")
        _stage(root, files, overlay, staged)
        _protoc(staged, files, [f"--descriptor_set_out={result}"], Path(folder), shown_root)
        return FileDescriptorSet.FromString(result.read_bytes())


def _protoc(staged: Path, files: Sequence[str], options: Sequence[str], inside: Path, shown_root: str) -> None:
    # grpcio-tools brings google/protobuf/*.proto. Its folder is the last one: a project's own copies come first.
    includes = [f"-I{folder}" for folder in (staged, _grpc_tools() / "_proto")]
    options = [*options, "--include_imports", "--include_source_info"]
    # protoc would take a file named `-x.proto` as an option, and `@x.proto` as a file with options.
    named = [f"{staged}/{file}" if file.startswith(("-", "@")) else file for file in files]
    # The folder is empty, because of a file that is missing below the includes, protoc says something else if it is in
    # the folder.
    code, printed = _run(inside, staged.with_name("printed"), ["protoc", *includes, *options, *named])
    if code:
        output = printed.decode("utf-8", errors="replace")
        raise DiagnosticsError(_protoc_findings(output, staged, shown_root))


def _run(inside: Path, printed: Path, arguments: list[str]) -> tuple[int, bytes]:
    """Run protoc in a folder, and let it print to a file. Returns its exit code, and what it printed."""
    request = marshal.dumps((str(inside), str(printed), arguments))
    said = b""
    with _ONE_RUN_AT_A_TIME:
        for _ in range(2):  # the process may have been killed since the last run
            server = _server(os.getpid())
            assert server.stdin is not None, "it was asked for"  # noqa: S101  # for mypy
            assert server.stdout is not None, "it was asked for"  # noqa: S101  # for mypy
            try:
                with suppress(BrokenPipeError):
                    server.stdin.write(request)
                    server.stdin.flush()
                if code := server.stdout.readline():
                    return int(code), printed.read_bytes()
                said = server.communicate()[1]
            except BaseException:  # such as Ctrl-C
                # Nobody reads this answer, and the folder in which protoc still writes is removed: so wait for its end.
                server.communicate()
                _server.cache_clear()
                raise
            _server.cache_clear()
    return 1, said


@cache
def _server(_process: int) -> subprocess.Popen[bytes]:
    """Start the process that runs protoc for a process: a fork of ours must not share it."""
    # -I: no module of the user hides a standard one; -S: nor are packages looked for that are not needed.
    command = [sys.executable, "-I", "-S", "-c", _SERVE, str(_grpc_tools().parent)]
    pipe = subprocess.PIPE
    server = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, cwd="/")  # noqa: S603  # our Python
    atexit.register(server.__exit__, None, None, None)  # closes its pipes and waits for it
    return server


def _grpc_tools() -> Path:
    import grpc_tools  # here: the help of a command needs no protoc

    return Path(grpc_tools.__file__).parent


# protoc has no output for machines except GCC's form `file:line:column: text` (--error_format=gcc, its default). A file
# that is missing has no line. An import that is broken or missing repeats in every file behind it: without the patterns
# below, one typing error would give as many diagnostics as there are files.
_PLAIN_NAME = r"[^:\s][^:\n]*\.proto"
_PROTOC_MESSAGE = r"^(?P<file>%s):(?:(?P<line>\d+):(?P<column>\d+):)? *(?P<text>.*)$"
BROKEN_IMPORT = re.compile(r'Import "(?P<file>[^"]+)" was not found or had errors\.')
_UNDEFINED = re.compile(r'"(?P<name>[^"]+)" (is not defined|seems to be defined)\b.*')
_NOT_FOUND = "File not found."


class _Error(NamedTuple):
    """An error message of protoc: one line of its output."""

    file: str
    line: int
    column: int
    text: str


def _protoc_findings(output: str, staged: Path, shown_root: str) -> list[Diagnostic]:
    """Return a diagnostic for each error in protoc's output.

    Errors that only follow from another error are left out.
    """
    errors = list(_errors(output, staged))
    broken = {error.file for error in errors if error.text != _NOT_FOUND}
    imported = {match["file"] for error in errors if (match := BROKEN_IMPORT.fullmatch(error.text))}
    missing_names = _declared_in(broken & imported, staged)
    imports: dict[str, list[Span]] = {}  # by file: the places where its broken imports are reported
    importers: dict[
        str, list[Span]
    ] = {}  # by protoc's message, which names the missing file: the places of its imports
    places: dict[Span, list[str]] = {}
    for error in errors:
        if not _is_consequence(error, broken, imported, missing_names):
            span = Span(shown(shown_root, error.file), error.line, error.column)
            if BROKEN_IMPORT.fullmatch(error.text):
                importers.setdefault(error.text, []).append(span)
                imports.setdefault(span.file, []).append(importers[error.text][0])
                if span != importers[error.text][0]:
                    continue  # one missing file is one error
            places.setdefault(span, []).append(error.text)
    if not places:
        said = _in_root(output, staged, shown_root) or "it printed no message"
        return [ProtoDoesNotCompile.at(Span(shown_root or "."), f"protoc failed: {said}")]
    return [
        ProtoDoesNotCompile.at(
            span,
            first,
            " ".join(rest),
            [(other, "also imported here") for other in importers.get(first, ())[1:]],
            rests_on=imports.get(span.file, ()) if _UNDEFINED.fullmatch(first) else (),
        )
        for span, (first, *rest) in places.items()
    ]


def _in_root(text: str, staged: Path, shown_root: str) -> str:
    """Return a text of protoc in which its copies of the files have the names of the user's files."""
    return text.replace(f"{staged}/", shown(shown_root, "")).strip()


def _errors(output: str, staged: Path) -> Iterator[_Error]:
    copies = (path.relative_to(staged).as_posix() for path in staged.rglob("*.proto"))
    # protoc prints a name as it is, even with colons and line feeds, which otherwise end a name.
    unusual = sorted((name for name in copies if not re.fullmatch(_PLAIN_NAME, name)), key=len, reverse=True)
    form = re.compile(_PROTOC_MESSAGE % "|".join([*map(re.escape, unusual), _PLAIN_NAME]), re.MULTILINE)
    # protoc prints the path with the folder of its -I option
    for match in form.finditer(_in_root(output, staged, "")):
        if not match["text"].startswith("warning:"):
            yield _Error(match["file"], int(match["line"] or 0), int(match["column"] or 0), match["text"])


def _declared_in(files: Iterable[str], staged: Path) -> set[str]:
    """Return the names, without package and enclosing messages, of the messages and enums that some files declare."""
    names: set[str] = set()
    for path in (staged / file for file in files):
        if path.is_file():
            file = declarations(path.read_text(encoding="utf-8", errors="replace"))
            names |= {message.name for message in file.messages} | {enum.name for enum in file.enums}
    return names


def _is_consequence(error: _Error, broken: Set[str], imported: Set[str], missing_names: Set[str]) -> bool:
    """Return True if an error of protoc only follows from another error.

    ``broken`` are the files with errors of their own, and ``imported`` the files that could not be imported.
    ``missing_names`` are the types that are unknown because a broken file declares them.
    """
    if error.text == _NOT_FOUND:
        return error.file in imported  # the import statement is a better place for the error
    if match := BROKEN_IMPORT.fullmatch(error.text):
        return match["file"] in broken
    match = _UNDEFINED.fullmatch(error.text)
    return match is not None and match["name"].rpartition(".")[2] in missing_names
