"""Scenes are read, changed and written without the program; what the program
makes of them is asked where it matters."""

import os
import shutil
import subprocess
import unittest

import numpy as np

import nsfd
from common import HALVES, MODE, PRM, SOURCE, InScratch


class Texts(InScratch):
    def test_every_shipped_scene_goes_through_unchanged(self):
        scenes = sorted([*PRM.rglob("*.prm"), *(SOURCE / "doc").rglob("*.prm")])
        self.assertGreater(len(scenes), 150)
        for path in scenes:
            with self.subTest(path.name):
                scene = nsfd.Scene(path)
                self.assertEqual(scene.text.encode(), path.read_bytes())
                # as a dictionary, and as the text of this one
                entries = scene.to_dict()
                self.assertTrue(entries)
                copy = nsfd.Scene(entries)
                self.assertEqual(copy.to_dict(), entries)
                self.assertEqual(nsfd.Scene(copy.text).to_dict(), entries)

    def test_the_program_reads_dictionaries_as_the_file(self):
        for name in ("verification/mode", "verification/midplane", "quickstart"):
            scene = nsfd.Scene(PRM / f"{name}.prm")
            copy = nsfd.Scene(scene.to_dict(), folder=self.scratch)
            echoes = [complete(one) for one in (scene, copy)]
            self.assertIn("subsection Time", echoes[0])
            self.assertEqual(*echoes)

    def test_only_what_is_changed_changes(self):
        scene = nsfd.Scene(HALVES)
        scene["Time/end"] = "20 ms"
        scene["Mesh/type"] = "crossed triangles"
        expected = HALVES.replace("end  = 10 ms", "end  = 20 ms").replace(
            "= rectangle            #", "= crossed triangles    #"
        )
        self.assertEqual(scene.text, expected)
        self.assertEqual(nsfd.Scene(scene).text, expected)
        self.assertEqual(scene["Time"]["end"], "20 ms")

    def test_entries_and_sections_come_and_go(self):
        scene = nsfd.Scene(HALVES)
        scene["plane"] = "stress"
        scene["Time/theta"] = 0.5
        scene["Solver"] = {"tolerance": 1e-9}
        scene["Observable:  grip"] = {"type": "probe", "at": [0.5, 2]}
        del scene["Interface: middle/broken"]
        del scene["Material: left"]
        self.assertEqual(scene["plane"], "stress")
        self.assertEqual(
            scene["Time"], {"end": "10 ms", "step": "1 ms", "theta": "0.5"}
        )
        self.assertEqual(scene["Solver/tolerance"], "1e-09")
        self.assertEqual(scene["Observable: grip/at"], "0.5, 2")
        self.assertNotIn("broken", scene["Interface: middle"])
        self.assertNotIn("Material: left", scene)
        again = nsfd.Scene(scene.text)
        self.assertEqual(again.to_dict(), scene.to_dict())
        self.assertEqual(list(again)[:2], ["dimension", "plane"])
        # in its place, as the first block that holds counts
        before = list(scene)
        scene["Interface: middle"] = {"law": "rigid", "where": "all"}
        self.assertEqual(list(scene), before)
        self.assertEqual(scene["Interface: middle"], {"law": "rigid", "where": "all"})

    def test_values(self):
        cells = np.array([8, 4, 2])
        scene = nsfd.Scene({"dimension": np.int64(3), "Mesh/cells": cells})
        scene["Discretization"] = {"a": True, "b": np.float64(0.1), "c": (1.5, "2 mm")}
        self.assertEqual(
            scene.to_dict(),
            {
                "dimension": "3",
                "Mesh": {"cells": "8, 4, 2"},
                "Discretization": {"a": "true", "b": "0.1", "c": "1.5, 2 mm"},
            },
        )
        for value in ("1 # 2", "a\nb", "a \\", None, {1, 2}):
            with self.assertRaises((ValueError, TypeError)):
                scene["Mesh/cells"] = value
        with self.assertRaisesRegex(TypeError, "'Mesh/cells'"):
            scene["Mesh"] = 3
        with self.assertRaisesRegex(KeyError, "there are: cells"):
            scene["Mesh/cels"]
        with self.assertRaisesRegex(FileNotFoundError, "line breaks"):
            nsfd.Scene("set dimension = 2")

    def test_lines_that_go_on_and_odd_spellings(self):
        scene = nsfd.Scene(
            "SET dimension = 2\n"
            "\tset  plane\t=  strain # as thick as it is\n"
            "subsection  Interface :  all  faces\n"
            "  set where = x < 1 \\  # one\n"
            "  # of\n"
            "              && y < 2\n"
            "  set law = rigid\n"
            "END\n"
        )
        self.assertEqual(scene["plane"], "strain")
        where = "Interface: all faces/where"
        self.assertEqual(scene[where], "x < 1 && y < 2")
        self.assertEqual([scene.entry_at(k) for k in (3, 4, 6, 8)],
                         ["Interface: all faces", where, where, None])
        scene[where] = "all"
        self.assertEqual(
            scene["Interface: all faces"], {"where": "all", "law": "rigid"}
        )
        self.assertEqual(len(scene.text.splitlines()), 6)

    def test_included_entries_are_read_and_not_changed(self):
        scene = nsfd.Scene(PRM / "studies" / "mode_convergence.prm")
        self.assertEqual(scene["Discretization/degree"], "2")
        self.assertEqual(scene["Vary: mesh/Mesh/cells"], "[n, 1]")
        self.assertTrue(scene.is_study())
        self.assertFalse(nsfd.Scene(MODE).is_study())
        for change in (
            lambda: scene.update({"Discretization/degree": 3}),
            lambda: scene.update({"Discretization/mass": "lumped"}),
            lambda: scene.pop("Discretization/degree"),
            lambda: scene.pop("Discretization"),
        ):
            with self.assertRaisesRegex(ValueError, "mode.prm', which the scene incl"):
                change()
        scene["Study/size"] = "2 / n"
        again = nsfd.Scene(scene.text, folder=scene.folder)
        self.assertEqual(again["Study/size"], "2 / n")


