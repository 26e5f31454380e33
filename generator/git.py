"""Access to a git repository through the ``git`` program.

- Inside a git hook, the variable ``GIT_DIR`` overrides the folder that is passed to git. Such variables are removed.
- ``git ls-tree`` lists links and submodules too; only the modes 100644 and 100755 are files.
- A clone may lack objects (``--depth``, ``--filter``). In a partial clone, git fetches a missing blob when it is read.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from itertools import islice
from pathlib import Path

from roverlink.bounded_files import LARGEST, too_large
from roverlink.generator.source_files import visible

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
# git sets these variables for a hook (githooks(5)). They select the hook's repository; the folder may be in another.
_OF_A_HOOK = ("GIT_DIR", "GIT_WORK_TREE", "GIT_COMMON_DIR", "GIT_INDEX_FILE", "GIT_PREFIX")
_FILES = ("100644", "100755")  # modes of regular files; a link has 120000
SUBMODULE = "160000"
"""Mode of a submodule in a tree: its object id is a commit of another repository (gitsubmodules(7))."""
_LONGEST_SUBJECT = 60  # characters of a subject in a line for people; git's own advice for subjects is 50
_MAIN_BRANCHES = ("main", "master")
_BATCH = (
    256  # ids per request: 256 * 41 bytes fit into the pipe (64 KiB on Linux), so git and this process never both wait
)


class GitError(Exception):
    """Raised when git is not installed or reports an error; the text is git's error message."""


@dataclass(frozen=True, slots=True)
class Commit:
    """Id, date, author and subject of a commit, which diagnostics show."""

    id: str
    date: str
    """The author's date, such as ``2026-11-21``."""
    subject: str
    author: str = ""
    """The author's name."""

    def __str__(self) -> str:
        return f"{self.id[:10]} {self.date} {shortened(self.subject)}" if self.id else self.subject


