"""The package nsfd runs the program, and what it reads is the physics of the
scenes. The program is that of the environment variable NSFD, else of the
checkout."""

import contextlib
import io
import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import numpy as np

import nsfd
from common import HALVES, MODE, PRM, InScratch


def areas(grid):
    """Of plane cells, by the shoelace formula."""
    x, y = np.moveaxis(grid.points[grid.cells][:, :, :2], 2, 0)
    return np.sum(x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1), 1) / 2


class Mode(InScratch):
    def test_history_fields_and_summary_are_the_standing_wave(self):
        run = nsfd.run(MODE, output=self.scratch / "run")
        self.assertTrue(run.ok)
        self.assertEqual(run.problems, [])
        history, t = run.history, run.history["time"]
        # omega a / c = 2.993042922707027, a = 1 m, c = 5000 m/s; the scene finds its
        # frequency to 7e-6 and its energy to 1e-9 (the tolerance of the solver)
        omega = 2.993042922707027 * 5000
        energy = history["kinetic"] + history["elastic"] + history["cohesive"]
        np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
        np.testing.assert_allclose(
            history["kinetic"] / energy[0], np.sin(omega * t) ** 2, atol=1e-3
        )
        # the last row is what the summary says, to the last digit
        for name, value in run.summary["energy"].items():
            self.assertEqual(history[name][-1], value)
        self.assertEqual(t[-1], run.summary["final_time"])
        self.assertEqual(history.n_rows, run.summary["steps"] + 1)
        self.assertEqual(history.units["kinetic"], "J/m")
        self.assertLess(run.errors["displacement_L2"], 1e-4)
        # of an eighth of the amplitude: sin(2 pi 1.125) = cos(2 pi 1.125)
        first, last = run.fields[0], run.fields.at(t[-1])
        np.testing.assert_allclose(
            last["displacement"], first["displacement"] / np.sqrt(2), atol=1e-9
        )
        self.assertAlmostEqual(np.sum(areas(last)), 2 * 0.0625, delta=1e-14)
        np.testing.assert_allclose(np.diff(run.fields.times)[:-1], 50e-6, rtol=0.02)

    def test_ranks_and_formats_have_the_same_fields(self):
        end = {"end": "20 us"}
        runs = [
            nsfd.run(MODE, output=self.scratch / "one", Time=end),
            nsfd.run(MODE, output=self.scratch / "two", Time=end, ranks=2),
            nsfd.run(
                MODE,
                output=self.scratch / "hdf5",
                Time=end,
                Output={"format": "hdf5"},
                ranks=2,
            ),
        ]
        self.assertEqual([run.summary["completed"] for run in runs], [True] * 3)
        for run in runs[1:]:
            for name in runs[0].history:  # bit for bit, but for counts of work
                if name not in ("newton", "krylov", "residual"):
                    np.testing.assert_array_equal(
                        run.history[name], runs[0].history[name], name
                    )
            for series in ("fields", "interfaces"):
                a, b = getattr(runs[0], series), getattr(run, series)
                np.testing.assert_array_equal(a.times, b.times)
                self.assertEqual(cells_of(a[-1]), cells_of(b[-1]))

    def test_a_run_can_be_read_while_and_after_it_is_stopped(self):
        script = (
            "import nsfd, sys\n"
            f"nsfd.run({str(MODE)!r}, output='run', ranks=int(sys.argv[1]),"
            " Time={'end': '1 s'}, Output={'fields every': 0})\n"
        )
        for ranks in (1, 2):
            folder = self.scratch / str(ranks)
            folder.mkdir()
            child = subprocess.Popen(
                [sys.executable, "-c", script, str(ranks)],
                cwd=folder,
                stderr=subprocess.PIPE,
                text=True,
            )
            wait_for(folder / "run" / "history.csv", rows=20)
            child.send_signal(signal.SIGINT)
            _, report = child.communicate(timeout=60)
            self.assertIn("KeyboardInterrupt: stopped", report)
            stopped = nsfd.load(folder / "run")
            self.assertFalse(stopped.completed)
            self.assertFalse(stopped.ok)
            self.assertIn("stopped on request", stopped.summary["failure"])
            rows = stopped.history.n_rows
            more = nsfd.run(
                MODE,
                output=folder / "run",
                resume=True,
                ranks=ranks,
                Time={"end": 1.01 * stopped.history["time"][-1]},
                Output={"fields every": 0},
            )
            self.assertTrue(more.completed)
            self.assertGreater(more.history.n_rows, rows)
            np.testing.assert_array_equal(
                more.history["kinetic"][:rows], stopped.history["kinetic"]
            )

    def test_what_the_program_prints_is_shown_on_request(self):
        shown = io.StringIO()
        with contextlib.redirect_stdout(shown):
            nsfd.run(MODE, output=self.scratch / "a", Time={"end": "1 us"})
            self.assertEqual(shown.getvalue(), "")
            nsfd.run(MODE, output=self.scratch / "b", Time={"end": "1 us"}, quiet=False)
        self.assertIn("certificate", shown.getvalue())


