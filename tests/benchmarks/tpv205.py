#!/usr/bin/env python3
"""Arrival, slip and slip rate of prm/reference/tpv205.prm at its stations.

    ./nsfd prm/reference/tpv205.prm
    tests/benchmarks/tpv205.py output/tpv205 [FOLDER]

prints them beside published values; FOLDER, if given, has the series of a code
as it published them, pylith_strike*_dip-7.5.txt (time, slip, slip rate, ...),
and the same is computed from these. The low pass has the corner period 0.2 s:
a Butterworth filter of second order, forwards and backwards.
"""

import csv
import json
import math
import pathlib
import sys

STATIONS = {  # km: first 1 mm/s (s), slip at 12 s (m), peak slip rate (m/s)
    # after the low pass, and as published every 0.05 s
    -12.0: (2.85, 4.247, 5.709, 6.769),
    -7.5: (1.85, 6.953, 4.497, 5.260),
    -4.5: (1.55, 7.299, 3.999, 4.395),
    4.5: (1.55, 6.444, 3.999, 4.395),
    7.5: (2.70, 4.882, 2.010, 2.302),
    12.0: (4.30, 3.611, 4.170, 4.259),
}
TOLERANCE = (0.1, 0.02, 0.1)  # s; shares of the value


def table(path):
    with open(path, encoding="utf-8") as file:
        rows = csv.DictReader(file)
        columns = {name: [] for name in rows.fieldnames}
        for row in rows:
            for name, value in row.items():
                columns[name].append(float(value))
    return columns


def of_run(folder, km):
    """Times, slips and slip rates: what is above less what is below."""
    sides = [
        table(folder / "observables" / f"{side} {1000 * km:g} m.csv")
        for side in ("above", "below")
    ]
    difference = {
        name: [a - b for a, b in zip(sides[0][name], sides[1][name])]
        for name in ("displacement_x", "velocity_x")
    }
    times = sides[0]["time"]
    slips = [abs(u) for u in difference["displacement_x"]]
    rates = [0.0] + [
        abs(b - a) / (t - s)
        for s, t, a, b in zip(
            times,
            times[1:],
            difference["displacement_x"],
            difference["displacement_x"][1:],
        )
    ]
    return times, slips, rates


def of_series(folder, km):
    path = folder / f"pylith_strike{km:.1f}_dip-7.5.txt"
    rows = [
        [float(word) for word in line.split()[:3]]
        for line in path.read_text().splitlines()
        if line.strip() and not line.startswith("#")
    ]
    times, slips, rates = zip(*rows)
    return times, [abs(s) for s in slips], [abs(r) for r in rates]


def at(time, times, values):
    """Linear between the rows."""
    for k in range(1, len(times)):
        if times[k] >= time:
            share = (time - times[k - 1]) / (times[k] - times[k - 1])
            return values[k - 1] + share * (values[k] - values[k - 1])
    return values[-1]


def low_pass(times, values, period=0.2):
    """Of equal steps; bilinear, with the corner where it is to be."""
    step = (times[-1] - times[0]) / (len(times) - 1)
    k = math.tan(math.pi * step / period)
    norm = 1.0 / (1.0 + math.sqrt(2.0) * k + k * k)
    b = k * k * norm
    a1 = 2.0 * (k * k - 1.0) * norm
    a2 = (1.0 - math.sqrt(2.0) * k + k * k) * norm
    for _ in range(2):
        x1 = x2 = y1 = y2 = values[0]
        result = []
        for x in values:
            y = b * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2
            x1, x2, y1, y2 = x, x1, y, y1
            result.append(y)
        values = result[::-1]
    return values


def numbers(times, slips, rates):
    """First 1 mm/s, slip at 12 s, peak after the low pass, raw peak."""
    first = next((t for t, r in zip(times, rates) if r >= 1e-3), float("nan"))
    return (first, at(12.0, times, slips), max(low_pass(times, rates)),
            max(rates))


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    series = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else None
    print("station   first 1 mm/s, s      slip at 12 s, m      "
          "peak slip rate, m/s: low pass, raw")
    missed = 0
    for km, published in STATIONS.items():
        ours = numbers(*of_run(folder, km))
        bounds = (TOLERANCE[0], TOLERANCE[1] * published[1],
                  TOLERANCE[2] * published[2])
        text = f"{km:6.1f} km"
        for k in range(3):
            good = abs(ours[k] - published[k]) <= bounds[k]
            missed += not good
            text += f"   {ours[k]:6.3f} ({published[k]:5.3f}){' ' if good else '*'}"
        text += f"  {ours[3]:6.2f} ({published[3]:4.2f})"
        if series:
            theirs = numbers(*of_series(series, km))
            text += "   series: " + " ".join(f"{x:.3f}" for x in theirs)
        print(text)
    summary = json.loads((folder / "summary.json").read_text())
    print(f"{missed} of 18 outside the tolerance (*); balance residual "
          f"{summary['ledger_defect_max']:.1e}, numerical "
          f"{summary['dissipated']['numerical']:.1e} of friction "
          f"{summary['dissipated']['friction']:.3e} J/m, absorbed "
          f"{summary['dissipated']['absorbed']:.3e}; "
          f"{summary['steps']} steps, {summary['wall_seconds']:.0f} s of the "
          f"clock, {summary['cpu_seconds']:.0f} s of CPU")


if __name__ == "__main__":
    main()