@dataclass(frozen=True, slots=True)
class Repository:
    """A folder in a git repository. All paths that the methods take or return are relative to this folder."""

    folder: Path

    def exists(self) -> bool:
        """Return True if the folder is in a git repository, even if the repository has no commits."""
        try:
            self._run("rev-parse", "--git-dir")
        except GitError:
            return False
        return True

    def has(self, ref: str, path: str) -> bool:
        """Return True if a file exists in a commit. The ref may be a commit id, a branch or a tag."""
        try:
            self._run("cat-file", "-e", f"{ref}:./{path}")
        except GitError:
            return False
        return True

    def names(self) -> set[str]:
        """Return the names by which other projects may know the repository.

        These are the name of its folder, and the last part of each remote's address: ``rover`` for ``.../rover.git``.
        """
        folder = (self.folder / self._run("rev-parse", "--git-common-dir").strip()).resolve()
        remotes = [line.split()[1] for line in self._run("remote", "--verbose").splitlines()]
        addresses = [str(folder).removesuffix("/.git"), *remotes]
        return {name_of_repository(address) for address in addresses}

    def resolve(self, ref: str) -> str:
        """Return the full id of the commit that a ref names. Raises `GitError` if the ref names none."""
        # A ref may come from the command line. After --end-of-options git takes `-x` as a ref, not as an option
        # (gitcli(7)). `^{commit}` peels an annotated tag, and refuses a blob or a tree (gitrevisions(7)).
        return self._run("rev-parse", "--verify", "--quiet", "--end-of-options", f"{ref}^{{commit}}").strip()

    def commit(self, ref: str) -> Commit:
        """Return the commit that a ref names. Raises `GitError` if the ref names none."""
        # NUL, which no subject can contain, separates the fields. `%at` is the author's time: a rebase changes the
        # committer's.
        output = self._run("show", "--no-patch", "--format=%H%x00%at%x00%an%x00%s", self.resolve(ref)).rstrip("\n")
        return commit_of(*output.split("\0"))

    def since(self, base: str, tips: Iterable[str]) -> frozenset[str]:
        """Return the ids of the commits of ``tips`` and their ancestors, without ``base`` and its ancestors."""
        return frozenset(self._run("rev-list", *tips, f"^{base}").split())

    def in_order(self, commits: Iterable[str]) -> list[str]:
        """Return the ids of some commits, each one after its ancestors, and otherwise sorted by time."""
        wanted = sorted(set(commits))
        listed = self._run("rev-list", "--date-order", "--reverse", *wanted).split() if wanted else []
        return [id for id in listed if id in wanted]

    def prefix(self) -> str:
        """Return the folder's path in the repository with a slash at its end; empty for the top folder."""
        return self._run("rev-parse", "--show-prefix").removesuffix("\n")

    def in_commit(self, name: str) -> str:
        """Return the beginning of the names of a commit's files below the folder, such as ``main:protos``.

        ``name`` is a name of the commit. With a file's path, it is what ``git show`` takes.
        """
        return f"{name}:{self.prefix().rstrip('/')}"

    def entries(self, commit: str) -> list[tuple[str, str, str]]:
        """Return mode, object id and path of each file, link and submodule below the folder in a commit."""
        # -z: without it, git quotes a path with unusual characters (git-ls-tree(1), OUTPUT FORMAT).
        listed = self._run("ls-tree", "-r", "-z", "--full-name", commit, ".").split("\0")
        prefix = self.prefix()
        entries = (entry.split("\t", 1) for entry in listed if entry)
        return [(about.split()[0], about.split()[2], path.removeprefix(prefix)) for about, path in entries]

    def contents(
        self, entries: Iterable[tuple[str, str, str]], wanted: Callable[[str], bool]
    ) -> Iterator[tuple[str, bytes | str]]:
        """Yield path and content of those of the `entries` of a commit that ``wanted`` accepts by their path.

        Links and submodules are left out. Instead of a content that cannot be read, the reason is yielded, as a text.
        """
        paths = [(path, id) for mode, id, path in entries if mode in _FILES and wanted(path)]
        for (path, _), (_, data) in zip(paths, self.blobs([id for _, id in paths])):
            yield path, data

    def submodule_with(self, path: str, commit: str) -> Repository | None:
        """Return the repository of the submodule that was at ``path``, if it has the commit that was pinned there.

        A submodule that was moved since is found at its present path. Returns None if this clone has no such commit.
        """
        index = self._run("ls-files", "--stage", "-z").split("\0")
        today = [entry.partition("\t")[2] for entry in index if entry.startswith(SUBMODULE)]
        for place in dict.fromkeys([path, *today]):
            repository = Repository(self.folder / place)
            try:
                # Without a folder of its own, git would find the repository around it, which has other commits.
                if repository.resolve(commit):
                    return repository
            except GitError:
                continue
        return None

    def holds(self, commit: str, suffix: str) -> bool:
        """Return True if a file anywhere in a commit has a name with this end, or if it may be in a submodule."""
        listed = self._run("ls-tree", "-r", "-z", "--full-tree", commit).split("\0")
        return any(entry.endswith(suffix) or entry.startswith(SUBMODULE) for entry in listed)

    def branch_to_compare(self) -> str:
        """Return the branch into which changes are merged, such as ``origin/main``; empty if it is not known.

        It is the default branch of the remote ``origin`` or else of another one. Without a remote, it is a local
        branch: ``main``, ``master``, or else the current one, if it has a commit.
        """
        form = "--format=%(refname:lstrip=2) %(symref:lstrip=2)"
        try:
            remote = [line.split() for line in self._run("for-each-ref", form, "refs/remotes").splitlines()]
            local = [line.split()[0] for line in self._run("for-each-ref", form, "refs/heads").splitlines()]
            current = self._run("branch", "--show-current").strip()
        except GitError:
            return ""
        # `git clone` notes the default branch of a remote as origin/HEAD; `git remote add` does not.
        heads = [words[1] for words in remote if len(words) > 1]
        names = [words[0] for words in remote if len(words) == 1]
        likely = [*heads, *(f"{place}/{name}" for name in _MAIN_BRANCHES for place in _remotes(names)), *names[:1]]
        own = [*_MAIN_BRANCHES, current] if not names else []
        return next((name for name in (*likely, *own) if name in names or name in local), "")

    def blobs(self, ids: Sequence[str]) -> Iterator[tuple[str, bytes | str]]:
        """Yield id and content of blobs (file contents in git), in the order of ``ids``.

        Instead of a content that is missing in this clone, or larger than `LARGEST`, the reason is yielded, as a text.
        """
        if not ids:
            return
        try:
            git = subprocess.Popen(  # noqa: S603  # no shell
                command(self.folder, "cat-file", "--batch"),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=environment(),
            )
        except OSError as error:
            raise GitError(f"git cannot be run: {error.strerror}") from error
        with git:
            left = iter(ids)
            while batch := list(islice(left, _BATCH)):
                yield from _answers(git, batch)

    def commits_of_lines(self, path: str, commit: str | None = None) -> list[Commit | None]:
        """Return the commit that last changed each line of a file.

        ``commit`` selects an earlier state of the file. A line is None if its change is uncommitted. The list is empty
        if git cannot tell.
        """
        try:
            # A .gitattributes of a stranger must not select a program of the user's configuration (gitattributes(5)).
            output = self._run("blame", "--no-textconv", "--porcelain", *([commit] if commit else []), "--", path)
        except GitError:
            return []
        # Each line of the file has a head, which begins with the commit's id; then, where the commit is named for the
        # first time, lines that begin with a keyword; and a tab with the content (git-blame(1), THE PORCELAIN FORMAT).
        # The id of a line that is not committed yet consists of zeros.
        found: list[Commit | None] = []
        known: dict[str, Commit | None] = {}
        id, facts = "", dict[str, str]()
        for line in output.split("\n"):
            if line.startswith("\t"):
                if id not in known:
                    committed = id.strip("0") and "summary" in facts
                    about = (facts.get(word, "") for word in ("author-time", "author", "summary"))
                    known[id] = commit_of(id, *about) if committed else None
                found.append(known[id])
                id, facts = "", {}
            elif not id:
                id = line.partition(" ")[0]
            else:
                keyword, _, value = line.partition(" ")
                facts[keyword] = value
        return found

    def _run(self, *arguments: str, index: str = "") -> str:
        """Return what git prints. ``index`` is the path of another index file than the usual one."""
        variables = environment() | ({"GIT_INDEX_FILE": index} if index else {})
        try:
            # `git hash-object --stdin` would wait for what the user types.
            done = subprocess.run(  # noqa: S603  # no shell
                command(self.folder, *arguments),
                stdin=subprocess.DEVNULL,
                capture_output=True,
                check=False,
                env=variables,
            )
        except OSError as error:
            raise GitError(f"git cannot be run: {error.strerror}") from error
        if done.returncode:
            raise GitError(done.stderr.decode("utf-8", errors="replace").strip())
        return done.stdout.decode("utf-8", errors="replace")


