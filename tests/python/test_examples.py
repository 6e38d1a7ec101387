"""The examples of doc/examples/python as they are, the installed package, and
what a table is."""

import importlib.util
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

import nsfd
from common import HALVES, PRM, SOURCE, InScratch

EXAMPLES = SOURCE / "doc" / "examples" / "python"
STAND_IN = Path(__file__).parent / "stand_in"


class Examples(InScratch):
    def example(self, name, *paths):
        """What it prints, run where a user runs it: in the folder with prm."""
        (self.scratch / "prm").symlink_to(PRM)
        variables = dict(os.environ, MPLBACKEND="Agg")
        package = Path(nsfd.__file__).parents[1]
        variables["PYTHONPATH"] = os.pathsep.join(map(str, (package, *paths)))
        done = subprocess.run(
            [sys.executable, "-B", str(EXAMPLES / name)],
            cwd=self.scratch,
            env=variables,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_all_are_short_and_tested(self):
        names = {path.name for path in EXAMPLES.glob("*.py")}
        self.assertEqual(names, {"force_displacement.py", "order.py", "fragments.py"})
        for name in names:
            self.assertLess(len((EXAMPLES / name).read_text().splitlines()), 25)

    def test_force_displacement_in_five_lines(self):
        code = (EXAMPLES / "force_displacement.py").read_text().split('"""')[2]
        self.assertEqual(len(code.split("\n\n")[-1].strip().splitlines()), 5)
        has_it = importlib.util.find_spec("matplotlib") is not None
        self.example("force_displacement.py", *([] if has_it else [STAND_IN]))
        file = self.scratch / "force_displacement.png"
        if has_it:
            self.assertEqual(file.read_bytes()[:4], b"\x89PNG")
        else:
            self.assertEqual(np.loadtxt(file).shape, (526, 2))
        run = nsfd.load(self.scratch / "output" / "dcb_beam_growth")
        u = run.observables["grip"]["displacement_y"]
        force = run.history["reaction_upper_y"]
        self.assertEqual(run.observables["grip"].units["displacement_y"], "m")
        self.assertEqual(run.history.units["reaction_upper_y"], "N/m")
        # each arm has half of the opening; compliance of two beams on springs and
        # the load at which the first piece breaks, 1.054 times that of beam theory:
        # see the scene, which finds the load to 0.001
        slow = slice(20, 120)
        compliance = 2 * u[slow] / force[slow]
        np.testing.assert_allclose(compliance, 1.355288e-7, rtol=2e-4)
        self.assertAlmostEqual(force.max() / (1.05409 * 7215.90), 1, delta=0.002)
        self.assertAlmostEqual(u[-1], 1.2e-3 / 2, delta=1e-9)
        # then the crack grows: P l is constant and u goes with P l^3, so that P
        # falls with u^(-1/2), up to the teeth of the curve, some 1 % of P
        fall = np.sqrt(u[np.argmax(force)] / u[-1])
        self.assertAlmostEqual(force[-1] / force.max(), fall, delta=0.01)

    def test_order_is_that_of_the_degree(self):
        orders = re.findall(r"order ([\d.]+)", self.example("order.py"))
        self.assertEqual(len(orders), 2)
        # coarse meshes: within 0.5 of p + 1, from above
        for degree, order in zip((1, 2), map(float, orders)):
            self.assertTrue(0 <= order - (degree + 1) < 0.5, orders)

    def test_fragments_have_the_momentum_of_the_pulse(self):
        shown = self.example("fragments.py")
        # 20 MPa on 5 mm for 0.2 m / (5000 m/s)
        momentum = float(re.search(r"momentum ([\d.]+)", shown)[1])
        self.assertAlmostEqual(momentum, 20e6 * 5e-3 * 0.2 / 5000, delta=1e-4)
        masses = [float(mass) for mass in re.findall(r"([\d.]+) kg/m at", shown)]
        self.assertEqual(masses, [36, 4])
        # l/(2 c) after the front has met the end, 1 m / c; see the scene
        torn = float(re.search(r"torn off at t = ([\d.]+)", shown)[1])
        self.assertAlmostEqual(torn, 220.4, delta=2)


class Installed(InScratch):
    @unittest.skipUnless("NSFD_BUILD_DIR" in os.environ, "the build is not named")
    def test_the_package_finds_the_program_next_to_it(self):
        prefix = self.scratch / "prefix"
        cmake = os.environ.get("NSFD_CMAKE", "cmake")
        subprocess.run(
            [cmake, "--install", os.environ["NSFD_BUILD_DIR"], "--prefix", prefix],
            check=True,
            capture_output=True,
        )
        variables = {"PATH": "/usr/bin:/bin"}
        variables["PYTHONPATH"] = str(prefix / "lib/python3/dist-packages")
        (self.scratch / "halves.prm").write_text(HALVES)
        done = subprocess.run(
            [
                sys.executable,
                "-Bc",
                "import nsfd; from nsfd.program import find_program\n"
                "run = nsfd.run('halves.prm')\n"
                "print(nsfd.__file__, find_program(), run.completed)",
            ],
            cwd=self.scratch,
            env=variables,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.stderr, "")
        module, program, completed = done.stdout.split()
        self.assertTrue(module.startswith(str(prefix)))
        self.assertEqual(program, str(prefix / "bin" / "nsfd"))
        self.assertEqual(completed, "True")


class Tables(InScratch):
    def table(self, text, **units):
        from nsfd.table import read_table

        path = self.scratch / "table.csv"
        path.write_text(text)
        return read_table(path, units)

    def test_columns(self):
        table = self.table('a,b,c\n1,x,"2, 3"\n,nan,4\n5,', a="m", d="s")
        np.testing.assert_array_equal(table["a"], [1, np.nan])
        self.assertEqual(list(table["b"]), ["x", "nan"])
        self.assertEqual(list(table["c"]), ["2, 3", "4"])
        self.assertEqual((table.n_rows, table.units), (2, {"a": "m"}))
        self.assertEqual(list(table.rows([1])["c"]), ["4"])
        with self.assertRaisesRegex(KeyError, "there are a, b, c"):
            table["d"]
        self.assertEqual(self.table("a,b\n")["b"].shape, (0,))

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed")
    def test_pandas(self):
        frame = self.table("a,b\n1,x\n2,y\n").to_pandas()
        self.assertEqual(list(frame["a"]), [1, 2])


if __name__ == "__main__":
    unittest.main()
