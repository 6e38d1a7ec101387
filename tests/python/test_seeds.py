"""A study over seeds: what is observed is what the runs did, all of it is there
after the study was killed, and distributions are those of the values."""

import json
import signal
import subprocess
import time
import unittest

import numpy as np

import nsfd
from nsfd.program import find_program
from common import PRM, InScratch

RING = PRM / "tutorials" / "ring.prm"
SEEDS = 8


class Seeds(InScratch):
    def command(self, folder, *more):
        return [
            find_program(),
            "study",
            RING,
            "--vary",
            f"Interface: all/seed=1..{SEEDS}",
            "--set",
            "Time/end=4 us",
            "--set",
            "Study/observe=fragments, dissipated/damage, max broken_area",
            "--set",
            "Study/average over=seed",
            "--set",
            "Study/abscissa=none",
            "--output",
            folder,
            *more,
        ]

    def test_observed_killed_and_resumed(self):
        whole = self.scratch / "whole"
        subprocess.run(self.command(whole, "--quiet"), check=True)
        runs = [
            nsfd.load(folder)
            for folder in sorted(whole.glob("seed=*"))
        ]
        self.assertEqual(len(runs), SEEDS)
        study = json.loads((whole / "study.json").read_text())
        found = {one["quantity"]: one for one in study["distributions"]}
        for name, values in {
            "fragments": [run.summary["fragments"] for run in runs],
            "dissipated/damage": [run.summary["dissipated"]["damage"] for run in runs],
            "max_broken_area": [np.max(run.history["broken_area"]) for run in runs],
        }.items():
            self.assertEqual(found[name]["values"], sorted(values), name)
            mean, half = np.mean(values), found[name]["half_width"]
            self.assertAlmostEqual(found[name]["mean"] / mean, 1, delta=1e-12)
            # Student's t of 7 degrees of freedom, 97.5 %: 2.3646 (tables)
            self.assertAlmostEqual(
                half / (np.std(values, ddof=1) / np.sqrt(SEEDS)), 2.3646, delta=1e-4
            )
        for picture in ("histogram", "weibull"):
            self.assertTrue((whole / f"{picture}_dissipated_damage.svg").exists())

        killed = self.scratch / "killed"
        child = subprocess.Popen(self.command(killed, "--quiet"))
        deadline = time.time() + 120
        while time.time() < deadline and len(list(killed.glob("*/case.json"))) < 3:
            time.sleep(0.02)
        child.send_signal(signal.SIGKILL)
        child.wait()
        done = {case.parent.name for case in killed.glob("*/case.json")}
        report = subprocess.run(
            self.command(killed, "--resume"), check=True, capture_output=True, text=True
        ).stdout
        self.assertGreaterEqual(report.count("taken over"), min(len(done), SEEDS))
        again = json.loads((killed / "study.json").read_text())
        self.assertEqual(again["distributions"], study["distributions"])

    def test_what_is_no_quantity_is_refused(self):
        result = subprocess.run(
            self.command(self.scratch / "no", "--set", "Study/observe=most fragments"),
            capture_output=True,
            text=True,
        )
        self.assertEqual(result.returncode, 1)
        self.assertIn("observe", result.stderr)


if __name__ == "__main__":
    unittest.main()