def _answers(git: subprocess.Popen[bytes], ids: Sequence[str]) -> Iterator[tuple[str, bytes | str]]:
    assert git.stdin is not None, "it was asked for"  # noqa: S101  # for mypy
    assert git.stdout is not None, "it was asked for"  # noqa: S101  # for mypy
    try:
        git.stdin.write("".join(f"{id}\n" for id in ids).encode("ascii"))
        git.stdin.flush()
    except BrokenPipeError as error:
        raise GitError("git cat-file ended early") from error
    for id in ids:
        head = git.stdout.readline().split()
        if not head:
            raise GitError("git cat-file ended early")
        # The head is `<id> <type> <size>`, or `<id> missing` (git-cat-file(1), BATCH OUTPUT).
        if len(head) < 3:
            yield id, "it is missing in this clone"
            continue
        size = int(head[2])
        if size <= LARGEST:
            yield id, git.stdout.read(size + 1)[:-1]
            continue
        left = size + 1
        while left and (part := git.stdout.read(min(left, LARGEST))):  # in parts: a blob can be larger than the memory
            left -= len(part)
        yield id, too_large(size)


def _remotes(branches: Iterable[str]) -> list[str]:
    """Return the names of the remotes that have some branches, ``origin`` first."""
    return sorted({branch.partition("/")[0] for branch in branches}, key=lambda name: (name != "origin", name))


def command(folder: Path, *arguments: str) -> list[str]:
    """Return the command line that runs git in a folder."""
    # Files of a pull request can form a bare repository: HEAD, config, objects, refs. Without the option, git would use
    # that repository, and its config can name programs to run (git-config(1), safe.bareRepository; git 2.38 or later).
    return ["git", "-c", "safe.bareRepository=explicit", "-C", str(folder), *arguments]


def commit_of_line(commits: Sequence[Commit | None], line: int) -> Commit | None:
    """Return the commit of a line, which counts from 1, from the commits of all lines; None if it is not known."""
    return commits[line - 1] if 0 < line <= len(commits) else None


def name_of_repository(address: str) -> str:
    """Return the name of a repository: the last part of its address (a URL or a folder) without ``.git``."""
    return re.split(r"[/:]", address.rstrip("/"))[-1].removesuffix(".git")


def environment() -> dict[str, str]:
    """Return the environment variables for git, without those that git sets when it runs a hook."""
    return {name: value for name, value in os.environ.items() if name not in _OF_A_HOOK}


def commit_of(id: str, seconds: str, author: str, subject: str) -> Commit:
    """Return a commit, given its id, the author's time in seconds since 1970, the author's name, and its subject.

    Unprintable characters of the texts are escaped: a terminal might obey them, and XML forbids some.
    """
    return Commit(id, _date_of(seconds), visible(subject), visible(author))


def shortened(text: str, most: int = _LONGEST_SUBJECT) -> str:
    """Return a text with at most ``most`` characters; if something is cut off, it ends with ``…``."""
    return text if len(text) <= most else f"{text[: most - 1].rstrip()}…"


def _date_of(seconds: str) -> str:
    """Return the date of a Unix time as ``2026-11-21``; empty if Python cannot represent the date."""
    try:
        return (_EPOCH + timedelta(seconds=int(seconds))).date().isoformat()
    except (ValueError, OverflowError):
        return ""