class Halves(InScratch):
    def setUp(self):
        super().setUp()
        self.run_ = nsfd.run(nsfd.Scene(HALVES), output=self.scratch / "run")

    def test_fragments_have_mass_and_momentum(self):
        pieces = self.run_.last_fragments
        np.testing.assert_allclose(pieces["mass"], [4, 8], rtol=1e-12)
        np.testing.assert_allclose(pieces["vx"], [-1, 2], rtol=1e-9)
        np.testing.assert_allclose(pieces["x"], [0.49, 1.52], rtol=1e-9)
        self.assertEqual(self.run_.summary["fragments"], 2)
        self.assertEqual(set(self.run_.fragments["step"]), {0, 5, 10})

    def test_fields_integrate_to_mass_and_energy(self):
        grid = self.run_.fields[-1]
        mass = areas(grid) * np.array([1.0, 2.0])[grid["material"].astype(int)]
        speed = grid["velocity"][grid.cells].mean(axis=1)
        np.testing.assert_allclose(np.sum(mass), 12, rtol=1e-12)
        np.testing.assert_allclose(mass @ speed[:, 0], 12, rtol=1e-9)
        kinetic = np.sum(mass * np.sum(speed**2, axis=1)) / 2
        np.testing.assert_allclose(kinetic, 18, rtol=1e-9)
        self.assertEqual(kinetic.round(9), self.run_.history["kinetic"][-1].round(9))
        self.assertEqual(set(grid["fragment"]), {0, 1})

    def test_interfaces_have_jumps(self):
        grid = self.run_.interfaces[-1]
        ends = grid.points[grid.cells]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        open_ = grid["beta"] == 0
        # 4 m high; 3 m/s for 10 ms
        np.testing.assert_allclose(np.sum(lengths[open_]), 4, rtol=1e-12)
        np.testing.assert_allclose(np.abs(grid["jump_n"][open_]), 0.03, rtol=1e-9)
        self.assertEqual(grid["jump"].shape, (len(lengths), 3))

    def test_certificate_and_scene(self):
        certificate = self.run_.certificate
        self.assertTrue(certificate["balance residual"].ok)
        self.assertEqual(certificate["balance residual"].bound, 1e-9)
        self.assertEqual(certificate.ok, all(line.ok for line in certificate))
        self.assertEqual(self.run_.ok, certificate.ok)
        self.assertEqual(self.run_.scene["Interface: middle/law"], "camacho-ortiz")
        again = nsfd.run(self.run_.scene, output=self.scratch / "again")
        self.assertEqual(again.summary["energy"], self.run_.summary["energy"])


