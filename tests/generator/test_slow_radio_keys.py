"""The keys of mapping.yaml that spare a slow radio: what generated code says of them, the ledger, and mistakes."""

from __future__ import annotations

from pathlib import Path

import pytest
from rule_examples import write_project

from roverlink.__main__ import main
from roverlink.generator.table.value_types import DataRate
from roverlink.runtime.core.handler import SendLimits
from roverlink.runtime.core.registry import load_registry

_TABLE = """\
python: {{package: {package}}}
peers: {{board: {{}}, base: {{budget: {budget}}}, other: {{}}}}
messages:
  - {{number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, priority: 3,
     forward: [other, {{peer: base, max_rate: {rate}, on_change: true, at_least: 2s}}]}}
  - {{number: 2, name: mode, proto: Mode, topic: mode, direction: ros_to_base, send: {{at_least: {again}}}}}
"""


def _project(folder: Path, budget: str = "200 kB/s", rate: int = 5, again: str = "500ms") -> None:
    package = f"of_{folder.name}".lower()  # a process loads each package once
    write_project(_TABLE.format(package=package, budget=budget, rate=rate, again=again), folder)


@pytest.mark.slow
def test_generated_code_has_the_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plain name of a forward has none; the page of the messages tells them, and the ledger what peers rely on."""
    monkeypatch.chdir(tmp_path)
    _project(tmp_path)
    assert main(["generate"]) == 0
    registry = load_registry(tmp_path, f"of_{tmp_path.name}".lower())
    imu, mode = registry.by_name["imu"].route, registry.by_name["mode"].route
    assert (imu.forward, imu.priority) == (("other", "base"), 3)
    assert imu.forward_limits == (("base", SendLimits(max_rate=5, on_change=True, at_least_ms=2000)),)
    assert (mode.send, mode.forward_limits) == (SendLimits(at_least_ms=500), ())
    assert {peer.name: peer.budget for peer in registry.peers} == {"base": 200_000, "board": None, "other": None}
    ledger = (tmp_path / "mapping.lock").read_text()
    for line in ("1 Imu forward base max_rate: 5", "1 Imu forward base at_least: 2000ms", "2 Mode at_least: 500ms"):
        assert f"  {line}\n" in ledger
    page = next(tmp_path.rglob("messages.md")).read_text()
    assert "- **Forwarded** to base at most 5 messages a second, only changes, again after 2000 ms\n" in page
    assert "- **Sent** again after 500 ms\n" in page


def test_limits_that_peers_relied_on_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A forward that has become faster, and a repetition that has become slower, are TAB111."""
    monkeypatch.chdir(tmp_path)
    _project(tmp_path)
    assert main(["generate"]) == 0
    _project(tmp_path, rate=50, again="5s")
    capsys.readouterr()
    main(["lint"])
    said = capsys.readouterr().out
    assert "warning[TAB111] 'imu' has `forward base max_rate` '50'; it was published with '5'" in said
    assert "warning[TAB111] 'mode' has `at_least` '5000ms'; it was published with '500ms'" in said


@pytest.mark.parametrize(
    ("text", "rate"),
    [("200 kB/s", 200_000), ("1600kbit/s", 200_000), ("2 MB/s", 2_000_000), ("1001 B/s", 1_001)]
    + [(text, None) for text in ("200", "1 B/s", "9 bit/s", "2 GB/s", "1.5 kB/s", "2000 MB/s", "200 kb/s")],
)
def test_rates_of_data(text: str, rate: int | None) -> None:
    """Whole numbers of bytes or bits a second, with k and M; a rate that is no whole number of bytes is none."""
    assert DataRate(1_000, 1_000_000_000).read(text) == rate


def test_mistakes_have_their_places(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A rate without a unit, and forwards to a peer twice, to nobody, and to an unknown one."""
    monkeypatch.chdir(tmp_path)
    _project(tmp_path, budget="200")
    table = tmp_path / "mapping.yaml"
    table.write_text(table.read_text().replace("forward: [other,", "forward: [base, {max_rate: 5}, {peer: othr},"))
    assert main(["lint"]) == 1
    said = capsys.readouterr().out
    assert "is '200'; it must be from 1 kB/s to 1000 MB/s" in said
    assert "`forward` contains 'base' twice" in said
    assert "mapping.yaml:9:22: error[MAP105] an item of `forward` lacks the key 'peer'" in said
    table.write_text(
        table.read_text().replace("{max_rate: 5}, ", "").replace("[base, ", "[").replace("200}", "1 MB/s}")
    )
    assert main(["lint"]) == 1
    assert "mapping.yaml:9:23: error[TAB103] unknown peer 'othr'" in capsys.readouterr().out
