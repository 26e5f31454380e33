"""`roverlink simulate`: streams that a seed repeats, scenarios that do what they say, and sums that agree."""

from __future__ import annotations

import itertools
import json
import random
import socket
from collections import Counter, defaultdict
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pytest
from asking import TABLE as ASKING
from asking import asking_registry, write_asking_project
from linked import TABLE, linked_registry, write_project
from programs import Start
from repeating import repeated
from running import Called

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Registry, Translator
from roverlink.runtime.core.envelope import restore
from roverlink.runtime.keys.key_file import make_key_file
from roverlink.simulation.run_account import PUBLISHED, RunTotals, predict
from roverlink.simulation.scenarios import SCENARIOS, Emission, World, emissions

_LONGEST = 1472
_TRANSLATOR = Translator(REGISTRY)
_FAULTS = [name for name in SCENARIOS if name != "hostile"]  # the sample rover has no peer that must sign


def _world(seed: int = 1, registry: Registry = REGISTRY) -> World:
    return World(registry, random.Random(seed), _LONGEST)  # noqa: S311  # repeatable, not secret


def _first(count: int, *names: str, seed: int = 1, rate: float = 300.0) -> list[Emission]:
    return list(itertools.islice(emissions(_world(seed), rate, list(names)), count))


def _fates(stream: list[Emission]) -> Counter[str]:
    return Counter(predict(emission.datagram, _TRANSLATOR, _LONGEST) for emission in stream)


@pytest.mark.parametrize("names", [[name] for name in _FAULTS] + [_FAULTS, _FAULTS[::-1]])
@pytest.mark.slow
def test_a_seed_gives_one_stream_in_the_order_of_time(names: list[str]) -> None:
    """Whatever the scenario, and all of them at once."""
    stream = _first(2000, *names)
    assert stream == _first(2000, *names)
    assert [emission.at for emission in stream] == sorted(emission.at for emission in stream)


def test_in_good_days_every_row_speaks_and_everything_is_published() -> None:
    """As often as any other, at the rate that was asked for."""
    stream = _first(300)
    assert set(Counter(emission.name for emission in stream).values()) == {20}
    assert stream[-1].at == pytest.approx(299 / 300)
    assert _fates(stream) == {PUBLISHED: 300}


def test_stale_repeats_values_for_seconds() -> None:
    """The stream goes on at its rate; what it says does not."""
    by_name = defaultdict(list)
    for emission in _first(1500, "stale"):
        by_name[emission.name].append(emission.datagram)
    assert all(len(set(datagrams)) < 30 for datagrams in by_name.values())
    assert sum(map(len, by_name.values())) == 1500


@pytest.mark.slow
def test_datagrams_with_faults_are_dropped_for_their_reasons() -> None:
    """With old-schema, payloads of no row; with malformed, every reason that lies in a datagram. The rest stays."""
    old, malformed = (_fates(_first(1000, name)) for name in ("old-schema", "malformed"))
    assert 850 < old[PUBLISHED] < 950
    assert set(old) == {"unknown_payload", PUBLISHED}
    assert 800 < malformed[PUBLISHED] < 920
    reasons = {"empty", "malformed", "oversized", "unknown_payload", "wrong_direction"}
    assert set(malformed) >= reasons | {PUBLISHED}


@pytest.mark.slow
def test_padded_means_what_the_stream_means() -> None:
    """Padding and stripping change bytes, and no envelope."""
    plain, padded = _first(1000), _first(1000, "padded")
    assert sum(a.datagram != b.datagram for a, b in zip(plain, padded)) > 200
    assert [restore(a.datagram) for a in plain] == [restore(b.datagram) for b in padded]


def test_flood_is_one_row_that_says_the_same_a_hundred_times() -> None:
    """The others go on as before."""
    counts = Counter(emission.name for emission in _first(10_000, "flood"))
    (_, most), *others = counts.most_common()
    assert most > 8000
    assert len(others) == 14


@pytest.mark.slow
def test_reboot_is_a_silence_and_a_start_at_zero() -> None:
    """In another life, which has a port of its own."""
    stream = [emission for emission in _first(4000, "reboot") if emission.peer == "hardware"]
    gaps = [b for a, b in itertools.pairwise(stream) if b.at - a.at > 0.9]
    assert gaps
    assert [emission.life for emission in gaps] == list(range(1, len(gaps) + 1))
    reborn = next(emission for emission in stream if emission.life and emission.name == "imu_info")
    said = _TRANSLATOR.parse(reborn.datagram).imu_info  # type: ignore[attr-defined]
    newborn = payload_at(type(said), 0.0)
    assert said.accel_x == pytest.approx(newborn.accel_x, abs=1.0)


@pytest.mark.slow
def test_a_bridge_in_memory_adds_up(called: Called) -> None:
    """Every scenario at once; each datagram is found, as published or with the reason of its drop."""
    scenarios = itertools.chain.from_iterable(("--scenario", name) for name in _FAULTS)
    code, output, errors = called(
        "simulate", "--bridge", "memory", "--seconds", 2, "--rate", 1500, "--json", *scenarios
    )
    assert code == 0, output + errors
    account = json.loads(output)
    assert account["faults"] == []
    assert sum(account["sent"].values()) == account["bridge"]["received"] + account["bridge"]["kernel_drops"]
    assert account["bridge"]["received"] > 0
    assert account["bridge"]["dropped"].items() <= account["sent"].items()
    assert account["commands"] > 0


