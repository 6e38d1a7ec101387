"""Runs of a scene for many values, and what they say together."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Optional

import numpy as np

from .program import Call, call_program
from .results import Results, as_scene, finish, load
from .scene import value_text
from .table import read_table


@dataclass(frozen=True)
class Order:
    """The slope of log(error) over log(size) in one series of a study; order is
    None if it cannot be told, expected if the study expects none. sizes and
    errors have the shape (points,), rates one less."""

    error: str
    series: str
    sizes: np.ndarray
    errors: np.ndarray
    rates: np.ndarray
    order: Optional[float]
    expected: Optional[float]
    verdict: str


class Study:
    """What a study has left in folder: table with a row per case, orders,
    verdict, and the Results of every case by its name in runs."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.problems = []

    @cached_property
    def data(self):
        """study.json as a dictionary."""
        return json.loads((self.folder / "study.json").read_text(encoding="utf-8"))

    @cached_property
    def table(self):
        """The Table of study.csv: a row per case."""
        return read_table(self.folder / "study.csv")

    @cached_property
    def orders(self):
        """An Order for each series and error."""
        return [
            Order(
                one["error"],
                one["series"],
                _numbers(one.get("sizes")),
                _numbers(one.get("errors")),
                _numbers(one.get("rates")),
                one["order"],
                one["expected"],
                one["verdict"],
            )
            for one in self.data["orders"]
        ]

    @property
    def verdict(self):
        return self.data["verdict"]

    @property
    def warnings(self):
        """What the study warns of, as sentences."""
        return self.data["warnings"]

    @cached_property
    def runs(self):
        names = [one["case"] for one in self.data["runs"]]
        return {name: Results(self.folder / name) for name in names}

    def __repr__(self):
        done = f"{self.data['done']} of {self.data['cases']} cases"
        return f"<Study in {self.folder}: {done}>"


def _numbers(values):
    return np.array([np.nan if v is None else v for v in values or []], dtype=float)


def _values(values):
    """The values of one parameter: a text is that of the command line."""
    if isinstance(values, str):
        return values
    if isinstance(values, (list, tuple, range, np.ndarray)):
        return ", ".join(
            # a comma inside of a value does not end it
            f"[{text}]" if "," in text else text
            for text in map(value_text, values)
        )
    return value_text(values)


def _words(vary):
    """The options --vary of {"Mesh/cells": [[8, 1], [16, 1]]}."""
    if not isinstance(vary, Mapping):
        raise TypeError(
            "vary is a dictionary: write for example "
            "vary={'Discretization/degree': [1, 2, 3]}"
        )
    words = []
    for paths, values in vary.items():
        if isinstance(paths, tuple):
            # they go together: a value of each of them per case
            columns = list(zip(*values))
            if any(len(row) != len(paths) for row in values):
                raise ValueError(
                    f"each value of {paths} needs {len(paths)} parts, one per parameter"
                )
            text = " & ".join(f"{p}={_values(c)}" for p, c in zip(paths, columns))
        else:
            text = f"{paths}={_values(values)}"
        words += ["--vary", text]
    return words


def study(
    scene,
    vary=None,
    *,
    output=None,
    force=False,
    resume=False,
    quiet=True,
    plug_ins=(),
    program=None,
    **settings,
):
    """Runs a scene for every combination of values and returns the Study.

    vary: values by parameter, {"Discretization/degree": [1, 2, 3], "Mesh/cells":
        [[8, 1], [16, 1]]}; a text as on the command line, "4/2^0..3 us"; names in
        a tuple go together: {("Mesh/refinements", "Time/step"): [(0, "4 us"),
        (1, "2 us")]}. May be left out for a scene that says what varies.
    settings: as those of nsfd.run, for all cases, and those of section Study:
        Study={"repeats": 1, "limit checks": False}.

    output, force, resume (takes over the cases that are done), quiet, plug_ins,
    program and the exceptions are those of nsfd.run; NotSolved if a case could not be
    solved, with the tables of all others in its results."""
    scene = as_scene(scene)
    folder = Path(output) if output is not None else Path("output", scene.name)
    call = Call(folder, settings, 1, force, resume, quiet, tuple(plug_ins), program)
    return finish(call_program(scene, call, "study", load, _words(vary or {})))
