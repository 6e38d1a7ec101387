"""Parameter files as sections of entries, which can be read and changed."""

import contextlib
import numbers
import os
import tempfile
from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_DEEPEST = 20  # includes in includes, as in the program


@dataclass(frozen=True)
class _Statement:
    """An entry, or the begin of a section if name is None. Lines count from 0;
    first and last are those of the file in which it stands, included_from is
    that file unless it is the scene's own."""

    section: str  # "" at the top level
    name: str
    value: str
    first: int
    last: int
    included_from: str = ""


def _collapsed(text):
    return " ".join(text.split())


def _section_name(name):
    """'Interface :  midline' to 'Interface: midline', as the program does."""
    kind, colon, block = name.partition(":")
    return f"{_collapsed(kind)}: {_collapsed(block)}" if colon else _collapsed(name)


def _split_lines(text):
    """Lines as the program counts them, which str.splitlines() does not."""
    lines = text.split("\n")
    return lines if lines[-1] else lines[:-1]


def _words(statement):
    """The keyword in small letters, and the rest; no keyword is ("", "")."""
    word, _, rest = statement.replace("\t", " ").partition(" ")
    known = word in (word.lower(), word.upper())
    return (word.lower(), rest.strip()) if known else ("", "")


def _joined_lines(lines):
    """(text, first, last) of each statement: without comments, lines that end
    with a backslash joined with the next one."""
    parts, first = [], 0
    for number, line in enumerate(lines):
        code, comment, _ = line.partition("#")
        code = code.strip()
        if not code and comment and parts:
            continue
        if not parts:
            first = number
        goes_on = code.endswith("\\")
        parts.append(code[:-1].strip() if goes_on else code)
        if not goes_on:
            yield " ".join(filter(None, parts)), first, number
            parts = []
    if parts:
        yield " ".join(filter(None, parts)), first, len(lines) - 1


def _statements(lines, folder, section="", files=()):
    """Those of a file and of the files that it includes. What is no statement
    is left to the program, whose message names its line."""
    for text, first, last in _joined_lines(lines):
        word, rest = _words(text)
        file = files[-1] if files else ""
        if word == "subsection":
            section = _section_name(rest)
            yield _Statement(section, None, None, first, last, file)
        elif word == "end":
            section = ""
        elif word == "set" and "=" in rest:
            name, _, value = rest.partition("=")
            yield _Statement(
                section, _collapsed(name), value.strip(), first, last, file
            )
        elif word == "include" and rest and len(files) < _DEEPEST:
            path = Path(folder, rest)
            if path.is_file() and str(path) not in files:
                yield from _statements(
                    _split_lines(_read(path)), path.parent, section, (*files, str(path))
                )


