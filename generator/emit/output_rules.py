"""Rules for the steps that generate files and write them."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class CannotWrite(Rule, id="OUT101", severity=Severity.FATAL):
    """A generated file cannot be written or compared.

    A folder has the file's name, or the file system does not allow the access. No file is changed: either all files get
    their new text, or all keep the old one.

    Bad::

        generated/registry.py: fatal[OUT101] cannot write the file: Permission denied

    Good::

        $ chmod -R u+w generated
    """


class UnknownTarget(Rule, id="OUT102"):
    """No installed package provides a target of this name.

    A target is a generator of files, such as `python` or `ros2`. The name is misspelt, or the package that provides the
    target is not installed in this environment.

    Bad::

        targets: [python, ros3]

    Good::

        targets: [python, ros2]
    """


class TargetFailed(Rule, id="OUT103"):
    """A target from another package failed.

    A target is a generator of files, and other packages can add targets. The error message comes from the other
    package. The mistake is in its target, which usually assumes something that is not true for this table.

    Bad::

        mapping.yaml:9:11: error[OUT103] the target 'plots' of the package 'rover-plots' failed: KeyError: 'depth'

    Good::

        $ pip install --upgrade ./rover-plots
    """


class ForbiddenPath(Rule, id="OUT104"):
    """Two targets or templates write the same file, or one of them would write outside `generated/`.

    One generated file would replace the other, or it would replace a file that roverlink did not generate.

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
    """


class NoTemplates(Rule, id="OUT105"):
    """A folder that the table lists under `templates` does not exist, or contains no file that ends with `.j2`.

    Nothing would be rendered. The path is relative to the folder of mapping.yaml.

    Bad::

        templates: [report]

    Good::

        # mapping.yaml
        templates: [report]
        # report/list.txt.j2
        {{ bridge.table }}
    """


class TemplateFailed(Rule, id="OUT106"):
    """A template cannot be parsed or rendered.

    The template has a syntax error, or it uses an attribute that does not exist. (A misspelt attribute must not become
    an empty text in a generated file.) Templates run in Jinja's sandbox with limits on time, memory and output;
    forbidden operations and exceeded limits are also reported here.

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
    """


class ForeignTemplate(Rule, id="OUT107"):
    """A template cannot be read, or it is a link out of its template folder, or that folder is one out of the project.

    A symbolic link can lead to any file of the computer, whose text would then be in a generated file. Strangers can
    add such a link in a pull request. Links to hidden files such as `.git/config` are refused for the same reason. A
    pipe or a device could be endless, so only regular files of at most 8 MiB are read.

    Bad::

        $ ln -s /etc/passwd report/users.txt.j2

    Good::

        $ cp ~/users.txt.j2 report/users.txt.j2
    """


class ForeignFile(Rule, id="OUT108", severity=Severity.FATAL):
    """A generated file would replace a file that roverlink did not generate.

    Generated files carry a header with the line "Regenerate with: roverlink generate". Files without a header that your
    templates made are listed in mapping.lock. Any other file is never replaced, because its content would be lost. Move
    it to another place, or replace it with `roverlink generate --overwrite`. If you edit the envelope's .proto file
    yourself, write `owner: proto`: then roverlink only compares the file with the rows.

    Bad::

        docs/messages.md: fatal[OUT108] the file exists and was not generated

    Good::

        $ mv docs/messages.md docs/old-messages.md
    """


class OutsideTheProject(Rule, id="OUT109"):
    """A generated file would be outside the project, or inside its folder `.git`.

    Files are written only in the folder of mapping.yaml and below. A `root` that starts with `..`, or a symbolic link,
    leads to another place. If the .proto files are outside the project, the envelope belongs to another project: write
    `owner: proto`.

    Bad::

        ../protos/envelope.proto: error[OUT109] cannot write '../protos/envelope.proto': it is outside the project

    Good::

        $ roverlink init --from ../protos   # writes `owner: proto`
    """
