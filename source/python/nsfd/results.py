"""Runs, and the results in their folders."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Optional

from .errors import NotSolved, Stopped
from .fields import read_series
from .program import NOT_SOLVED, STOPPED, Call, call_program
from .scene import Scene
from .table import read_table


@dataclass(frozen=True)
class CertificateLine:
    """verdict is "ok", "not ok", "none" (the run has no such quantity) or "not
    measured"; value and bound are None where there are none."""

    name: str
    verdict: str
    value: Optional[float] = None
    bound: Optional[float] = None
    remark: str = ""

    @property
    def ok(self):
        return self.verdict in ("ok", "none")


class Certificate(Sequence):
    """The lines of a certificate, by number or name; ok if all of them are."""

    def __init__(self, data):
        self.ok = bool(data.get("ok", False))
        self.verdict = data.get("verdict", "there is no certificate")
        lines = data.get("lines", {})
        self._lines = [CertificateLine(name, **line) for name, line in lines.items()]

    def __getitem__(self, which):
        if isinstance(which, str):
            for line in self._lines:
                if line.name == which:
                    return line
            known = ", ".join(line.name for line in self._lines)
            raise KeyError(f"there is no line {which!r}; there are {known}")
        return self._lines[which]

    def __len__(self):
        return len(self._lines)

    def __repr__(self):
        bad = ", ".join(line.name for line in self if not line.ok)
        return f"<{self.verdict}{': ' + bad if bad else ''}>"


class Results:
    """What a run has left in folder. Files are read when they are asked for.

    problems lists the warnings and notes of nsfd.run; the folder does not keep
    them. All numbers are SI; in two dimensions masses, energies and forces are
    per metre of depth."""

    def __init__(self, folder, problems=()):
        self.folder = Path(folder)
        self.problems = list(problems)

    @cached_property
    def summary(self):
        """summary.json as a dictionary; empty if the run did not get there."""
        return self._json("summary.json")

    @cached_property
    def units(self):
        """units.json: the units of columns and numbers by file."""
        return self._json("units.json")

    @cached_property
    def history(self):
        """The Table with a row at the start and after each accepted step."""
        return self._table("history.csv")

    @cached_property
    def observables(self):
        """The Table of each block Observable by its name."""
        files = sorted((self.folder / "observables").glob("*.csv"))
        return {file.stem: self._table(f"observables/{file.name}") for file in files}

    @cached_property
    def fragments(self):
        """The Table of all fragments at each time of output; None if the scene
        cannot fall to pieces."""
        if not (self.folder / "fragments.csv").exists():
            return None
        return self._table("fragments.csv")

    @property
    def last_fragments(self):
        """The rows of fragments at the end."""
        table = self.fragments
        return table and table.rows(table["step"] == table["step"].max())

    @cached_property
    def fields(self):
        """The Series of the volume: displacement, velocity, stress (xx, yy, zz,
        xy, yz, xz), von_mises at points; fragment, material of cells."""
        return read_series(self.folder, "fields")

    @cached_property
    def interfaces(self):
        """The Series of the faces: beta, jump_n, jump, traction, slip, contact,
        kind, block, obstacle of cells."""
        return read_series(self.folder, "interfaces")

    @cached_property
    def certificate(self):
        return Certificate(self.summary.get("certificate", {}))

    @cached_property
    def scene(self):
        """The complete Scene that was run, all defaults included."""
        return Scene(self.folder / "parameters.prm")

    @property
    def errors(self):
        """Against the exact solution, where the scene has one; relative."""
        return self.summary.get("errors", {})

    @property
    def completed(self):
        return bool(self.summary.get("completed", False))

    @property
    def ok(self):
        """Completed, and every line of the certificate within its bound."""
        return self.completed and self.certificate.ok

    @property
    def warnings(self):
        return [one for one in self.problems if one.kind == "warning"]

    @property
    def notes(self):
        return [one for one in self.problems if one.kind == "note"]

    def _json(self, name):
        path = self.folder / name
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    def _table(self, name):
        return read_table(self.folder / name, self.units.get(name))

    def __repr__(self):
        state = self.certificate.verdict if self.completed else "not completed"
        return f"<Results in {self.folder}: {state}>"


def load(folder):
    """The Results in the folder of a run, or the Study in that of a study.
    Raises FileNotFoundError if the folder is neither."""
    folder = Path(folder)
    if (folder / "study.json").exists():
        from .study import Study

        return Study(folder)
    if not (folder / "run.json").exists():
        raise FileNotFoundError(
            f"there are no results of nsfd in '{folder}': name the folder that was "
            "output of a run; by default it is output/NAME of the scene"
        )
    return Results(folder)


def as_scene(scene):
    return scene if isinstance(scene, Scene) else Scene(scene)


def finish(loaded):
    """What call_program returns, or the exception of its exit code."""
    results, code, report, problems = loaded
    if results is not None:
        results.problems = [one for one in problems if one.kind != "error"]
    if code == NOT_SOLVED:
        raise NotSolved(report, results)
    if code == STOPPED:
        raise Stopped(report, results)
    return results


def run(
    scene,
    *,
    output=None,
    ranks=1,
    force=False,
    resume=False,
    quiet=True,
    plug_ins=(),
    program=None,
    **settings,
):
    """Runs a scene and returns its Results.

    scene: a path of a parameter file, a Scene, or what Scene takes.
    settings: entries that are changed for this run, as in a dictionary of a
        Scene: dimension=3, Time={"end": "40 us"}, **{"Time/end": "40 us"}.
    output: the folder of the results, output/NAME of the scene by default. It is
        never overwritten: force=True replaces a run in it, resume=True goes on
        with it from its last checkpoint.
    ranks: processes, started by mpirun if there are several.
    quiet: False prints what the program prints.
    plug_ins: files of laws and other parts that were built outside of nsfd.
    program: the path of nsfd; else the environment variable NSFD, PATH, the
        program that belongs to this package.

    Raises InputError (the scene is not valid), FolderError (the folder of the
    results cannot be used), NotSolved, Stopped, ProgramError. At Ctrl-C the
    program stores its state before KeyboardInterrupt is raised; a second one
    ends it as it is."""
    scene = as_scene(scene)
    if scene.is_study() or any(path.startswith("Study") for path in settings):
        raise ValueError(
            f"the scene {scene.name!r} is a study of many runs: nsfd.study runs it"
        )
    folder = Path(output) if output is not None else Path("output", scene.name)
    call = Call(folder, settings, ranks, force, resume, quiet, tuple(plug_ins), program)
    return finish(call_program(scene, call, "run", load))
