"""A board's firmware: C that nanopb's own generator makes of our protos, with the options that our target writes."""

from __future__ import annotations

import shutil
import struct
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path
from random import Random
from typing import Any

import pytest
from case_file import usual_table
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from grpc_tools import protoc
from nanopb_board import compiled
from payloads import random_payload

from generated.registry import REGISTRY
from roverlink.generator.pipeline import compile_table
from roverlink.runtime.core.envelope import strip_trailing_zeros
from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.signing import Key, Signer, SigningClock, Verifier
from roverlink.runtime.core.translator import Translator

ROOT = Path(__file__).parents[2]
_REFUSED = 0xFFFF
_NOTE_TABLE = usual_table("""\
peers: {board: {max_size: 128}}
targets: [python, nanopb]
messages:
  - number: 1
    name: note
    proto: Note
    topic: note
    direction: ros_to_board
    bounds: {text: {length: 20}, samples: {count: 4}, parts: {count: 2}, parts.raw: {length: 6}}
""")
_NOTE = """\
syntax = "proto3";

message Note {
  string text = 1;
  repeated sint32 samples = 2;
  repeated Part parts = 3;
}

message Part {
  bytes raw = 1;
}
"""


class Firmware:
    """A program that decodes envelopes into nanopb's structs, and encodes them again."""

    def __init__(self, program: Path) -> None:
        self._program = program

    def echo(self, datagrams: Sequence[bytes]) -> list[bytes | None]:
        """What comes back for each; None for what the board does not take."""
        sent = b"".join(struct.pack("<H", len(datagram)) + datagram for datagram in datagrams)
        answered = subprocess.run([self._program], input=sent, capture_output=True, check=True).stdout
        answers: list[bytes | None] = []
        while answered:
            (length,) = struct.unpack_from("<H", answered)
            size = 0 if length == _REFUSED else length
            answers.append(None if length == _REFUSED else answered[2 : 2 + size])
            answered = answered[2 + size :]
        assert len(answers) == len(datagrams)
        return answers


def _firmware(folder: Path, project: Path, protos: Iterable[str], envelope: str, message: str, *more: str) -> Firmware:
    """The firmware of a project, compiled in a folder."""
    header = envelope.removesuffix(".proto") + ".pb.h"
    defines = (f'-DENVELOPE_HEADER="{header}"', f"-DENVELOPE={message}", f"-DENVELOPE_FIELDS={message}_fields")
    options = project / "generated" / "nanopb"
    return Firmware(compiled(folder, project / "proto", options, protos, "nanopb_echo.c", *defines, *more))


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> Firmware:
    """Firmware of this repository's envelope."""
    protos = [path.relative_to(ROOT / "proto").as_posix() for path in ROOT.glob("proto/**/*.proto")]
    wanted = [path for path in protos if path != "components/common/message_types.proto"]
    folder = tmp_path_factory.mktemp("board")
    shutil.copytree(ROOT / "proto", folder / "project" / "proto")
    return _firmware(folder, folder / "project", wanted, "components/common/envelope.proto", "PBEnvelope")


@pytest.mark.parametrize("name", [handler.route.name for handler in REGISTRY.handlers])
def test_a_board_reads_what_we_send_and_we_read_what_it_sends(board: Firmware, name: str) -> None:
    """Random values of every payload go to nanopb's structs and come back as the same envelope."""
    random, translator = Random(name), Translator(REGISTRY)  # noqa: S311  # for values, not for secrets
    payload_type = REGISTRY.by_name[name].payload_type
    envelopes = [REGISTRY.envelope(**{name: random_payload(payload_type, random)}) for _ in range(40)]
    answers = board.echo([envelope.SerializeToString() for envelope in envelopes])
    assert None not in answers
    assert [translator.parse(answer or b"") for answer in answers] == envelopes


@pytest.fixture(scope="module")
def bounded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Firmware, Any]:
    """Firmware of a project whose table says what the board has room for, and that project's envelope class."""
    return _of_notes(tmp_path_factory.mktemp("bounded"), _NOTE_TABLE)


def _of_notes(folder: Path, table: str, *more: str) -> tuple[Firmware, Any]:
    project = folder / "project"
    (project / "proto").mkdir(parents=True)
    (project / "mapping.yaml").write_text(table)
    (project / "proto" / "note.proto").write_text(_NOTE)
    for path, text in compile_table(project / "mapping.yaml").files.items():
        (project / path).parent.mkdir(parents=True, exist_ok=True)
        (project / path).write_text(text)
    firmware = _firmware(folder, project, ["note.proto", "envelope.proto"], "envelope.proto", "Envelope", *more)
    return firmware, _envelope_class(project / "proto", folder / "descriptors")


def _envelope_class(root: Path, descriptors: Path) -> Any:
    """The envelope's class, in a pool of its own: several projects have the same names."""
    arguments = [f"-I{root}", f"--descriptor_set_out={descriptors}", "note.proto", "envelope.proto"]
    assert protoc.main(["protoc", *arguments]) == 0
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(descriptors.read_bytes()).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("Envelope"))


@pytest.mark.slow
def test_the_board_has_the_room_that_the_table_says(bounded: tuple[Firmware, Any]) -> None:
    """With our options, what fits the table's bounds crosses unharmed, and one byte or value more is refused."""
    firmware, envelope = bounded
    part = {"raw": b"123456"}
    fits = [{"text": "x" * 20}, {"samples": [-1, 0, 2, 3]}, {"parts": [part, part]}]
    too_much = [
        {"text": "x" * 21},
        {"samples": [1, 2, 3, 4, 5]},
        {"parts": [part] * 3},
        {"parts": [{"raw": b"1234567"}]},
    ]
    sent = [envelope(note=note).SerializeToString() for note in (*fits, *too_much)]
    assert firmware.echo(sent) == [*sent[: len(fits)], *[None] * len(too_much)]


@pytest.mark.slow
def test_a_board_that_must_sign(tmp_path: Path) -> None:
    """With the C functions that our target writes, a board takes each signed datagram once, and nothing else."""
    table = _NOTE_TABLE.replace("max_size: 128}", "max_size: 128, sign: required}") + "signing: {number: 23}\n"
    firmware, envelope = _of_notes(tmp_path, table, "-DSIGNED", "-DSIGNATURE_TAG=Envelope_signature_tag")
    clock = SigningClock()
    signer = Signer(23, Key(2, "ros", bytes([2] * 32)), clock)
    verifier = Verifier(23, [(Key(1, "board", bytes([1] * 32)), clock.last, clock)])
    notes = [envelope(note={"text": "x" * length, "samples": [length]}).SerializeToString() for length in range(20)]
    signed = [signer.sign(note) for note in notes]
    sent = [strip_trailing_zeros(datagram) + bytes(place % 3 * 7) for place, datagram in enumerate(signed)]
    answers = firmware.echo([signed[0][:-1] + bytes([signed[0][-1] ^ 1]), notes[0], *sent, sent[-1], sent[3]])
    assert [answer is None for answer in answers] == [True, True, *[False] * len(sent), True, True]
    for note, answer in zip(notes, answers[2:-2]):
        assert answer is not None
        verifier.verify(answer, {"board"})
        read = envelope.FromString(answer)
        assert read.note == envelope.FromString(note).note
        assert len(read.signature) == 15
        with pytest.raises(DatagramError, match="has come twice"):
            verifier.verify(answer, {"board"})