class Folders(InScratch):
    def test_names_of_files_are_relative_to_the_scene(self):
        (self.scratch / "scenes").mkdir()
        (self.scratch / "curves").mkdir()
        # a triangle: the toughness is 1 kPa * 1 mm / 2
        (self.scratch / "curves" / "curve.csv").write_text("0.0001, 1e3\n0.001, 0\n")
        path = self.scratch / "scenes" / "pulled.prm"
        scene = nsfd.Scene(HALVES)
        scene["Interface: middle"] = {
            "where": "abs(x - 1) < 0.01",
            "law": "tabulated",
            "curve": "../curves/curve.csv",
        }
        scene["Time"] = {"end": "2 ms", "step": "0.1 ms"}
        scene.save(path)
        text = nsfd.Scene(scene.text, folder=path.parent)
        changed = nsfd.Scene(path)
        changed["Output/fields every"] = "0.5 ms"
        for number, one in enumerate((path, text, changed)):
            run = nsfd.run(one, output=self.scratch / str(number))
            # the halves fly apart by some mm, and 4 m have taken 0.5 J/m^2
            self.assertAlmostEqual(run.history["damage"][-1] / 2, 1, delta=1e-6)
        self.assertEqual(os.listdir(path.parent), ["pulled.prm"])
        elsewhere = nsfd.Scene(scene.text, folder=self.scratch)
        with self.assertRaises(nsfd.InputError) as caught:
            nsfd.run(elsewhere, output=self.scratch / "d")
        self.assertEqual(caught.exception.entry, "Interface: middle/curve")

    def test_a_folder_that_cannot_be_written_to(self):
        locked = self.scratch / "locked"
        with self.assertRaisesRegex(OSError, "give Scene another folder"):
            nsfd.run(nsfd.Scene(HALVES, folder=locked), output=self.scratch / "run")


def complete(scene):
    """The complete file, all defaults included, as the program prints it."""
    program = os.environ.get("NSFD") or shutil.which("nsfd") or str(SOURCE / "nsfd")
    with scene.as_file() as file:
        words = [program, str(file), "--print-parameters"]
        echo = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    return [line for line in echo.splitlines() if line and line[0] != "#"]


if __name__ == "__main__":
    unittest.main()
