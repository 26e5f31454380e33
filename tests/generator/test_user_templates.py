"""Hostile templates, as a pull request could bring them: each is one diagnostic, and nothing is written."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

import pytest
from golden import PROBE_PROTO, PROBE_TABLE, generate, snapshot

from roverlink.generator.diagnostics import DiagnosticsError, Span
from roverlink.generator.emit import user_templates
from roverlink.generator.emit.template_process import Limits
from roverlink.generator.ir.model import Bridge
from roverlink.generator.pipeline import compile_table

_TABLE = f"{PROBE_TABLE}targets: [ros2]\n"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with a folder for templates, beside a file that is none of its business."""
    (tmp_path / "secret.j2").write_text("the secret\n")
    folder = tmp_path / "project"
    for name in ("proto", "own"):
        (folder / name).mkdir(parents=True)
    (folder / "mapping.yaml").write_text(f"{_TABLE}templates: [own]\n")
    (folder / "proto" / "probe.proto").write_text(PROBE_PROTO)
    return folder


def _plant(project: Path, files: Mapping[str, str]) -> None:
    for path, text in files.items():
        (project / "own" / path).parent.mkdir(parents=True, exist_ok=True)
        (project / "own" / path).write_text(text)


def _refused(project: Path) -> str:
    """The only diagnostic of a run that writes nothing."""
    before = snapshot(project)
    outcome = generate(project)
    first, _, rest = outcome.stderr.partition("\n")
    assert (outcome.code, rest.splitlines()[-1]) == (1, "1 error; nothing was written")
    assert "error[" not in rest
    assert "the secret" not in outcome.stderr + outcome.stdout
    assert snapshot(project) == before
    return first


@pytest.fixture(scope="module")
def bridge(tmp_path_factory: pytest.TempPathFactory) -> Bridge:
    """The bridge that templates see."""
    folder = tmp_path_factory.mktemp("probe")
    (folder / "proto").mkdir()
    (folder / "mapping.yaml").write_text(_TABLE)
    (folder / "proto" / "probe.proto").write_text(PROBE_PROTO)
    return compile_table(folder / "mapping.yaml").bridge


def _not_rendered(project: Path, bridge: Bridge) -> str:
    """Why the templates of the folder cannot be rendered; of `_refused`, without what comes before and after."""
    with pytest.raises(DiagnosticsError) as caught:
        list(user_templates.emit(bridge, project, "own", Span("mapping.yaml")))
    said = str(caught.value)
    assert said.startswith("own/a.txt.j2:2: error[OUT106] cannot render the template: ")
    assert "the secret" not in said
    return said


@pytest.mark.slow
@pytest.mark.parametrize(
    "expression",
    [
        "bridge.__class__.__mro__[-1].__subclasses__()",
        'bridge | attr("__class__") | string',
        '[bridge] | map(attribute="__class__") | first',
        "bridge.conversions.__func__.__globals__",
        "cycler.__init__.__globals__.os.system('touch ran')",
        "self._TemplateReference__context.environment",
        'joiner()._Undefined__fail or "".__class__',
        '"{0.__class__.__init__.__globals__}".format(bridge)',
        '"{one.__class__}".format_map({"one": bridge})',
        '("{0.__class__}" | attr("format"))(bridge)',
        '["{0.__class__}".format] | map("string") | first | length and "{0.__class__}".format(header)',
        "bridge.modules.clear()",
        "[].append(1)",
    ],
)
def test_nothing_leads_from_the_bridge_to_pythons_internals(project: Path, bridge: Bridge, expression: str) -> None:
    """The sandbox refuses private attributes by whatever way they are asked for, and changes of what it is given."""
    _plant(project, {"a.txt.j2": f"{{{{ bridge.table }}}}\n{{{{ {expression} }}}}\n"})
    assert _not_rendered(project, bridge)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("{% for i in range(10**7) %}{% endfor %}", "Range too big"),
        ("{{ 2 ** (10 ** 9) }}", "the result of '**' would have more than 4096 bits"),
        ("{% for i in range(9999) %}{% for j in range(9999) %}{% endfor %}{% endfor %}", "the time limit is exceeded"),
        ("{% macro m() %}{{ m() }}{% endmacro %}{{ m() }}", "maximum recursion depth exceeded"),
        ("{% include 'a.txt.j2' %}", "maximum recursion depth exceeded"),
        (
            "{% for i in range(99999) %}{{ 'x' * 9999 }}{% endfor %}",
            "the templates of the folder produce too much text",
        ),
        ("{{ 'x' * 10 ** 10 }}", "the memory limit is exceeded"),
        ("{{ '%9999999999d' | format(1) }}", "the memory limit is exceeded"),
        ("{{ '{:9999999999}'.format(1) }}", "the memory limit is exceeded"),
        (
            "{% set n = namespace(s='x') %}{% for i in range(60) %}{% set n.s = n.s ~ n.s %}{% endfor %}",
            "the memory limit is exceeded",
        ),
    ],
)
def test_a_template_without_end_is_stopped(
    project: Path, bridge: Bridge, monkeypatch: pytest.MonkeyPatch, text: str, reason: str
) -> None:
    """Time, memory and output of a template are limited."""
    seconds = 1 if "time" in reason else 20  # the others are stopped by what they take
    monkeypatch.setattr(user_templates, "LIMITS", Limits(seconds=seconds, memory=1 << 28, output=1 << 20))
    monkeypatch.setattr(user_templates, "_WAIT_FACTOR", 60)  # on a busy machine, too, the process ends by itself
    _plant(project, {"a.txt.j2": f"\n{text}\n"})
    assert reason in _not_rendered(project, bridge)