def test_a_rate_that_the_computer_cannot_reach_is_told() -> None:
    """A tenth of it was reached: the note says how much that was; a run that was in time has no note."""
    late, in_time = RunTotals(seconds=10.0, played=1.0), RunTotals(seconds=10.0, played=9.9)
    assert late.missed_rate(5000.0).startswith("missed the rate: 500 of 5000 datagrams a second")
    assert in_time.missed_rate(5000.0) == ""


@pytest.mark.slow
def test_a_bridge_of_somebody_elses_gets_the_stream(peer: socket.socket, called: Called) -> None:
    """Without an account: who listens there is not known."""
    code, output, _ = called("simulate", "--to", f"127.0.0.1:{peer.getsockname()[1]}", "--seconds", 0.2, "--json")
    assert code == 0
    count = json.loads(output)["sent"][PUBLISHED]
    assert json.loads(output)["sent"] == {PUBLISHED: count}
    assert 0 < count <= 60  # fewer where the machine is busy
    assert all(peer.recv(65_536) for _ in range(count))
    peer.setblocking(False)
    with pytest.raises(BlockingIOError):
        peer.recv(65_536)


def _account(**changed: Any) -> dict[str, Any]:
    account: dict[str, Any] = {"received": 10, "published": 8, "dropped": {"malformed": 2}, "kernel_drops": 0}
    account |= {"taken": 3, "sent": 3, "refused": {}, "superseded": {}, "failed": {}, "stops": {}, "forwarded": 0}
    account |= {"links_received": 0, "links_sent": {}, "other_schemas": {}}
    account |= {"unchanged": {}, "late": {}, "repeated": {}, "undelivered": {}}
    return account | changed


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({}, None),
        ({"received": 9, "published": 7}, "sent 10 datagrams, but received or dropped by the kernel: 9"),
        ({"published": 7}, "10 datagrams received, but 9 published and dropped"),
        ({"dropped": {"malformed": 1, "empty": 1}}, "expected as dropped for malformed: 2 datagrams, but dropped: 1"),
        ({"sent": 2}, "3 messages taken, but 2 sent"),
        ({"forwarded": 1}, "the bridge sent 4 datagrams to the peers; arrived or dropped by the kernel: 3"),
        ({"taken": 4, "refused": {"x": 1}}, "published 3 messages, but the bridge received 4"),
    ],
)
def test_sums_that_do_not_agree_are_told(changed: dict[str, Any], fault: str | None) -> None:
    """Each by the numbers that contradict each other."""
    totals = RunTotals(Counter({PUBLISHED: 8, "malformed": 2}), commands=3, arrived=3, account=_account(**changed))
    assert bool(totals.faults()) == (fault is not None)
    assert fault is None or any(found.startswith(fault) for found in totals.faults())


def test_memory_that_grows_is_told() -> None:
    """After a while in which it may."""
    mebibyte = 1024 * 1024
    flat = [40 * mebibyte] * 4 + [60 * mebibyte] * 12
    totals = RunTotals(Counter({PUBLISHED: 8, "malformed": 2}), commands=3, arrived=3, account=_account())
    totals.memory = flat
    assert totals.faults() == []
    totals.memory = [*flat, 70 * mebibyte]
    assert totals.faults() == ["the bridge's memory grew from 60.0 MiB to 70.0 MiB"]


@pytest.mark.parametrize("names", [[], ["old-schema"], ["lossy", "padded", "reboot", "stale", "flood"]], ids=str)
def test_peers_of_a_table_with_the_link_message_send_it(names: list[str]) -> None:
    """Each board and the basestation tell their rows once a second; with old-schema, other hashes of what they send."""
    registry = linked_registry()
    world = _world(registry=registry)
    stream = list(itertools.takewhile(lambda emission: emission.at < 3.5, emissions(world, 30, names)))
    told: dict[int, set[int]] = defaultdict(set)
    ends = set()
    for emission in stream:
        if emission.end is not None:
            ends.add(str(emission.end))
            link = registry.envelope.FromString(restore(emission.datagram)).link  # type: ignore[attr-defined]
            for number, hash in zip(link.numbers, link.hashes):
                told[number].add(hash)
    assert ends == {"Arm of hardware", "Drive of hardware", "base"}
    assert registry.link is not None
    same = {number for number, hashes in told.items() if hashes == {registry.link.hashes[number]}}
    assert same == ({3, 5} if "old-schema" in names else {1, 2, 3, 4, 5})