class Refused(InScratch):
    def error(self, kind, *arguments, **settings):
        settings.setdefault("output", self.scratch / "refused")
        with self.assertRaises(kind) as caught:
            nsfd.run(*arguments, **settings)
        self.assertFalse((self.scratch / "refused").exists())
        return caught.exception

    def test_errors_have_line_and_entry(self):
        scene = nsfd.Scene(HALVES, folder=self.scratch)
        scene["Time/stepp"] = "1 ms"
        scene["Material: left/density"] = -1
        del scene["Mesh/upper corner"]
        error = self.error(nsfd.InputError, scene)
        lines = scene.text.splitlines()
        found = {one.entry: one for one in error.problems}
        self.assertEqual(
            set(found), {"Mesh/upper corner", "Material: left/density", "Time/stepp"}
        )
        density, step = found["Material: left/density"], found["Time/stepp"]
        self.assertIn("density", lines[density.line - 1])
        self.assertIn("-1", lines[density.line - 1])
        self.assertIn("must be positive", density.text)
        self.assertIn("stepp", lines[step.line - 1])
        self.assertEqual(step.file, "scene")
        self.assertEqual(found["Mesh/upper corner"].advice[:5], "write")
        self.assertEqual((error.line, error.entry), (3, "Mesh/upper corner"))
        self.assertIn("3 errors, nothing was run", str(error))
        self.assertNotIn(".nsfd_", str(error))
        self.assertEqual(os.listdir(self.scratch), [])

    def test_errors_of_a_file_and_of_what_it_includes(self):
        (self.scratch / "part.prm").write_text(
            "subsection Time\n  set end = 1 kg\nend\n"
        )
        (self.scratch / "all.prm").write_text(
            HALVES.split("subsection Time")[0] + "include part.prm\n"
        )
        error = self.error(nsfd.InputError, self.scratch / "all.prm")
        self.assertEqual(Path(error.file).name, "part.prm")
        self.assertEqual((error.line, error.entry), (2, "Time/end"))

    def test_errors_of_settings(self):
        error = self.error(nsfd.InputError, MODE, Time={"theta": 3, "ennd": 1}, foo=2)
        self.assertEqual(
            {(one.file, one.line, one.entry) for one in error.problems},
            {("settings", None, name) for name in ("Time/theta", "Time/ennd", "foo")},
        )
        self.assertIn("did you mean `end`?", [one.advice for one in error.problems])
        with self.assertRaisesRegex(TypeError, "write a text such as"):
            nsfd.run(MODE, output=self.scratch / "refused", Time={"end": None})

    def test_a_file_that_is_not_there(self):
        error = self.error(FileNotFoundError, self.scratch / "gone.prm")
        self.assertIn("gone.prm", str(error))
        with self.assertRaisesRegex(FileNotFoundError, "there are no results"):
            nsfd.load(self.scratch)

    def test_results_are_not_overwritten(self):
        end = {"end": "1 us"}
        first = nsfd.run(MODE, output=self.scratch / "run", Time=end)
        with self.assertRaisesRegex(nsfd.FolderError, "force=True"):
            nsfd.run(MODE, output=self.scratch / "run", Time=end)
        again = nsfd.run(MODE, output=self.scratch / "run", Time=end, force=True)
        self.assertEqual(first.summary["energy"], again.summary["energy"])

    def test_a_step_that_is_not_solved(self):
        with self.assertRaises(nsfd.NotSolved) as caught:
            nsfd.run(
                MODE,
                output=self.scratch / "run",
                Solver={"maximum iterations": 1},
                Time={"maximum bisections": 0},
            )
        error = caught.exception
        self.assertRegex(error.worst, r"^\(.*\) of `Interface: (joints|middle)`$")
        self.assertIn("was not solved", str(error))
        self.assertFalse(error.results.completed)
        self.assertEqual(error.results.history.n_rows, 1)
        self.assertFalse(error.results.certificate["end"].ok)

    def test_programs_that_are_not_there_or_break_off(self):
        error = self.error(nsfd.ProgramError, MODE, program=self.scratch / "none")
        self.assertIn("none", str(error))
        broken = self.scratch / "broken"
        broken.write_text("#!/bin/sh\necho 'error: the disk is full' >&2\nexit 5\n")
        broken.chmod(0o755)
        error = self.error(nsfd.ProgramError, MODE, program=broken)
        self.assertEqual(error.exit_code, 5)
        self.assertEqual(str(error), "error: the disk is full")

    def test_a_study_is_no_run(self):
        study = PRM / "studies" / "mode_convergence.prm"
        self.assertIn("nsfd.study", str(self.error(ValueError, study)))
        self.assertIn(
            "nsfd.study", str(self.error(ValueError, MODE, Study={"repeats": 1}))
        )


