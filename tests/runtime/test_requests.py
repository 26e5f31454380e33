"""Requests that are repeated until they are answered: the machines alone, and bridges and clients with bad links."""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import heapq
import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import pytest
from asking import asking_registry
from bridge_rig import Rig, changed, listener, port_of, waiting
from hypothesis import given
from hypothesis import strategies as st
from polling import PATIENCE_S, wait_until
from relay import Relay

from roverlink.runtime import Qos, SetupError
from roverlink.runtime.client import BlockingPeer, ClosedError, Peer, UnansweredError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import RowRequest
from roverlink.runtime.core.registry import AnyHandler
from roverlink.runtime.core.repeater import LARGEST_NUMBER, Fate, Repeater, Responses, lifetime


def _row(name: str) -> AnyHandler:
    return asking_registry().by_name[name]


# --- the machines, without threads and clocks -------------------------------------------------------------------

_losses = st.lists(st.sampled_from(["lost", 0.01, 0.3, 0.45]), max_size=60)


_callers = st.tuples(st.floats(0, 3), st.sampled_from([None, 0.0, 0.005, 0.5]))


@given(_losses, st.booleans(), st.integers(1, 6), st.lists(_callers, min_size=1, max_size=8))
def test_each_caller_gets_one_end_and_the_right_response(
    fates: list[Any], has_field: bool, attempts: int, callers: list[tuple[float, float | None]]
) -> None:
    """Whatever the link loses, repeats, and delays by less than the timeout, no response reaches another caller.

    A caller whose patience ends before may have no end.
    """
    settings = RowRequest("", timeout_ms=1000, attempts=attempts, field="id" if has_field else "")
    repeater, memory, fates = Repeater[int](settings), Responses(settings), [*fates]
    ends: Counter[int] = Counter()
    executed: Counter[bytes] = Counter()
    events: list[tuple[float, int, Callable[[float], None]]] = []
    order = itertools.count()

    def after(delay: float | str, action: Callable[[float], None], now: float) -> None:
        if not isinstance(delay, str):
            heapq.heappush(events, (now + delay, next(order), action))

    def ask(caller: int, now: float) -> None:
        number = repeater.new_number()
        repeater.add(number, b"%d %d" % (number if has_field else 0, caller), caller)

    def at_receiver(datagram: bytes, now: float) -> None:
        number, caller = map(int, datagram.split())
        known = memory.take(datagram, number, now)
        if known is Fate.UNKNOWN:
            executed[datagram] += 1
            memory.store(number, known := b"%d %d" % (number, caller))
        assert isinstance(known, bytes)
        after(fates.pop() if fates else 0.01, partial(at_sender, known), now)

    def at_sender(response: bytes, now: float) -> None:
        number, caller = map(int, response.split())
        found = repeater.answered(number, now)
        if not isinstance(found, Fate):
            assert found == caller
            ends[caller] += 1

    for caller, (start, patience) in enumerate(callers):
        after(start, partial(ask, caller), 0.0)
        if patience is not None:
            after(start + patience, partial(repeater.cancel, caller), 0.0)
    now, sent = 0.0, Counter[bytes]()
    while events or repeater.next_due < float("inf"):
        now = max(now, min(events[0][0] if events else float("inf"), repeater.next_due))
        while events and events[0][0] <= now:
            heapq.heappop(events)[2](now)
        datagrams, unanswered = repeater.take_due(now)
        assert has_field or len(datagrams) <= 1, "one at a time"
        ends.update(unanswered)
        for datagram, again in datagrams:
            sent[datagram] += 1
            assert again == (sent[datagram] > 1)
            # A round trip takes less than the timeout.
            after(fates.pop() if fates else 0.01, partial(at_receiver, datagram), now)
    assert set(ends.values()) <= {1}
    assert {caller for caller, (_, patience) in enumerate(callers) if patience is None} <= ends.keys()
    assert all(count <= attempts for count in sent.values())
    assert set(executed.values()) <= {1}


