"""What a finding of history shows: one sentence, the declarations side by side with their commits, and no more."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from repositories import RepositoryBuilder, envelope, git, message

from roverlink.__main__ import main

_ENVELOPE = ("--message", "PBEnvelope")
_SUBJECT = "Remove the GPS, which nobody uses any more, since the new board sends the position on another bus"
_GPS = message("Gps", "double lat", "double lon", "uint32 satellites", "float hdop")
_WIND = message("Wind", "string direction", "bytes raw")

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def repository(tmp_path: Path) -> RepositoryBuilder:
    """A repository whose envelope has lost the number 2, which was a GPS."""
    built = RepositoryBuilder(tmp_path / "repository")
    built.commit("Begin", {"protos/e.proto": _link("Gps gps = 2;"), "protos/gps.proto": _GPS})
    built.commit(_SUBJECT, {"protos/e.proto": _link()})
    return built


def _link(*members: str) -> str:
    types = {member.split()[0] for member in members}
    imports = "".join(f'import "{type.lower()}.proto";\n' for type in sorted(types & {"Gps", "Wind"}))
    return envelope("bool alive = 1;", *members).replace("\n\n", f"\n\n{imports}\n", 1)


def _measure_the_wind(repository: RepositoryBuilder, *, branch: str = "main") -> None:
    files = {"protos/e.proto": _link("Wind wind = 2;"), "protos/wind.proto": _WIND}
    repository.commit("Measure the wind", files, branch=branch)


def _write(repository: RepositoryBuilder, monkeypatch: pytest.MonkeyPatch) -> Path:
    root = repository.write()
    git(root, "checkout", "--quiet", "--force", "main")
    monkeypatch.chdir(root)
    return root


def _found(run: Run, *arguments: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(run("lint", "--history", "protos", *arguments, "--format", "json")[1])
    return found


# --- text -------------------------------------------------------------------------------------------------------


def test_the_declarations_stand_side_by_side(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One sentence, then both declarations in columns, with place, commit, date, author and a short subject."""
    _measure_the_wind(repository)
    first, second, third = reversed(git(_write(repository, monkeypatch), "log", "--format=%h", "--abbrev=10").split())
    _, out, _ = run("lint", "--history", "protos", *_ENVELOPE)
    assert out.partition("  help: ")[0] == (
        "protos/e.proto:8:17: error[HIS101] number 2 of 'PBEnvelope' was given to 'wind' (Wind) after 'gps' (Gps) was "
        "removed: 'Wind' has 0 of the 4 fields of 'Gps'\n"
        "8 |     Wind wind = 2;\n"
        "  |                 ^\n"
        "  Gps gps = 2;                                      Wind wind = 2;\n"
        "    protos/e.proto:8                                  protos/e.proto:8\n"
        f"    since {first} 2026-02-03                       since {third} 2026-02-05\n"
        "      A B: Begin                                        A B: Measure the wind\n"
        f"    until {second} 2026-02-04                       now on the branch main\n"
        "      A B: Remove the GPS, which nobody uses any…\n"
    )


class _Terminal(StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("columns", "stacked"), [("80", False), ("60", True)])
def test_a_narrow_terminal_gets_one_below_the_other(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch, columns: str, stacked: bool
) -> None:
    """The columns fit the terminal, or else the declarations stand one below the other."""
    _measure_the_wind(repository)
    _write(repository, monkeypatch)
    terminal = _Terminal()
    monkeypatch.setattr("sys.stdout", terminal)
    for name, value in {"COLUMNS": columns, "TERM": "xterm", "NO_COLOR": "1"}.items():
        monkeypatch.setenv(name, value)
    main(["lint", "--history", "protos", *_ENVELOPE])
    lines = terminal.getvalue().splitlines()
    shown = [line for line in lines if "Gps gps = 2;" in line or line.startswith("    ")]
    assert ("Wind wind = 2;" not in shown[0]) == stacked
    assert max(map(len, shown)) <= int(columns)