class Said(InScratch):
    def test_warnings_and_notes_are_kept(self):
        scene = nsfd.Scene(MODE)
        scene["Time/end"] = "1 us"
        scene["Solver/path"] = "element-wise"
        run = nsfd.run(scene, output=self.scratch / "run")
        (note,) = run.notes
        self.assertEqual((note.kind, note.entry), ("note", "Solver/path"))
        self.assertEqual(note.file, "mode")
        self.assertIn("is called `local` today", note.text)
        self.assertEqual(run.warnings, [])


class Studies(InScratch):
    few = {"repeats": 1, "limit checks": False}

    def test_orders_are_those_of_the_degree(self):
        study = nsfd.study(
            MODE,
            {"Discretization/degree": [1, 2], "Mesh/cells": [[4, 1], [8, 1], [16, 1]]},
            output=self.scratch / "s",
            Study={**self.few, "expected orders": "displacement_L2: degree + 1"},
            Time={"end": "52.4815837 us", "step": "100 ns"},
        )
        table = study.table
        self.assertEqual(table.n_rows, 6)
        self.assertEqual(set(table["Mesh/cells"]), {"4, 1", "8, 1", "16, 1"})
        orders = [one for one in study.orders if one.error == "displacement_L2"]
        self.assertEqual([one.expected for one in orders], [2, 3])
        for one in orders:
            self.assertEqual(one.verdict, "as expected")
            # the slope by least squares is ours as well
            slope = np.polyfit(np.log(one.sizes), np.log(one.errors), 1)[0]
            self.assertAlmostEqual(one.order, slope, delta=1e-6)
        # errors in the table are those of the single runs
        for name, error in zip(table["case"], table["error_displacement_L2"]):
            self.assertAlmostEqual(
                study.runs[name].errors["displacement_L2"] / error, 1, delta=1e-8
            )
        self.assertEqual(nsfd.load(study.folder).data, study.data)

    def test_values_that_go_together_and_cases_that_fail(self):
        vary = {
            ("Solver/maximum iterations", "Time/maximum bisections"): [
                (1, 0),
                (200, 2),
            ],
            "Mesh/cells": "[4*2^0..1, 1]",
        }
        with self.assertRaises(nsfd.NotSolved) as caught:
            nsfd.study(
                MODE,
                vary,
                output=self.scratch / "s",
                Study=self.few,
                Time={"end": "10 us"},
            )
        table = caught.exception.results.table
        done = table["Solver/maximum iterations"] == 200
        np.testing.assert_array_equal(table["Time/maximum bisections"], 2.0 * done)
        self.assertEqual(list(table["status"] == "done"), list(done))
        self.assertEqual(int(np.sum(done)), 2)
        for failure, is_done in zip(table["failure"], done):
            self.assertEqual("was not solved" in failure, not is_done)

    def test_bad_values_run_nothing(self):
        with self.assertRaises(nsfd.InputError) as caught:
            nsfd.study(MODE, {"Time/theta": [0.5, 0.2]}, output=self.scratch / "s")
        self.assertIn("theta = 0.2", str(caught.exception))
        self.assertEqual(caught.exception.entry, "Time/theta")
        with self.assertRaisesRegex(ValueError, "needs 2 parts"):
            nsfd.study(MODE, {("Time/theta", "Time/step"): [(1, 2), (3,)]})
        self.assertFalse((self.scratch / "s").exists())


def cells_of(grid):
    """Every cell with its corners and values, in an order of their own."""
    rows = []
    for cell, corners in enumerate(grid.cells):
        values = [grid.points[corners].tolist()]
        for data, places in ((grid.cell_data, cell), (grid.point_data, corners)):
            values += [data[name][places].tolist() for name in sorted(data)]
        rows.append(values)
    return sorted(rows)


def wait_for(file, rows):
    end = time.monotonic() + 60
    while time.monotonic() < end:
        if file.exists() and file.read_bytes().count(b"\n") > rows:
            return
        time.sleep(0.05)
    raise AssertionError(f"no {rows} rows in {file}")


if __name__ == "__main__":
    unittest.main()