@given(st.lists(st.tuples(st.integers(0, 20), st.booleans(), st.floats(0, 0.5)), max_size=80))
def test_a_request_is_passed_on_once_in_its_lifetime(steps: list[tuple[int, bool, float]]) -> None:
    """A repetition is dropped, or gets the stored response; one without a number is always new."""
    settings, now = RowRequest("", timeout_ms=500, attempts=3, field="id"), 0.0
    memory, passed_on, answered = Responses(settings), dict[int, float](), set[int]()
    for number, answers, pause in steps:
        now += pause
        found, is_known = memory.take(b"%d" % number, number, now), now < passed_on.get(number, -1.0)
        assert found == ((b"%d" % number if number in answered else Fate.REPEATED) if is_known else Fate.UNKNOWN)
        if number and not is_known:
            passed_on[number] = now + lifetime(settings)
            answered.discard(number)
        if number and answers:
            memory.store(number, b"%d" % number)
            answered.add(number)


def test_numbers_wrap_and_memory_has_a_bound() -> None:
    """A number is positive, never that of a request of the last time, and no flood fills the memory."""
    settings = RowRequest("", timeout_ms=500, attempts=1, field="id")
    repeater, memory = Repeater[int](settings, first=LARGEST_NUMBER), Responses(settings)
    assert [repeater.new_number() for _ in range(3)] == [LARGEST_NUMBER, 1, 2]
    for caller in range(1000):
        assert not repeater.is_full
        repeater.add(repeater.new_number(), b"", caller)
    assert repeater.is_full
    found = [memory.take(b"%d" % number, number, 0.0) for number in (*range(1, 5001), 5000, 1)]
    assert found == [Fate.UNKNOWN] * 5000 + [Fate.REPEATED, Fate.UNKNOWN]
    assert Repeater[int](settings).answered(1, 0.0) is Fate.UNKNOWN


# --- requests of a peer -----------------------------------------------------------------------------------------


@pytest.fixture
def rig() -> Iterator[Rig]:
    """A bridge of the table with requests."""
    with Rig(asking_registry()) as rig:
        yield rig


def _datagram(**payload: Any) -> bytes:
    return bytes(asking_registry().envelope(**payload).SerializeToString())


def _answer_on_topic(rig: Rig) -> list[int]:
    """A node that finds what it is asked for, and keeps what it was asked."""
    asked: list[int] = []
    publisher = rig.node.publisher("/found", _row("found").message_type, Qos())

    def find(messages: Sequence[bytes]) -> None:
        for message in messages:
            request = _row("find").from_cdr(message)
            asked.append(request.what)
            publisher.publish([_row("found").to_cdr(_row("found").payload_type(id=request.id, x=request.what / 2))])

    rig.node.subscribe("/find", _row("find").message_type, Qos(), find)
    return asked


def test_a_repeated_request_gets_the_stored_response(rig: Rig) -> None:
    """The node hears it once, the peer gets the same response each time; without a number, all are passed on."""
    asked, request = _answer_on_topic(rig), _datagram(find={"id": 7, "what": 3})
    rig.receive(request, request, _datagram(find={"id": 8, "what": 3}), request)
    assert asked == [3, 3]
    assert rig.arrived("base", 4) == [_datagram(found={"id": id, "x": 1.5}) for id in (7, 7, 8, 7)]
    rig.receive(*[_datagram(find={"what": 4})] * 2)
    assert asked == [3, 3, 4, 4]
    account = rig.account
    assert (account.dropped["repeated"], account.repeated) == (2, Counter(found=2))
    assert (account.sent["found"], account.published["find"]) == (4, 4)


def test_a_service_is_called_instead_of_the_topic(rig: Rig, caplog: pytest.LogCaptureFixture) -> None:
    """An error of the service, and a service that is not there, let the next repetition try again."""
    service = _row("measure").route.request.service
    request = _datagram(measure={"id": -5, "x": 3})
    rig.receive(request)
    assert rig.account.dropped == Counter(not_published=1)
    assert "no node offers the service measure_rock" in caplog.text
    errors, calls = ["the camera is cold", "", ""], list[int]()

    def measure(data: bytes, respond: Callable[[bytes], None]) -> None:
        calls.append(cdr.decode(service.request, data).x)
        respond(cdr.encode(service.response(error=errors[len(calls) - 1], length=2.5)))

    rig.node.offer("/measure_rock", service, measure)
    rig.receive(request, request, request)
    assert calls == [3, 3]
    assert "the camera is cold" in caplog.text
    assert rig.arrived("base", 2) == [_datagram(measured={"id": -5, "length": 2.5})] * 2
    assert not rig.on_topic["measure"]
    assert rig.account.published["measure"] == rig.account.taken["measured"] + 1 == 2


# --- requests to a peer -----------------------------------------------------------------------------------------