def value_text(value):
    """A value as it stands in a file: text as it is, numbers with all of their
    digits, true or false, lists with commas. Raises TypeError or ValueError."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value).strip()
        if "\n" in text or "#" in text or text.endswith("\\"):
            raise ValueError(
                f"the value {text!r} cannot stand in a line: leave out line breaks, "
                "# and a backslash at the end"
            )
        return text
    if isinstance(value, (list, tuple, np.ndarray)):
        return ", ".join(value_text(part) for part in value)
    raise TypeError(
        f"{value!r} is no value of an entry: write a text such as '40 us', a number, "
        "True, False, or a list of them"
    )


def flat_entries(settings):
    """(path, text) of each entry of {"Time": {"end": "1 ms"}, "dimension": 2} or
    {"Time/end": "1 ms"}."""
    for path, value in settings.items():
        if isinstance(value, Mapping):
            for name, part in value.items():
                yield f"{_section_name(path)}/{_collapsed(name)}", value_text(part)
        else:
            yield path, value_text(value)


class Section(MutableMapping):
    """The entries of one section of a scene, as text by name."""

    def __init__(self, scene, name):
        self._scene, self._name = scene, name

    def _entries(self):
        return self._scene._entries(self._name)

    def __getitem__(self, name):
        return self._scene._get(self._name, _collapsed(name))

    def __setitem__(self, name, value):
        self._scene._set(self._name, _collapsed(name), value_text(value))

    def __delitem__(self, name):
        self._scene._delete(self._name, _collapsed(name))

    def __iter__(self):
        return iter(self._entries())

    def __len__(self):
        return len(self._entries())

    def __repr__(self):
        return repr({name: entry.value for name, entry in self._entries().items()})


class Scene(MutableMapping):
    """A parameter file: Scene(path), Scene(text) or Scene({"Time": {"end": "1 ms"}}).

    scene["Time/end"] is the text of an entry, scene["dimension"] that of one at
    the top level, scene["Time"] all entries of a section; each may be set and
    deleted. What is not changed stays as it is, comments included. Entries of
    files that the scene includes can be read, not changed.

    Names of files in the scene are relative to folder: that of the file, or for
    texts and dictionaries the current one. A str with a line break is a text,
    any other one a path. name is what messages and the folder of results call
    the scene."""

    def __init__(self, source="", folder=None, name=None):
        self.path = None
        if isinstance(source, Scene):
            self.path, lines = source.path, source._lines
            folder, name = folder or source.folder, name or source.name
        elif isinstance(source, Mapping):
            lines = []
        elif isinstance(source, str) and ("\n" in source or not source.strip()):
            lines = _split_lines(source)
        else:
            self.path = Path(source)
            lines = _split_lines(_read(self.path))
        own_folder = self.path.parent if self.path else Path()
        self.folder = own_folder if folder is None else Path(folder)
        self.name = name or (self.path.stem if self.path else "scene")
        self._lines = list(lines)
        if isinstance(source, Mapping) and not isinstance(source, Scene):
            self.update(source)

    @property
    def text(self):
        return "".join(line + "\n" for line in self._lines)

    def save(self, path):
        """Writes the text to a file and returns its path. Names of files in the
        scene are then relative to the folder of this one."""
        path = Path(path)
        path.write_bytes(self.text.encode("utf-8", "surrogateescape"))
        return path

    def to_dict(self):
        """All entries as text: {"dimension": "2", "Time": {"end": "1 ms"}}."""
        top, sections = {}, {}
        for one in self._statements():
            entries = sections.setdefault(one.section, {}) if one.section else top
            if one.name is not None:
                entries.setdefault(one.name, one.value)
        return {**top, **sections}

    def entry_at(self, line):
        """The path of the entry, or the name of the section, that stands in a
        line (from 1) of the scene's own text; None if there is neither."""
        for one in self._statements():
            if not one.included_from and one.first < line <= one.last + 1:
                return _path(one)
        return None

    def is_study(self):
        """True for a scene that nsfd.study runs as it is."""
        kinds = {one.section.partition(":")[0] for one in self._statements()}
        return bool(kinds & {"Study", "Vary"})

    @contextlib.contextmanager
    def as_file(self):
        """The path of a file with this scene, from where the names of files in
        it are found: its own if it is unchanged, else one that is there until
        the end of the block."""
        if self._is_file():
            yield self.path
            return
        try:
            stream = tempfile.NamedTemporaryFile(
                dir=self.folder, prefix=".nsfd_", suffix=".prm"
            )
        except OSError as error:
            raise OSError(
                error.errno,
                f"the scene {self.name!r} is handed over as a file in "
                f"'{self.folder}', because names in it are relative to that folder, "
                f"and no file can be written there: give Scene another folder, or "
                "save() the scene and run that file",
            ) from error
        with stream:
            stream.write(self.text.encode("utf-8", "surrogateescape"))
            stream.flush()
            yield Path(stream.name)

    def _is_file(self):
        """True if the file at path says what this scene says."""
        return (
            self.path is not None
            and self.path.parent == self.folder
            and self.path.is_file()
            and _split_lines(_read(self.path)) == self._lines
        )

    def _statements(self):
        return list(_statements(self._lines, self.folder))

    def _entries(self, section):
        """Of a section, by name; the first counts, as a second is refused."""
        entries = {}
        for one in self._statements():
            if one.section == section and one.name is not None:
                entries.setdefault(one.name, one)
        return entries

    def _sections(self):
        """The begin of each section by its name, in the order of the file."""
        begins = {}
        for one in self._statements():
            if one.name is None:
                begins.setdefault(one.section, one)
        return begins

    def _split(self, path):
        """Section and name; name is None if the path is that of a section."""
        sections = self._sections()
        if _section_name(path) in sections:
            return _section_name(path), None
        # names of blocks may hold a slash, as those of entries of Vary do
        at = [k for k, letter in enumerate(path) if letter == "/"]
        known = [k for k in at if _section_name(path[:k]) in sections]
        if known or at:
            cut = max(known) if known else at[0 if path.startswith("Vary:") else -1]
            return _section_name(path[:cut]), _collapsed(path[cut + 1 :])
        return "", _collapsed(path)

    def __getitem__(self, path):
        section, name = self._split(path)
        return Section(self, section) if name is None else self._get(section, name)

    def __setitem__(self, path, value):
        section, name = self._split(path)
        if isinstance(value, Mapping):
            self._replace(_section_name(path), value)
        elif name is None:
            raise TypeError(
                f"{path!r} is a section: write a dictionary of its entries, or name "
                f"one of them: '{path}/{next(iter(self[path]), 'name')}'"
            )
        else:
            self._set(section, name, value_text(value))

    def __delitem__(self, path):
        section, name = self._split(path)
        if name is not None:
            self._delete(section, name)
            return
        begin = self._sections()[section]
        for one in [begin, *self._entries(section).values()]:
            _refuse_included(one)
        del self._lines[begin.first : self._end_of(begin) + 1]

    def __iter__(self):
        return iter([*self._entries(""), *self._sections()])

    def __len__(self):
        return len(list(iter(self)))

    def __repr__(self):
        return f"<Scene {self.name}: {', '.join(self)}>"

    def _end_of(self, begin):
        """The line that ends a section, or the last one."""
        for text, first, _ in _joined_lines(self._lines):
            if first > begin.last and _words(text)[0] == "end":
                return first
        return len(self._lines) - 1

    def _get(self, section, name):
        entries = self._entries(section)
        if name not in entries:
            here = f"section {section!r}" if section else "the top level"
            known = ", ".join([*entries, *([] if section else self._sections())])
            raise KeyError(f"there is no {name!r} in {here}; there are: {known}")
        return entries[name].value

    def _delete(self, section, name):
        self._get(section, name)  # or say what there is
        one = self._entries(section)[name]
        _refuse_included(one)
        del self._lines[one.first : one.last + 1]

    def _replace(self, section, entries):
        """In its place: of several blocks the first one that holds counts."""
        if section not in self._sections():
            self._lines += [f"subsection {section}", "end"]
        new = {_collapsed(name): value_text(value) for name, value in entries.items()}
        for old in set(self._entries(section)) - set(new):
            self._delete(section, old)
        for name, text in new.items():
            self._set(section, name, text)

    def _set(self, section, name, text):
        entries = self._entries(section)
        if name in entries:
            one = entries[name]
            _refuse_included(one)
            left, equals, _ = self._lines[one.first].partition("=")
            if not equals:  # in a line that goes on
                left = f"{'  ' if section else ''}set {name} "
            line = f"{left}= {text}"
            code, mark, comment = self._lines[one.last].partition("#")
            if mark:  # stays in its column, where there is room
                line = f"{line:<{len(code) - 1}} #{comment}"
            self._lines[one.first : one.last + 1] = [line]
            return
        if not section:
            own = [one for one in self._statements() if not one.included_from]
            at = max((one.last + 1 for one in own if not one.section), default=None)
            if at is None:
                at = min((one.first for one in own), default=len(self._lines))
            self._lines.insert(at, f"set {name} = {text}")
            return
        if section not in self._sections():
            self._lines += [f"subsection {section}", "end"]
        begin = self._sections()[section]
        _refuse_included(begin)
        self._lines.insert(self._end_of(begin), f"  set {name} = {text}")


def _path(statement):
    if statement.name is None:
        return statement.section
    if not statement.section:
        return statement.name
    return f"{statement.section}/{statement.name}"


def _refuse_included(statement):
    if statement.included_from:
        raise ValueError(
            f"{_path(statement)!r} stands in '{statement.included_from}', which the "
            "scene includes: change it there, or for one run with a setting of nsfd.run"
        )


def _read(path):
    try:
        return path.read_bytes().decode("utf-8", "surrogateescape")
    except FileNotFoundError:
        raise FileNotFoundError(
            f"there is no parameter file '{path}': check the name and the current "
            "folder; a text of a scene has line breaks"
        ) from None
