"""Rules for the steps that generate files and write them."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

CANNOT_WRITE = Rule(
    "OUT101",
    "cannot-write",
    """A generated file cannot be written or compared.

A folder has the file's name, or the file system does not allow the access. Files that were written before are kept.

Bad::

    generated/registry.py: fatal[OUT101] cannot write the file: Permission denied

Good::

    $ chmod -R u+w generated
""",
    Severity.FATAL,
)

UNKNOWN_TARGET = Rule(
    "OUT102",
    "unknown-target",
    """No installed package provides a target of this name.

The name is misspelt, or the package that provides the target is not installed in this environment.

Bad::

    targets: [python, ros3]

Good::

    targets: [python, ros2]
""",
)

TARGET_FAILED = Rule(
    "OUT103",
    "target-failed",
    """A target from another package failed.

The message comes from that package. The mistake is in the target; usually the target assumes something that is not true
for this table.

Bad::

    mapping.yaml:9:11: error[OUT103] the target 'plots' of the package 'rover-plots' failed: KeyError: 'depth'

Good::

    $ pip install --upgrade rover-plots
""",
)

FORBIDDEN_PATH = Rule(
    "OUT104",
    "forbidden-path",
    """Two targets or templates write the same file, or one would write outside `generated/`.

One file would replace the other, or a hand-written file.

Bad::

    # mapping.yaml
    templates: [arm/reports, drive/reports]
    # arm/reports/list.txt.j2
    {{ bridge.table }}
    # drive/reports/list.txt.j2
    {{ bridge.table }}

Good::

    # mapping.yaml
    templates: [arm/reports]
    # arm/reports/list.txt.j2
    {{ bridge.table }}
""",
)

NO_TEMPLATES = Rule(
    "OUT105",
    "no-templates",
    """A folder under `templates` does not exist, or contains no file that ends with `.j2`.

Nothing would be rendered. The path is relative to the folder of mapping.yaml.

Bad::

    templates: [report]

Good::

    # mapping.yaml
    templates: [report]
    # report/list.txt.j2
    {{ bridge.table }}
""",
)

TEMPLATE_FAILED = Rule(
    "OUT106",
    "template-failed",
    """A template cannot be parsed or rendered.

The template has a syntax error, or it uses an attribute that does not exist. (A misspelt attribute must not become an
empty text in a generated file.) Templates run in Jinja's sandbox with limits on time, memory and output; forbidden
operations and exceeded limits are also reported here.

Bad::

    # mapping.yaml
    templates: [report]
    # report/list.txt.j2
    {{ bridge.tabel }}

Good::

    # mapping.yaml
    templates: [report]
    # report/list.txt.j2
    {{ bridge.table }}
""",
)

FOREIGN_TEMPLATE = Rule(
    "OUT107",
    "foreign-template",
    """A template is not a file of its folder, or the folder is not in the project.

A link can lead to any file of the computer, whose text would then be in a generated file. Templates also come with pull
requests from strangers. Links out of the folder are therefore refused, and links to hidden files such as `.git/config`.

Bad::

    $ ln -s /etc/passwd report/users.txt.j2

Good::

    $ cp ~/users.txt.j2 report/users.txt.j2
""",
)