def _call(rig: Rig, name: str, **values: Any) -> list[Any]:
    """Call a service; the list gets the response."""
    service = next(
        one.route.request.service for one in (_row("grip"), _row("light")) if one.route.request.service.name == name
    )
    responses: list[Any] = []
    client = rig.node.client(f"/{name}", service)
    assert client.call(
        cdr.encode(service.request(**values)), lambda data: responses.append(cdr.decode(service.response, data))
    )
    return responses


def test_a_call_gets_the_response_of_the_peer_once(rig: Rig) -> None:
    """The request goes on until the response comes; a second response is dropped, one that nobody asked for is not."""
    responses = _call(rig, "grip", force=0.5)
    first, second = rig.arrived("board", 2)[:2]
    assert first == second
    number = asking_registry().envelope.FromString(first).grip.id
    answer = _datagram(gripped={"id": number, "force": 0.25})
    rig.receive(answer, answer, _datagram(gripped={"id": number + 1}))
    assert [(one.error, one.force) for one in responses] == [("", 0.25)]
    assert len(rig.on_topic["gripped"]) == 2
    assert rig.account.dropped == Counter(repeated=1)
    assert rig.account.sent["grip"] == 1
    wait_until(lambda: rig.account.repeated["grip"], "the count of the second one")
    rig.publish("grip", _row("grip").payload_type(id=1, force=9))  # a message of the topic is sent once, as it is
    assert _datagram(grip={"id": 1, "force": 9}) in rig.arrived("board", 1)


def test_a_call_without_a_response_gets_an_error(rig: Rig, caplog: pytest.LogCaptureFixture) -> None:
    """One at a time without a field: the second call is sent when the first has ended."""
    responses = [_call(rig, "switch_light", on=True), _call(rig, "switch_light", on=False)]
    wait_until(lambda: responses[1], "the end of both calls")
    error = "board has not answered light, which was sent 2 times"
    assert [[one.error for one in of_call] for of_call in responses] == [[error], [error]]
    assert rig.arrived("board", 4) == [_datagram(light={"on": True})] * 2 + [_datagram(light={})] * 2
    assert rig.account.unanswered == Counter(light=2)
    assert error in caplog.text


def test_a_call_does_not_wait_for_a_peer_of_another_schema(rig: Rig) -> None:
    """A call that waits gets an error when the schema is refused, and so does a later one; nothing more is sent."""
    first = _call(rig, "grip", force=1)
    rig.arrived("board", 1)
    row = next(row for row in rig.bridge._outbound_rows if row.name == "grip")
    row.refused = True
    wait_until(lambda: first, "the end of the call")
    rig.arrived("board")
    assert [one.error for one in (*first, *_call(rig, "grip", force=2))] == ["board has another schema of grip"] * 2
    assert rig.arrived("board") == []
    assert rig.account.refused == Counter(grip=1)


def test_calls_end_with_the_bridge() -> None:
    """A call that waits, and one that comes later, get an error; nothing remains unanswered."""
    patient = dataclasses.replace(_row("light").route.request, timeout_ms=3_600_000)
    with Rig(changed(asking_registry(), "light", request=patient)) as rig:
        first, queued = _call(rig, "switch_light", on=True), _call(rig, "switch_light", on=True)
    late = _call(rig, "switch_light", on=True)
    assert [one.error for calls in (first, queued, late) for one in calls] == ["the bridge stops"] * 3
    assert rig.account.superseded["light"] == 2


# --- clients, and bad links -------------------------------------------------------------------------------------


@contextlib.contextmanager
def _behind_a_bad_link(rig: Rig, name: str, loss: float, local: int) -> Iterator[tuple[int, int]]:
    """The port of a relay to the bridge, and the local port of a peer, whom another relay reaches."""
    with contextlib.ExitStack() as stack:
        there = stack.enter_context(Relay(listener(), ("127.0.0.1", rig.bridge.port), 1, loss, 0.1, 0.002))
        back = stack.enter_context(Relay(listener(), ("127.0.0.1", local), 2, loss, 0.1, 0.002))
        rig.live.change({asking_registry().peers_by_name[name].port_parameter: back.address[1]})
        yield there.address[1], local


def _opened(kind: Any, name: str, ports: tuple[int, int]) -> Any:
    return kind.open(name, registry=asking_registry(), port=ports[0], local_address="127.0.0.1", local_port=ports[1])


