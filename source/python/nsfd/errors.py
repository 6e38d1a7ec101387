"""What can go wrong, as exceptions, and what the reader of scenes says."""

import re
from dataclasses import dataclass
from typing import Optional


@dataclass(frozen=True)
class Problem:
    """One message of the program about a scene.

    kind is "error", "warning" or "note"; file is the parameter file, the name of
    a Scene that is no file, or "settings"; line counts from 1, None if the message
    is about a whole file; entry is "Section/name", "name" at the top level, or the
    name of a section, None if it is not about one; text says what is wrong, advice
    what to write instead ("" if there is none)."""

    kind: str
    file: str
    line: Optional[int]
    entry: Optional[str]
    text: str
    advice: str = ""

    def __str__(self):
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        head = f"{place}: " if place else ""
        advice = f"\n  {self.advice}" if self.advice else ""
        return f"{head}{self.kind}: {self.text}{advice}"


class Error(Exception):
    """Of this package; every other one is derived from it."""


class InputError(Error):
    """The scene is not valid, and nothing was run. problems lists all that is
    wrong; file, line and entry are those of the first of them."""

    def __init__(self, report, problems=()):
        super().__init__(report)
        self.problems = list(problems)

    def _first(self, name):
        return getattr(self.problems[0], name) if self.problems else None

    @property
    def file(self):
        return self._first("file")

    @property
    def line(self):
        return self._first("line")

    @property
    def entry(self):
        return self._first("entry")


class FolderError(Error):
    """Results cannot be written to the folder, and nothing was run."""


class NotSolved(Error):
    """A step could not be solved, or only with energy from nothing. results are
    those up to there (of a study: its tables); worst names the face that was
    solved worst, None if the program names none."""

    def __init__(self, report, results):
        super().__init__(report)
        self.results = results
        found = re.search(r"worst face (?:at )?(.*?)(?:;|$)", report, re.MULTILINE)
        self.worst = found.group(1).strip() if found else None


class Stopped(Error):
    """The run was stopped by a signal of somebody else. results are those up to
    there, None if there was nothing yet; the same call with resume=True goes on."""

    def __init__(self, report, results):
        super().__init__(report)
        self.results = results


class ProgramError(Error):
    """The program is not there, or broke off: a full disk, a killed process, an
    internal error. exit_code is None if it did not start, and -9, for example,
    if signal 9 ended it."""

    def __init__(self, report, exit_code=None):
        super().__init__(report)
        self.exit_code = exit_code


SETTINGS = "settings"  # in the place of a file

_HEAD = re.compile(
    r"(?:(?P<file>.+?)(?::(?P<line>\d+))?: )??"
    r"(?P<kind>error|warning|note): (?P<text>.*)"
)
_EXCERPT = re.compile(r" *\d* \| (?P<code>.*)")
_MISSING = re.compile(r"`(.+)` is missing in (?:section `(.+)`|the top level)")


def read_problems(report, entry_at):
    """The list of Problem in what the program wrote to its standard error.
    entry_at(file, line) names the entry in a line of a parameter file."""
    problems = []
    lines = report.splitlines()
    for number, line in enumerate(lines):
        head = _HEAD.fullmatch(line)
        if not head:
            continue
        code, advice = None, []
        for following in lines[number + 1 :]:
            excerpt = _EXCERPT.fullmatch(following)
            if excerpt:
                code = excerpt["code"] if code is None else code
            elif following.startswith("  ") and not _HEAD.fullmatch(following):
                advice.append(following.strip())
            else:
                break
        file = head["file"] or ""
        place = int(head["line"]) if head["line"] else None
        missing = _MISSING.match(head["text"])
        if missing:
            entry = f"{missing[2]}/{missing[1]}" if missing[2] else missing[1]
        elif file == SETTINGS:
            entry = (code or "").partition("=")[0].strip() or None
        else:
            entry = entry_at(file, place) if place else None
        problems.append(
            Problem(head["kind"], file, place, entry, head["text"], " ".join(advice))
        )
    return problems