@pytest.mark.parametrize("names", [[], ["stale"], ["reboot", "flood"], ["flood", "reboot"]], ids=str)
def test_link_messages_count_what_the_program_has_sent_since_its_start(names: list[str]) -> None:
    """Otherwise the bridge would see losses that there are not, or would not see losses."""
    registry = linked_registry()
    world = _world(registry=registry)
    sent, told = Counter[Any](), 0
    for emission in itertools.takewhile(lambda emission: emission.at < 9, emissions(world, 30, names)):
        program = world.sender_of(emission), emission.life
        if emission.end is not None:
            link = registry.envelope.FromString(emission.datagram).link  # type: ignore[attr-defined]
            assert link.sent == sent[program]
            told += 1
        sent[program] += 1
    assert told > 20
    assert any(life for _, life in sent) == ("reboot" in names)


@pytest.mark.slow
def test_a_simulated_board_with_old_protos_is_named(done: Start, tmp_path: Path) -> None:
    """The report names each board whose schema differs, with its rows, and all sums agree."""
    project = write_project(tmp_path / "rover")
    options = ("--project", project, "--bridge", "memory", "--seconds", 1.5, "--scenario", "old-schema")
    code, output, errors = done("simulate", *options)
    assert code == 0, errors
    for board, row in (("Arm of hardware", "arm_state"), ("Drive of hardware", "drive_state"), ("base", "mode")):
        assert f"{board} has another schema of {row}\n" in output
    assert "link messages" in output
    assert "sent to the bridge: " in output
    assert output.splitlines()[-1] == "No problems found: all counts add up."


_SIGNED = TABLE.replace("link:", "signing: {number: 21}\nlink:").replace("port: 6001", "port: 6001, sign: required")


@pytest.fixture(scope="module")
def signed_project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project with link messages whose boards must sign, and whose basestation need not."""
    return write_project(tmp_path_factory.mktemp("signed") / "rover", _SIGNED)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scenarios", "drops"),
    [
        ("flood padded hostile", {"malformed_signature", "outdated", "replayed", "unsigned", "wrong_signature"}),
        ("lossy padded", {"outdated", "replayed"}),
    ],
)
def test_attacks_are_refused_each_for_its_reason(
    done: Start, signed_project: Path, scenarios: str, drops: set[str]
) -> None:
    """The bridge and the peers have keys of this run alone, and all counts are those that the attacks should give."""
    options = ["--bridge", "memory", "--seconds", 2, "--json", "--rate", 1000]
    options += itertools.chain.from_iterable(("--scenario", name) for name in scenarios.split())
    code, output, errors = done("simulate", "--project", signed_project, *options)
    assert code == 0, output + errors
    account = json.loads(output)
    dropped = account["bridge"]["dropped"]
    assert dropped.keys() >= drops
    assert {reason: account["sent"][reason] for reason in drops} == {reason: dropped[reason] for reason in drops}
    assert account["bridge"]["links_received"] == account["sent"]["link message"]


@pytest.mark.slow
def test_a_simulated_board_answers_what_it_is_asked(
    done: Start, peer: socket.socket, tmp_path: Path, free_udp_ports: Sequence[int]
) -> None:
    """At its port, with the number of the request; a response that nobody has asked for does not come."""
    port = peer.getsockname()[1]
    board = ("127.0.0.1", free_udp_ports[0])
    project = write_asking_project(tmp_path / "asking", ASKING.replace("6001", str(board[1])))
    envelope: Any = asking_registry().envelope
    request = envelope(grip={"id": 7, "force": 0.5}).SerializeToString()
    with repeated(lambda _: peer.sendto(request, board), 0.05):
        options = ("--project", project, "--peer", "board", "--to", f"127.0.0.1:{port}", "--seconds", 2, "--json")
        code, output, errors = done("simulate", *options)
    assert code == 0, errors
    for _ in range(json.loads(output)["sent"][PUBLISHED]):
        answer = envelope.FromString(peer.recv(1000))
        assert (answer.WhichOneof("payload"), answer.gripped.id) == ("gripped", 7)
        assert answer.gripped.force > 0


@pytest.mark.slow
def test_requests_through_a_bridge_are_answered(done: Start, tmp_path: Path) -> None:
    """What the nodes ask is answered by the simulated board, and all sums agree."""
    project = write_asking_project(tmp_path / "asking")
    code, output, errors = done("simulate", "--project", project, "--bridge", "memory", "--seconds", 2, "--json")
    assert code == 0, errors
    account = json.loads(output)["bridge"]["by_payload"]
    assert 0 < account["published"]["gripped"] <= account["sent"]["grip"]  # the last ones may not be answered any more


@pytest.mark.slow
def test_a_missing_key_is_told(done: Start, signed_project: Path, tmp_path: Path) -> None:
    """Exit code 2, and one line that names the option; a peer that need not sign can be simulated alone."""
    assert done("simulate", "--project", signed_project, "--peer", "base", "--seconds", 0.1)[0] == 0
    make_key_file(tmp_path / "base.keys", "base", datetime.now(timezone.utc))
    code, output, errors = done("simulate", "--project", signed_project, "--key-file", "base.keys", folder=tmp_path)
    assert (code, output, len(errors.splitlines())) == (2, "", 1)
    assert "'hardware' must sign (table key `sign`), but no key file has a key of it" in errors
