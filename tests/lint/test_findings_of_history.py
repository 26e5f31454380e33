"""What a finding of history shows: one sentence, the declarations side by side with their commits, and no more."""

from __future__ import annotations

import json
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
_WINDY = {"e": ("Wind wind = 2;",), "wind": _WIND}
_COUNT = {"e": ("uint32 count = 2;",)}

Run = Callable[..., tuple[int, str, str]]


def _link(*members: str) -> str:
    types = {member.split()[0] for member in members}
    imports = "".join(f'import "{type.lower()}.proto";\n' for type in sorted(types & {"Gps", "Wind"}))
    return envelope("bool alive = 1;", *members).replace("\n\n", f"\n\n{imports}\n", 1)


class Link:
    """A repository whose envelope has lost the number 2, which was a GPS; once checked out, the current folder."""

    def __init__(self, root: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
        self.repository = RepositoryBuilder(root)
        self.run, self._monkeypatch = run, monkeypatch
        self.commit("Begin", e=("Gps gps = 2;",), gps=_GPS)
        self.commit(_SUBJECT, e=())

    def commit(self, subject: str, /, branch: str = "main", **files: Any) -> None:
        """Commit .proto files: `e` is the members of the envelope, the others are texts."""
        texts = {f"protos/{name}.proto": _link(*text) if name == "e" else text for name, text in files.items()}
        self.repository.commit(subject, texts, branch=branch)

    def check_out(self) -> Path:
        """Write the repository, and make it the current folder."""
        self._monkeypatch.chdir(self.repository.write())
        return self.repository.root

    def text(self, *arguments: str) -> str:
        """What `lint --history protos` prints of the envelope."""
        return self.run("lint", "--history", "protos", *_ENVELOPE, *arguments)[1]

    def found(self, *, rule: str = "HIS101", of: tuple[str, ...] = _ENVELOPE) -> list[dict[str, Any]]:
        """The findings of a rule."""
        found = json.loads(self.run("lint", "--history", "protos", *of, "--format", "json")[1])
        return [one for one in found if one["id"] == rule]


@pytest.fixture
def link(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> Link:
    """The repository."""
    return Link(tmp_path / "repository", run, monkeypatch)


# --- text ---


@pytest.mark.slow
def test_the_declarations_stand_side_by_side(link: Link) -> None:
    """One sentence, then both declarations in columns, with place, commit, date, author and a short subject.

    JSON has the whole subject, and the commits. Of many branches, three are named.
    """
    link.commit("Measure the wind", **_WINDY)
    first, second, third = reversed(git(link.check_out(), "log", "--format=%h", "--abbrev=10").split())
    out = link.text()
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
    of_number = link.run("number", "history", "2", "protos", *_ENVELOPE)[1]
    assert ("since the new b…" in of_number, _SUBJECT in out + of_number) == (True, False)
    for branch in "abc":
        link.repository.branch(branch)
    link.check_out()
    (found,) = link.found()
    gps, wind = found["history"]
    assert wind["today"] == "on the branches a, b, c and 1 more"
    assert (gps["last_subject"], gps["last_commit"][:10], wind["first_commit"][:10]) == (_SUBJECT, second, third)


class _Terminal(StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("columns", "stacked"), [("80", False), ("60", True)])
def test_a_narrow_terminal_gets_one_below_the_other(
    link: Link, monkeypatch: pytest.MonkeyPatch, columns: str, stacked: bool
) -> None:
    """The columns fit the terminal, or else the declarations stand one below the other."""
    link.commit("Measure the wind", **_WINDY)
    link.check_out()
    terminal = _Terminal()
    monkeypatch.setattr("sys.stdout", terminal)
    for name, value in {"COLUMNS": columns, "TERM": "xterm", "NO_COLOR": "1"}.items():
        monkeypatch.setenv(name, value)
    main(["lint", "--history", "protos", *_ENVELOPE])
    lines = terminal.getvalue().splitlines()
    shown = [line for line in lines if "Gps gps = 2;" in line or line.startswith("    ")]
    assert ("Wind wind = 2;" not in shown[0]) == stacked
    assert max(map(len, shown)) <= int(columns)


@pytest.mark.slow
def test_replaced_contents_show_the_fields_that_differ(link: Link) -> None:
    """Both contents of a message that kept its name, without the fields that both have, in rows of one number."""
    link.commit("Begin again", e=("Gps gps = 2;",))
    other = message("Gps", "string sentence", "bytes almanac", "bool differential", "float hdop", "sint32 leap")
    link.commit("Replace it", gps=other)
    link.check_out()
    (finding,) = (text for text in link.text().split("\n\n") if "HIS103" in text)
    lines = [" ".join(line.split()) for line in finding.splitlines()]
    assert lines[0].endswith(
        "number 2 of 'PBEnvelope' kept the name 'gps' (Gps), but the content of 'Gps' was replaced: 1 of 4 fields left"
    )
    assert lines[3:9] == [
        "message Gps { message Gps {",
        "double lat = 1; string sentence = 1;",
        "double lon = 2; bytes almanac = 2;",
        "uint32 satellites = 3; bool differential = 3;",
        "sint32 leap = 5;",
        "} }",
    ]
    (found,) = link.found(rule="HIS103")
    assert [(use["first_subject"], use.get("last_subject")) for use in found["history"]] == [
        ("Begin", "Replace it"),
        ("Replace it", None),
    ]


# --- doubts ---


def test_a_content_from_a_broken_file_is_a_doubt(link: Link) -> None:
    """What was compared was read from a file with errors: the declaration with this type is in doubt, and says why."""
    link.commit("Measure the wind", e=("Wind wind = 2;",), wind=_WIND.replace("bytes raw = 2", "bytes"))
    link.commit("Mend it", wind=_WIND)
    link.check_out()
    why = "the file of 'Wind' has syntax errors at this commit"
    assert {use["name"]: use["doubt"] for one in link.found() for use in one["history"]} == {"gps": None, "wind": why}
    assert f"in doubt: {why}\n" in link.text()


@pytest.mark.slow
def test_only_limits_of_the_envelope_concern_its_numbers(
    link: Link, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An unread version and an error of another file are no matter of a number; those of the envelope's file are."""
    link.commit("Be binary", gps=_GPS + "\0")
    link.commit("Be a text again", gps=_GPS)
    (link.check_out() / "protos" / "gps.proto").write_text("message {")
    asked = (("number", "history", "2", "protos", *_ENVELOPE), ("number", "next", "protos", *_ENVELOPE))
    assert ["[" in link.run(*words)[2] for words in asked] == [False, False]
    of_gps = link.run("number", "history", "Gps:1", "protos")[2]
    assert ("warning[STA106]" in of_gps, "error[PRO101]" in of_gps) == (True, True)
    binary, text = ({"protos/e.proto": text} for text in (_link() + "\0", _link("uint32 count = 1;")))
    monkeypatch.chdir(RepositoryBuilder(tmp_path / "other").commits(binary, text).write())
    for words in asked:
        assert "protos/e.proto: warning[STA106] some earlier versions of this file" in link.run(*words)[2]


# --- services beside the code ---


def _sarif(run: Run, *arguments: str) -> dict[str, Any]:
    (found,) = json.loads(run("lint", *arguments, "--format", "sarif")[1])["runs"]
    return dict(found)


def _prints(link: Link) -> dict[str, str]:
    results = _sarif(link.run, "--history", "protos", *_ENVELOPE)["results"]
    texts = [result["message"]["text"].partition("\n")[0] for result in results]
    prints = [result["partialFingerprints"]["primaryLocationLineHash"] for result in results]
    assert len(set(prints)) == len(prints)
    return dict(zip(texts, prints))


@pytest.mark.slow
def test_places_are_files_of_the_repository(link: Link, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever one calls it, paths start at the top of the repository, and each place is a file that exists."""
    link.commit("Measure the wind", **_WINDY)
    link.commit("Rename", wind=None, e=("Gps two = 2;",))
    root = link.check_out()
    (root / "elsewhere").mkdir()
    monkeypatch.chdir(root / "elsewhere")
    for state in ((), ("--against", "HEAD~1")):
        found = _sarif(link.run, "--history", "../protos", *_ENVELOPE, *state)
        places = [one for result in found["results"] for one in result["locations"]]
        places += [one for result in found["results"] for one in result.get("relatedLocations", ())]
        assert places
        for place in places:
            assert (root / place["physicalLocation"]["artifactLocation"]["uri"]).is_file()
            assert place["physicalLocation"]["region"]["startLine"] > 0
    _, out, _ = link.run("lint", "--history", "../protos", *_ENVELOPE, "--format", "github")
    assert "file=protos/e.proto,line=" in out
    assert all("file=protos/" in line for line in out.splitlines())


@pytest.mark.slow
def test_fingerprints_outlive_other_changes(link: Link) -> None:
    """Moved lines, other commits and other findings leave a fingerprint as it is; another meaning changes it."""
    link.commit("Measure the wind", **_WINDY)
    link.check_out()
    ((sentence, known),) = _prints(link).items()
    moved = {"protos/e.proto": "// A comment.\n\n" + _link("Wind wind = 2;")}
    link.repository.commit("Move it", {**moved, "protos/arm.proto": message("Arm", "int32 x")})
    link.commit("Swap", arm=message("Arm", "string text"))
    link.check_out()
    prints = _prints(link)
    assert (prints[sentence], len(prints)) == (known, 2)
    link.commit("Count", **_COUNT)
    link.check_out()
    assert known not in _prints(link).values()


def test_what_is_about_no_file_is_a_notification(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """GitHub refuses a document with a result without a file, so a fatal error about none is said of the run."""
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path)
    code, out, err = run("lint", "empty", "--format", "sarif")
    (found,) = json.loads(out)["runs"]
    (invocation,) = found["invocations"]
    (notification,) = invocation["toolExecutionNotifications"]
    assert (code, err, found["results"], invocation["executionSuccessful"]) == (2, "", [], False)
    assert (notification["descriptor"]["id"], notification["level"]) == ("STA103", "error")
    _, out, _ = run("lint", "empty", "--format", "github")
    assert out.startswith("::error title=STA103 no-protos::the folder contains no .proto file")


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
