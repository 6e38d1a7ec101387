#!/usr/bin/env python3
"""The table of doc/reference.md: published values, ours, and what they cost.

    tests/benchmarks/reference.py [--program ./nsfd] [--folder output/reference]
                                  [SCENE ...]

runs the scenes of prm/reference that have no results in the folder yet, all or
those that are named, and prints a row per quantity. tpv205 has a script of its
own, tpv205.py.
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = {}  # name: function of a run


class Run:
    def __init__(self, folder):
        self.folder = folder
        with open(folder / "summary.json", encoding="utf-8") as file:
            self.summary = json.load(file)
        self.history = self.table("history.csv")

    def table(self, name):
        with open(self.folder / name, encoding="utf-8") as file:
            rows = csv.DictReader(file)
            columns = {column: [] for column in rows.fieldnames}
            for row in rows:
                for column, value in row.items():
                    columns[column].append(float(value) if value else math.nan)
        return columns

    def observed(self, name):
        return self.table(f"observables/{name}.csv")

    def counter(self, name):
        return self.summary["counters"].get(name, 0.0)

    def cost(self):
        rejected = self.counter("rejected_steps")
        return (
            f"{self.summary['steps']} steps, {rejected:.0f} rejected, "
            f"{self.summary['cpu_seconds']:.0f} s of CPU, balance "
            f"{self.summary['ledger_defect_max']:.0e}"
        )


def scene(function):
    SCENES[function.__name__] = function
    return function


def slope(x, y):
    """Of y over x, by least squares."""
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum(
        (a - mean_x) ** 2 for a in x
    )


def at(columns, name, time):
    """The last value up to a time."""
    value = math.nan
    for t, v in zip(columns["time"], columns[name]):
        if t <= time * (1 + 1e-12):
            value = v
    return value


def largest_gain_of_friction(run):
    work = run.history["friction"]
    return max(max((a - b for a, b in zip(work, work[1:])), default=0.0), 0.0)


@scene
def one_point(run):
    base = run.observed("base")
    off = 0.0
    for time, force in zip(base["time"][1:], base["force_x"][1:]):
        t = 1e3 * time
        beta = 1 - t / 2 if t <= 1 else 0.5 if t <= 3 else 2 - t / 2
        back = -1 if 1 + 1e-9 < t <= 2 + 1e-9 else 1
        off = max(off, abs(force + 500 * beta + back * 0.5 * (1000 + 500 * beta)))
    yield "reaction off the formula", "0", f"{off:.3g} N/m of 1250 N/m"
    yield "energy of damage", "250 mJ/m", f"{1e3 * run.history['damage'][-1]:.4g} mJ/m"
    yield "work of friction", "1.25 J/m", f"{run.history['friction'][-1]:.5g} J/m"


@scene
def impacting_stick(run):
    yield (
        "largest energy by friction in a step",
        "0",
        f"{largest_gain_of_friction(run):.2g} J",
    )


@scene
def sheared_block(run):
    yield (
        "largest energy by friction in a step",
        "0",
        f"{largest_gain_of_friction(run):.1e} J/m",
    )


@scene
def double_cantilever(run):
    front = run.observed("front")
    tips = [1e3 * at(front, "tip_x", 1e-3 * t) for t in (0.15, 0.3, 0.45, 0.6)]
    yield (
        "tip at 0.15, 0.3, 0.45, 0.6 ms",
        "slows down",
        ", ".join(f"{x:.2f}" for x in tips) + " mm",
    )


@scene
def double_cantilever_force(run):
    front = run.observed("front")
    held = run.counter("hold_time_left")
    way = [
        (t, x)
        for t, x in zip(front["time"], front["tip_x"])
        if t >= held and x < 1.8e-3
    ]
    last = max(x for x in front["tip_x"] if not math.isnan(x))
    yield "first element gone", "", f"{1e6 * held:.1f} us, {1e4 * held:.2f} N"
    yield (
        "mean speed of the front from there on",
        "fast",
        f"{slope(*zip(*way)):.0f} m/s",
    )
    yield "end of the crack", "arrested at the clamp", f"{1e3 * last:.2f} of 2 mm"


@scene
def rhombus(run):
    crack = run.observed("crack")
    held = run.counter("hold_time_top")
    force = -min(run.history["reaction_top_y"]) * 10e-3  # on 10 mm
    yield "arrest", "0.64 mm (0.593)", f"{1e3 * crack['length'][-1]:.3f} mm"
    yield (
        "largest force, first break",
        "",
        f"{force / 1e3:.2f} kN, {1e3 * held:.2f} ms",
    )


@scene
def sliding_block(run):
    front = run.observed("front")
    way = [
        (t, x)
        for t, x in zip(front["time"], front["tip_x"])
        if 72.5e-3 <= x <= 77.5e-3
    ]
    yield "front between 72.5 and 77.5 mm", "2103 m/s", f"{slope(*zip(*way)):.0f} m/s"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    arguments.add_argument("--program", default=str(ROOT / "nsfd"))
    arguments.add_argument("--folder", default="output/reference")
    arguments.add_argument("scenes", nargs="*", metavar="SCENE")
    given = arguments.parse_args()
    unknown = [name for name in given.scenes if name not in SCENES]
    if unknown:
        sys.exit(f"no scene {unknown[0]}: write one of {', '.join(SCENES)}")
    print("| scene | quantity | published | ours | cost |\n|---|---|---|---|---|")
    failed = 0
    for name in given.scenes or SCENES:
        folder = pathlib.Path(given.folder) / name
        if not (folder / "summary.json").exists():
            file = ROOT / "prm" / "reference" / f"{name}.prm"
            command = [given.program, str(file), "--output", str(folder)]
            subprocess.run(command + ["--quiet", "--force"], check=False)
        run = Run(folder)
        if not run.summary["completed"]:
            failed += 1
            print(f"| `{name}` | not completed: {run.summary.get('failure', '')} | | | |")
            continue
        cost = run.cost()
        for quantity, published, ours in SCENES[name](run):
            print(f"| `{name}` | {quantity} | {published} | {ours} | {cost} |", flush=True)
            cost = ""
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
