"""The token of the page: its file, who may act with it, and the two actions."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import re
import socket
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from polling import PATIENCE_S
from visits import Events, act, ask, port_of

from bench.watched_link import WatchedLink, lines_of, watched_link
from roverlink.__main__ import main
from roverlink.link_page.page_token import PageToken
from roverlink.runtime.net.http_server import BoundedServer

TOKEN = "correct-horse-battery-staple"


@pytest.fixture(scope="module")
def token_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("token") / "token"
    path.write_text(f"{TOKEN}\n")
    path.chmod(0o600)
    return path


@pytest.fixture(scope="module")
def shared_link(token_file: Path) -> Iterator[WatchedLink]:
    """A bridge for tests that leave it as it was, and that send no wrong token."""
    with watched_link(token_file) as made:
        yield made


@pytest.fixture
def link(token_file: Path) -> Iterator[WatchedLink]:
    with watched_link(token_file) as made:
        yield made


def _parameters(link: WatchedLink) -> dict[str, Any]:
    status, body = ask(link.url, "/parameters", Authorization=f"Bearer {TOKEN}")
    assert status == 200
    return {parameter["name"]: parameter["value"] for parameter in json.loads(body)}


def _silence(link: WatchedLink, events: Events) -> dict[str, Any]:
    """The alarm of a command that has fallen silent."""
    link.command()
    return events.alarm("stop drive_motor")


@pytest.mark.slow
def test_an_alarm_is_acknowledged_for_all_browsers(link: WatchedLink) -> None:
    """The bridge keeps it, so that another browser gets it, too; its log says who has done it."""
    with Events(link.url) as events:
        alarm = _silence(link, events)
        assert not alarm["acknowledged"]
        assert act(link.url, "/acknowledge", [alarm["number"]], TOKEN) == (204, "")
        events.alarm("stop drive_motor", lambda now: now["acknowledged"])
    with Events(link.url) as late:
        assert late.alarm("stop drive_motor")["acknowledged"]
    assert "the alarm 'stop drive_motor' was acknowledged on the page from 127.0.0.1" in link.lines


def test_parameters_are_shown_and_set(link: WatchedLink) -> None:
    """Whoever has the token sees those that can change, and changes them; the log has the line of every change."""
    before = _parameters(link)
    assert before == {
        "dst_ip": "127.0.0.1",
        "forward_policy": "mapping",
        "source_policy": "mapping",
        "receive_buffer": 4194304,
        "dst_a_port": 6000,
        "dst_b_port": 6001,
    }
    assert act(link.url, "/parameters", {"dst_ip": "127.0.0.7", "dst_a_port": 6010}, TOKEN) == (204, "")
    assert _parameters(link) == {**before, "dst_ip": "127.0.0.7", "dst_a_port": 6010}
    assert "parameter dst_ip is now 127.0.0.7 (it was 127.0.0.1)" in link.lines


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("dst_b_port", 70_000, "the parameter 'dst_b_port' is 70000; a UDP port is a number from 1 to 65535"),
        ("listen_port", 5001, "the parameter 'listen_port' is read-only; restart the node with -p listen_port:=5001"),
        ("dst", "x", "unknown parameter 'dst'; did you mean 'dst_ip'?"),
        ("dst_ip", "a\ud800", "is neither an IP address nor the name of a host"),
        ("receive_buffer", [1], "the parameter 'receive_buffer' is [1]; it must be of type int"),
    ],
)
def test_a_refused_change_has_a_reason_and_changes_nothing(
    shared_link: WatchedLink, name: str, value: object, reason: str
) -> None:
    """All parameters of a request change, or none."""
    before = _parameters(shared_link)
    status, text = act(shared_link.url, "/parameters", {"dst_a_port": 6020, name: value}, TOKEN)
    assert (status, reason in text) == (409, True), text
    assert _parameters(shared_link) == before


@pytest.mark.slow
def test_only_the_page_itself_acts(link: WatchedLink) -> None:
    """A POST from another site, without an origin, to another name, or without the token is refused."""
    with Events(link.url) as events:
        alarm = _silence(link, events)
    own = link.url.rstrip("/")
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    for headers, status in (
        ({**bearer, "Origin": "http://evil.example"}, 403),
        (bearer, 403),
        ({**bearer, "Origin": "http://evil.example", "Host": "evil.example"}, 403),
        ({"Origin": own}, 401),
        ({"Origin": own, "Authorization": f"Basic {TOKEN}"}, 401),
        ({"Origin": own, "Authorization": f"Bearer {TOKEN}é"}, 401),
    ):
        for path, content in (("/acknowledge", [alarm["number"]]), ("/parameters", {"dst_a_port": 6030})):
            assert ask(link.url, path, "POST", content, **headers)[0] == status, headers
    assert ask(link.url, "/parameters")[0] == 401
    assert ask(link.url, "/parameters", Origin="http://evil.example", **bearer)[0] == 403
    assert _parameters(link)["dst_a_port"] == 6000
    with Events(link.url) as events:
        assert not events.alarm("stop drive_motor")["acknowledged"]


def test_the_token_is_told_to_nobody(link: WatchedLink, capsys: pytest.CaptureFixture[str]) -> None:
    """No line of the log and no answer without it contains the token, or a wrong one that was sent."""
    act(link.url, "/acknowledge", [1], "a-wrong-token-of-somebody")
    act(link.url, "/acknowledge", [1], TOKEN)
    seen = b"".join(ask(link.url, path)[1] for path in ("/", "/page.js", "/parameters", "/history"))
    assert any("refused a wrong token from 127.0.0.1" in line for line in link.lines)
    for secret in (TOKEN, "a-wrong-token-of-somebody"):
        assert secret not in "\n".join(link.lines) + seen.decode()
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("body", [b"{", b"[" * 10_000, b"[true]", b"[[1]]", b"{}", b"7", b"\xff", b"", b'{"1": 1}'])
def test_nonsense_is_refused(shared_link: WatchedLink, body: bytes) -> None:
    """It is answered with the reason, and the page goes on."""
    assert act(shared_link.url, "/acknowledge", body, TOKEN)[0] == 400
    assert act(shared_link.url, "/parameters", body, TOKEN)[0] in (400, 409)
    assert act(shared_link.url, "/other", b"[]", TOKEN)[0] == 404
    assert ask(shared_link.url, "/")[0] == 200


def test_wrong_tokens_have_to_wait() -> None:
    """Each earlier wrong token of the last minute costs its sender a second; the right token costs nobody anything."""
    now, logger = 0.0, logging.Logger("page")
    lines = lines_of(logger)
    token = PageToken(TOKEN, logger, lambda: now)

    def delay() -> float:
        refused = token.refusal("Bearer wrong", "127.0.0.1")
        assert refused is not None
        assert refused.status == 401
        return refused.delay_s

    assert [delay() for _ in range(12)] == [*range(11), 10]
    assert token.refusal(f"Bearer {TOKEN}", "127.0.0.1") is None
    now = 60.5
    assert delay() == 0
    assert lines == ["the page refused a wrong token from 127.0.0.1"]


def test_whoever_waits_for_the_answer_to_a_wrong_token_keeps_nobody_waiting(link: WatchedLink) -> None:
    """As many wrong tokens as the page has connections leave it free for the right one."""
    with contextlib.ExitStack() as stack:
        for _ in range(BoundedServer.connections + 1):
            sock = stack.enter_context(socket.create_connection(("127.0.0.1", port_of(link.url)), PATIENCE_S))
            sock.sendall(b"GET /parameters HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer wrong\r\n\r\n")
        assert _parameters(link)


def test_without_the_option_there_is_nothing_to_unlock() -> None:
    """The page says so to the browser, and has neither parameters nor actions."""
    with watched_link() as link:
        with Events(link.url) as events:
            assert events.next("page")["can_act"] is False
        assert ask(link.url, "/parameters", Authorization=f"Bearer {TOKEN}")[0] == 404
        assert act(link.url, "/acknowledge", [1], TOKEN)[0] == 501


@pytest.mark.slow
def test_a_missing_file_is_made(tmp_path: Path) -> None:
    """It has a random token that works, and is readable for its owner only, whatever the umask; the log names it."""
    path = tmp_path / "token"
    before = os.umask(0)
    try:
        with watched_link(path) as link:
            token = path.read_text().strip()
            assert stat.S_IMODE(path.stat().st_mode) == 0o600
            assert re.fullmatch(r"[A-Za-z0-9_-]{32}", token)
            assert act(link.url, "/acknowledge", [], token)[0] == 204
            assert f"made the file {path} with a random token for the page" in link.lines
    finally:
        os.umask(before)
    with watched_link(path) as link:
        assert path.read_text().strip() == token
        assert act(link.url, "/acknowledge", [], token)[0] == 204


_CONTENT = "must have 16 to 1024 ASCII characters without spaces; remove the file, and roverlink makes"
_MODE = "other users can read or write the token of the page; run: chmod 600 "


@pytest.mark.parametrize(
    ("content", "mode", "said"),
    [
        ("", 0o600, _CONTENT),
        ("fifteen-letters\n", 0o600, _CONTENT),
        ("ünsixteen-letters", 0o600, _CONTENT),
        ("x" * 2000, 0o600, _CONTENT),
        (TOKEN, 0o640, _MODE),
        (TOKEN, 0o602, _MODE),
    ],
)
def test_a_file_that_cannot_be_used_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str, mode: int, said: str
) -> None:
    """One line with the cure, and exit code 2; the content is not told."""
    path = tmp_path / "token"
    path.write_text(content)
    path.chmod(mode)
    for command in (["run"], ["record", str(tmp_path / "run.mcap")]):
        _refused([*command, "--page", "0", "--page-token", str(path)], f"roverlink: {path}: ", said, capsys)


def _refused(words: list[str], start: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*words[:1], "--middleware", "memory", *words[1:], "--ros-args", "-p", "listen_port:=0"]) == 2
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("roverlink: ")]
    assert start in line
    assert said in line
    assert TOKEN not in line