@pytest.mark.parametrize("count", [50, pytest.param(1000, marks=pytest.mark.slow)])
def test_requests_of_a_client_over_a_bad_link(rig: Rig, free_udp_ports: Sequence[int], count: int) -> None:
    """With 30 % loss each way, each request ends with its response or an error, and the node hears none twice."""
    asked = _answer_on_topic(rig)

    async def ask_all(ports: tuple[int, int]) -> list[Any]:
        async with _opened(Peer, "base", ports) as peer:
            requests = [peer.request(_row("find").payload_type(what=number)) for number in range(count)]
            return await asyncio.wait_for(asyncio.gather(*requests, return_exceptions=True), PATIENCE_S)

    with _behind_a_bad_link(rig, "base", 0.3, free_udp_ports[0]) as ports:
        results = asyncio.run(ask_all(ports))
    answered = [number for number, one in enumerate(results) if not isinstance(one, UnansweredError)]
    assert [results[number].x for number in answered] == [number / 2 for number in answered]
    assert len(answered) > 0.98 * count
    assert len(asked) == len(set(asked))
    assert set(answered) <= set(asked)


@pytest.mark.parametrize("count", [50, pytest.param(1000, marks=pytest.mark.slow)])
def test_calls_of_a_service_over_a_bad_link(rig: Rig, free_udp_ports: Sequence[int], count: int) -> None:
    """The same towards a board, whose client drops repeated requests and repeats its responses by itself."""
    done: list[float] = []

    async def be_a_board(ports: tuple[int, int]) -> list[list[Any]]:
        async with _opened(Peer, "board", ports) as peer:
            calls = [_call(rig, "grip", force=number) for number in range(count)]

            async def carry_out() -> None:
                async for _, payload in peer:
                    done.append(payload.force)
                    peer.send(_row("gripped").payload_type(id=payload.id, force=payload.force))

            task = asyncio.create_task(carry_out())
            while not all(calls):
                await asyncio.sleep(0.005)
            task.cancel()
            return calls

    with _behind_a_bad_link(rig, "board", 0.3, free_udp_ports[0]) as ports:
        calls = asyncio.run(asyncio.wait_for(be_a_board(ports), PATIENCE_S))
    assert {len(responses) for responses in calls} == {1}
    answered = [number for number, (response,) in enumerate(calls) if not response.error]
    assert [calls[number][0].force for number in answered] == answered
    assert len(answered) > 0.98 * count
    assert len(done) == len(set(done))
    assert rig.account.unanswered["grip"] == count - len(answered)


def test_a_program_without_asyncio_asks(rig: Rig) -> None:
    """It gets the response, and other payloads stay for `receive`; mistakes and silence are errors."""
    _answer_on_topic(rig)
    hasty = changed(
        asking_registry(), "measure", request=dataclasses.replace(_row("measure").route.request, attempts=2)
    )
    with BlockingPeer.open("base", registry=hasty, port=rig.bridge.port, local_port=0) as peer:
        rig.live.change({asking_registry().peers_by_name["base"].port_parameter: peer.port})
        rig.publish("measured", _row("measured").payload_type(length=1))
        assert peer.request(_row("find").payload_type(what=5)).x == 2.5
        assert peer.receive(_row("measured").payload_type, PATIENCE_S).length == 1
        with pytest.raises(UnansweredError, match="no response to measure, which was sent 2 times"):
            peer.request(_row("measure").payload_type(x=1))
    with pytest.raises(ClosedError):
        peer.request(_row("find").payload_type())
    with (
        BlockingPeer.open("board", registry=asking_registry(), local_port=0) as board,
        pytest.raises(SetupError, match="lit"),
    ):
        board.request(_row("lit").payload_type())


def test_a_request_ends_with_its_task_or_its_peer() -> None:
    """A cancelled request is not sent any more, and closing the peer ends the others with an error."""

    async def run(sock: Any) -> None:
        async with Peer.open("base", registry=asking_registry(), port=port_of(sock), local_port=0) as peer:
            first, second = (asyncio.create_task(peer.request(_row("find").payload_type(what=one))) for one in (1, 2))
            await asyncio.sleep(0)
            first.cancel()
            await asyncio.wait([first])
            waiting(sock)
            loop = asyncio.get_running_loop()
            again = [await loop.run_in_executor(None, sock.recv, 100) for _ in range(3)]
        assert [asking_registry().envelope.FromString(one).find.what for one in again] == [2, 2, 2]
        with pytest.raises(ClosedError, match="base was closed before the response came"):
            await second

    with listener() as sock:
        asyncio.run(run(sock))