@pytest.mark.slow
def test_a_template_that_fails_is_one_diagnostic(project: Path) -> None:
    """At its line, and nothing is written."""
    _plant(project, {"a.txt.j2": "{{ bridge.table }}\n{{ header.__globals__ }}\n"})
    assert _refused(project).startswith("own/a.txt.j2:2: error[OUT106] cannot render the template: ")


@pytest.mark.slow
def test_a_template_that_python_cannot_interrupt_is_killed(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A single operation that never ends is stopped too; only its line is not known."""
    monkeypatch.setattr(user_templates, "LIMITS", Limits(seconds=1))
    squares = "{% set n = namespace(n=7) %}{% for i in range(40) %}{% set n.n = n.n * n.n %}{% endfor %}"
    _plant(project, {"a.txt.j2": squares})
    assert "error[OUT106] cannot render the template" in _refused(project)


_OUTSIDE = ["../../secret.j2", "/etc/passwd", "a/../../../secret.j2", ".hidden/one", "link"]


@pytest.mark.parametrize(
    "statement",
    [
        *(f"include {name!r}" for name in _OUTSIDE),
        *("import '../../secret.j2' as one", "from '../../secret.j2' import one", "extends '../../secret.j2'"),
    ],
)
def test_a_template_reads_only_templates_of_its_folder(project: Path, bridge: Bridge, statement: str) -> None:
    """No template can include, import or extend a file outside the folder, or a hidden one."""
    _plant(project, {"a.txt.j2": f"\n{{% {statement} %}}\n", ".hidden/one": "the secret"})
    (project / "own" / "link").symlink_to(project.parent / "secret.j2")
    assert _not_rendered(project, bridge)


_NO_FILE = "own/users.txt.j2: error[OUT107] the link does not lead to a visible file inside the folder 'own'"


@pytest.mark.parametrize(
    ("link", "target", "said"),
    [
        *(("own/users.txt.j2", target, _NO_FILE) for target in ("/etc/passwd", "../../secret.j2", "missing")),
        *(("own/users.txt.j2", target, _NO_FILE) for target in ("../mapping.yaml", ".hidden/one")),
        ("own/links", "../..", "own/links: error[OUT107] the folder was not read: it is a link that leads out of the "),
        ("own", "..", "mapping.yaml:9:13: error[OUT107] the folder 'own' is a symbolic link that leads out of the "),
    ],
)
def test_a_link_out_of_the_folder_is_refused(project: Path, link: str, target: str, said: str) -> None:
    """The file or the folder that a link leads to is not even read; the table's own folder is no exception."""
    _plant(project, {".hidden/one": "the secret"})
    if link == "own":
        shutil.rmtree(project / link)
    elif link == "own/links":
        _plant(project, {"a.txt.j2": "{% include 'links/secret.j2' %}"})
    (project / link).symlink_to(target)
    assert _refused(project).startswith(said)


def test_a_template_whose_name_is_no_text_is_refused(project: Path) -> None:
    """Generated files and the ledger have names in UTF-8."""
    _plant(project, {os.fsdecode(b"l\xe4tin.txt.j2"): "the text"})
    assert _refused(project) == r"own/l\xe4tin.txt.j2: error[OUT107] the name of the template is not UTF-8"


@pytest.mark.parametrize("folder", ["..", "own/../..", "/etc"])
def test_the_table_names_no_folder_outside_the_project(project: Path, folder: str) -> None:
    """Only the command line may name a folder of templates outside the project."""
    (project / "mapping.yaml").write_text(f"{_TABLE}templates: ['{folder}']\n")
    assert _refused(project).startswith("mapping.yaml:9:13: error[")


@pytest.mark.slow
def test_nothing_is_written_through_a_link_out_of_the_project(project: Path) -> None:
    """A link in the place of the folder of output would put a template's text anywhere on the machine."""
    _plant(project, {"authorized_keys.j2": "mine"})
    outside = project.parent / "outside"
    outside.mkdir()
    (project / "generated").mkdir()
    (project / "generated" / "own").symlink_to(outside)
    said = "error[OUT109] cannot write 'generated/own/authorized_keys': a symbolic link in its path leads outside"
    assert said in _refused(project)
    assert not list(outside.iterdir())


@pytest.mark.slow
def test_templates_include_templates_of_their_folder(project: Path) -> None:
    """Parts that several share are files of the folder without the suffix, or links to such; a name may be hidden."""
    _plant(project, {"a.txt.j2": "{% include 'parts/one' %}{% include 'two' %}", "parts/one": "{{ bridge.table }}\n"})
    _plant(project, {".clang-format.j2": "Language: Cpp\n"})
    (project / "own" / "two").symlink_to("parts/one")
    assert generate(project).code == 0
    assert (project / "generated" / "own" / "a.txt").read_text() == "mapping.yaml\nmapping.yaml\n"
    assert (project / "generated" / "own" / ".clang-format").read_text() == "Language: Cpp\n"