def test_subjects_are_short_for_people_and_whole_for_scripts(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every command cuts a long subject; JSON keeps it."""
    _measure_the_wind(repository)
    _write(repository, monkeypatch)
    for command in (["history", "2", "protos"], ["lint", "--history", "protos"]):
        _, out, _ = run(*command, *_ENVELOPE)
        assert ("Remove the GPS, which nobody uses any…" in out) or ("since the new b…" in out)
        assert _SUBJECT not in out
    (found,) = _found(run, *_ENVELOPE)
    assert found["history"][0]["last_subject"] == _SUBJECT


def test_replaced_contents_show_the_fields_that_differ(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both contents of a message that kept its name, without the fields that both have, in rows of one number."""
    repository.commit("Begin again", {"protos/e.proto": _link("Gps gps = 2;")})
    other = message("Gps", "string sentence", "bytes almanac", "bool differential", "float hdop", "sint32 leap")
    repository.commit("Replace it", {"protos/gps.proto": other})
    _write(repository, monkeypatch)
    _, out, _ = run("lint", "--history", "protos", *_ENVELOPE)
    (finding,) = (text for text in out.split("\n\n") if "HIS103" in text)
    lines = [" ".join(line.split()) for line in finding.splitlines()]
    assert lines[0].endswith(
        "number 2 of 'PBEnvelope' kept the name 'gps' (Gps), but the content of 'Gps' was replaced: "
        "1 of 4 fields are left"
    )
    assert lines[3:9] == [
        "message Gps { message Gps {",
        "double lat = 1; string sentence = 1;",
        "double lon = 2; bytes almanac = 2;",
        "uint32 satellites = 3; bool differential = 3;",
        "sint32 leap = 5;",
        "} }",
    ]
    (found,) = (one for one in _found(run, *_ENVELOPE) if one["id"] == "HIS103")
    assert [(use["first_subject"], use.get("last_subject")) for use in found["history"]] == [
        ("Begin", "Replace it"),
        ("Replace it", None),
    ]


def test_each_of_several_reuses_has_its_reason(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three meanings are two changes, and each is explained."""
    _measure_the_wind(repository)
    repository.commit("Count", {"protos/e.proto": _link("uint32 count = 2;")})
    _write(repository, monkeypatch)
    (found,) = _found(run, *_ENVELOPE)
    assert found["message"] == (
        "number 2 of 'PBEnvelope' was given to 'wind' (Wind) after 'gps' (Gps) was removed: 'Wind' has 0 of the 4 "
        "fields of 'Gps'; it was given to 'count' (uint32) after 'wind' (Wind) was removed: a receiver of uint32 "
        "misreads message"
    )
    assert [use["declaration"] for use in found["history"]] == ["Gps gps = 2;", "Wind wind = 2;", "uint32 count = 2;"]


def test_values_and_labels_are_written_as_in_a_file(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A value of an enum has no type, and a list is called repeated."""
    start = 'syntax = "proto3";\nenum Mode { MODE_OFF = 0; %s }\nmessage Arm { %s }\n'
    repository.commit("One", {"protos/arm.proto": start % ("MODE_DRIVE = 1;", "repeated int32 x = 1;")})
    repository.commit("Two", {"protos/arm.proto": start % ("MODE_SHUTDOWN = 1;", "int32 x = 1;")})
    _write(repository, monkeypatch)
    found = {one["message_type"]: one for one in _found(run)}
    assert [use["declaration"] for use in found["Mode"]["history"]] == ["MODE_DRIVE = 1;", "MODE_SHUTDOWN = 1;"]
    assert "number 1 of 'Arm' was `repeated int32 x = 1;` and became `int32 x = 1;`: " in found["Arm"]["message"]


def test_branches_are_named(repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Meanings on two branches are said with their branches; a remote copy of a branch is not named beside it."""
    repository.branch("wind")
    repository.branch("side/count")
    _measure_the_wind(repository, branch="wind")
    repository.remote_branch("wind")
    repository.commit("Count", {"protos/e.proto": _link("uint32 count = 2;")}, branch="side/count")
    _write(repository, monkeypatch)
    found = next(one for one in _found(run, *_ENVELOPE) if one["id"] == "HIS101")
    assert "it is 'wind' (Wind) on the branch wind and 'count' (uint32) on the branch side/count: " in found["message"]
    _, out, _ = run("history", "2", "protos", *_ENVELOPE)
    assert [line.strip() for line in out.splitlines() if "exists" in line] == [
        "exists on the branch wind",
        "exists on the branch side/count",
    ]


def test_what_is_staged_is_in_the_index(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A change that is not committed yet is said to be none, and where it is."""
    root = _write(repository, monkeypatch)
    (root / "protos" / "e.proto").write_text(_link("uint32 count = 2;"))
    git(root, "add", "--all")
    found = next(one for one in _found(run, *_ENVELOPE) if one["id"] == "HIS101")
    assert found["history"][1]["today"] == "in the index, not committed yet"
    _, out, _ = run("lint", "--history", "protos", *_ENVELOPE)
    assert "now in the index, not committed yet" in out
    assert run("history", "2", "protos", *_ENVELOPE)[1].endswith("  exists in the index, not committed yet\n")


def test_another_state_shows_its_lines(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The source line is that of the ref, whatever the file on disk contains."""
    _measure_the_wind(repository)
    root = _write(repository, monkeypatch)
    (root / "protos" / "e.proto").write_text("// nothing\n" * 20)
    _, out, _ = run("lint", "protos", "--history", "main", *_ENVELOPE)
    assert "protos/e.proto:8:17: error[HIS101]" in out
    assert "\n8 |     Wind wind = 2;\n" in out


# --- doubts -----------------------------------------------------------------------------------------------------


def _doubts(found: list[dict[str, Any]]) -> dict[str, str | None]:
    return {use["name"]: use["doubt"] for one in found if one["id"] == "HIS101" for use in one["history"]}


def test_a_broken_state_that_is_no_evidence_is_no_doubt(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A state with syntax errors between two sound ones that declare the same does not make the finding doubtful."""
    _measure_the_wind(repository)
    broken = _link("Wind wind = 2;").replace("Wind wind = 2;", "Wind wind = 2;\n    Imu imu 3")
    repository.commit("Break it", {"protos/e.proto": broken, "protos/other.proto": "message {"})
    repository.commit("Mend it", {"protos/e.proto": _link("Wind wind = 2;"), "protos/other.proto": None})
    _write(repository, monkeypatch)
    assert _doubts(_found(run, *_ENVELOPE)) == {"gps": None, "wind": None}


def test_a_content_from_a_broken_file_is_a_doubt(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was compared was read from a file with errors: the declaration with this type is in doubt, and says why."""
    files = {"protos/e.proto": _link("Wind wind = 2;"), "protos/wind.proto": _WIND.replace("bytes raw = 2", "bytes")}
    repository.commit("Measure the wind", files)
    repository.commit("Mend it", {"protos/wind.proto": _WIND})
    _write(repository, monkeypatch)
    why = "the file of 'Wind' has syntax errors at this commit"
    assert _doubts(_found(run, *_ENVELOPE)) == {"gps": None, "wind": why}
    assert f"in doubt: {why}\n" in run("lint", "--history", "protos", *_ENVELOPE)[1]


# --- notices about other files ------------------------------------------------------------------------------------


def test_only_limits_of_the_envelope_concern_its_numbers(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An unread version and an error of another file are no matter of a number; those of the envelope's file are."""
    repository.commit("Be binary", {"protos/gps.proto": _GPS + "\0"})
    repository.commit("Be a text again", {"protos/gps.proto": _GPS})
    root = _write(repository, monkeypatch)
    (root / "protos" / "gps.proto").write_text("message {")
    asked = (("history", "2", "protos", *_ENVELOPE), ("next-number", "protos", *_ENVELOPE))
    assert ["[" in run(*words)[2] for words in asked] == [False, False]
    of_gps = run("history", "Gps:1", "protos")[2]
    assert ("warning[STA106]" in of_gps, "error[PRO101]" in of_gps) == (True, True)
    repository = RepositoryBuilder(root.parent / "other")
    repository.commit("Begin", {"protos/e.proto": _link() + "\0"})
    repository.commit("Be a text", {"protos/e.proto": _link("uint32 count = 1;")})
    _write(repository, monkeypatch)
    for words in asked:
        assert "protos/e.proto: warning[STA106] some earlier versions of this file" in run(*words)[2]


# --- services beside the code -------------------------------------------------------------------------------------


def _sarif(run: Run, *arguments: str | Path) -> dict[str, Any]:
    log = json.loads(run("lint", *arguments, "--format", "sarif")[1])
    (found,) = log["runs"]
    run_of_tool: dict[str, Any] = found
    return run_of_tool


def _prints(found: dict[str, Any]) -> dict[str, str]:
    prints = {
        result["message"]["text"].partition("\n")[0]: result["partialFingerprints"]["primaryLocationLineHash"]
        for result in found["results"]
    }
    assert len(set(prints.values())) == len(found["results"])
    return prints


def test_places_are_files_of_the_repository(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever one calls it, paths start at the top of the repository, and each place is a file that exists."""
    _measure_the_wind(repository)
    repository.commit("Rename", {"protos/wind.proto": None, "protos/e.proto": _link("Gps two = 2;")})
    root = _write(repository, monkeypatch)
    (root / "elsewhere").mkdir()
    monkeypatch.chdir(root / "elsewhere")
    for state in ((), ("--against", "HEAD~1")):
        found = _sarif(run, "--history", "../protos", *_ENVELOPE, *state)
        places = [one for result in found["results"] for one in result["locations"]]
        places += [one for result in found["results"] for one in result.get("relatedLocations", ())]
        assert places
        for place in places:
            assert (root / place["physicalLocation"]["artifactLocation"]["uri"]).is_file()
            assert place["physicalLocation"]["region"]["startLine"] > 0
    _, out, _ = run("lint", "--history", "../protos", *_ENVELOPE, "--format", "github")
    assert "file=protos/e.proto,line=" in out
    assert all("file=protos/" in line for line in out.splitlines())


def test_fingerprints_outlive_other_changes(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Moved lines, other commits and other findings leave a fingerprint as it is; another meaning changes it."""
    _measure_the_wind(repository)
    _write(repository, monkeypatch)
    ((sentence, known),) = _prints(_sarif(run, "--history", "protos", *_ENVELOPE)).items()
    moved = "// A comment.\n\n" + _link("Wind wind = 2;")
    repository.commit("Move it", {"protos/e.proto": moved, "protos/arm.proto": message("Arm", "int32 x")})
    repository.commit("Swap", {"protos/arm.proto": message("Arm", "string text")})
    _write(repository, monkeypatch)
    prints = _prints(_sarif(run, "--history", "protos", *_ENVELOPE))
    assert (prints[sentence], len(prints)) == (known, 2)
    repository.commit("Count", {"protos/e.proto": _link("uint32 count = 2;")})
    _write(repository, monkeypatch)
    assert known not in _prints(_sarif(run, "--history", "protos", *_ENVELOPE)).values()


def test_what_is_about_no_file_is_a_notification(
    repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """GitHub refuses a document with a result without a file, so a fatal error about none is said of the run."""
    _write(repository, monkeypatch)
    os.mkdir("empty")
    code, out, err = run("lint", "empty", "--format", "sarif")
    assert (code, err) == (2, "")
    (found,) = json.loads(out)["runs"]
    assert found["results"] == []
    (invocation,) = found["invocations"]
    assert invocation["executionSuccessful"] is False
    (notification,) = invocation["toolExecutionNotifications"]
    assert (notification["descriptor"]["id"], notification["level"]) == ("STA103", "error")
    _, out, _ = run("lint", "empty", "--format", "github")
    assert out.startswith("::error title=STA103 no-protos::the folder contains no .proto file")


def test_a_fatal_error_shows_its_file(repository: RepositoryBuilder, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """The path is right from the current folder, wherever the command line names the proto root."""
    root = _write(repository, monkeypatch)
    (root / "protos" / "e.proto").write_text(_link("uint32 = 2;"))
    for words in (["lint", "--history", "protos"], ["lint", "protos"]):
        code, out, _ = run(*words, "--message", "Nobody")
        assert (code, "protos/e.proto:7:" in out, "7 |     uint32 = 2;\n" in out) == (2, True, True)


@pytest.mark.parametrize("format", ["text", "json", "github", "sarif", "junit"])
def test_a_fatal_error_comes_in_the_chosen_format(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, format: str
) -> None:
    """What stops the lint is printed as any other finding, and nothing else is."""
    (tmp_path / "mapping.yaml").write_text("version: 1\nproto: {root: proto\n")
    monkeypatch.chdir(tmp_path)
    code, out, err = run("lint", "--format", format)
    assert (code, err) == (2, "")
    assert "YML" in out or "cannot parse the YAML" in out
    if format in ("json", "sarif"):
        json.loads(out)
