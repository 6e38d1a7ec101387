"""Files of the VTKHDF format against its specification (docs.vtk.org, "VTKHDF File
Format", unstructured grids with a group Steps) and against the VTU files."""

import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

import nsfd
from nsfd.program import find_program
from common import HALVES, MODE, PRM, InScratch

PLATE = PRM / "benchmarks" / "fracture_extrinsic.prm"
BRICK = PRM / "benchmarks" / "fracture_tetrahedra.prm"
ADAPTIVE = PRM / "benchmarks" / "dcb.prm"


def check(case, path):
    """Every rule that the specification has for the file; its number of times."""
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        version = root.attrs["Version"]
        case.assertEqual((version.shape, version.dtype.kind), ((2,), "i"))
        case.assertEqual(version[0], 2)
        kind = root.attrs.get_id("Type").get_type()
        case.assertFalse(kind.is_variable_str())
        case.assertEqual(kind.get_cset(), h5py.h5t.CSET_ASCII)
        case.assertEqual(root.attrs["Type"], b"UnstructuredGrid")
        steps = root["Steps"]
        n = int(steps.attrs["NSteps"])
        for name in ("Values", "PartOffsets", "NumberOfParts", "PointOffsets"):
            case.assertEqual(steps[name].shape, (n,), name)
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            case.assertEqual(steps[name].shape, (n, 1), name)
        case.assertTrue(np.all(np.diff(steps["Values"][()]) > 0))
        # parts lie behind each other
        points, cells, entries = (
            root[f"NumberOf{what}"][()]
            for what in ("Points", "Cells", "ConnectivityIds")
        )
        parts = len(points)
        case.assertEqual((len(cells), len(entries)), (parts, parts))
        case.assertEqual(root["Points"].shape, (points.sum(), 3))
        case.assertEqual(root["Points"].dtype, "f8")
        case.assertEqual(root["Types"].shape, (cells.sum(),))
        case.assertEqual(root["Types"].dtype, "u1")
        case.assertEqual(root["Connectivity"].shape, (entries.sum(),))
        case.assertEqual(root["Offsets"].shape, (cells.sum() + parts,))
        first_point, first_cell, first_entry = (
            np.cumsum([0, *sizes]) for sizes in (points, cells, entries)
        )
        for part in range(parts):
            begin, end = first_cell[part] + part, first_cell[part + 1] + part + 1
            offsets = root["Offsets"][begin:end]
            case.assertEqual((offsets[0], offsets[-1]), (0, entries[part]))
            case.assertTrue(np.all(np.diff(offsets) > 0))
            corners = root["Connectivity"][first_entry[part] : first_entry[part + 1]]
            if corners.size:
                case.assertGreaterEqual(corners.min(), 0)
                case.assertLess(corners.max(), points[part])
        used = steps["PartOffsets"][()]
        case.assertEqual(sorted(set(used)), list(range(parts)))
        np.testing.assert_array_equal(steps["NumberOfParts"], 1)
        np.testing.assert_array_equal(steps["PointOffsets"], first_point[used])
        np.testing.assert_array_equal(steps["CellOffsets"][:, 0], first_cell[used])
        np.testing.assert_array_equal(
            steps["ConnectivityIdOffsets"][:, 0], first_entry[used]
        )
        for kind, sizes in (("PointData", points), ("CellData", cells)):
            case.assertEqual(set(root[kind]), set(steps[f"{kind}Offsets"]))
            begins = np.cumsum([0, *sizes[used]])
            for name, data in root[kind].items():
                case.assertEqual(data.shape[0], begins[-1], name)
                np.testing.assert_array_equal(
                    steps[f"{kind}Offsets"][name], begins[:-1], name
                )
        for name, data in root["FieldData"].items():
            np.testing.assert_array_equal(steps["FieldDataOffsets"][name], 0)
            np.testing.assert_array_equal(
                steps["FieldDataSizes"][name], [[1, data.shape[0]]] * n
            )
        return n


def series_size(folder, ending):
    return sum(
        file.stat().st_size
        for base in ("fields", "interfaces")
        for file in folder.glob(f"{base}*{ending}")
    )


class Vtkhdf(InScratch):
    def both(self, scene, ranks=1, **settings):
        """A run in both formats."""
        runs = []
        for form in ("vtu", "vtkhdf"):
            output = {**settings.get("Output", {}), "format": form}
            folder = self.scratch / f"{form}{ranks}"
            runs.append(
                nsfd.run(
                    scene,
                    output=folder,
                    ranks=ranks,
                    **{**settings, "Output": output},
                )
            )
        return runs

    def compare(self, vtu, hdf):
        for name in ("fields", "interfaces"):
            a, b = getattr(vtu, name), getattr(hdf, name)
            self.assertEqual(check(self, hdf.folder / f"{name}.vtkhdf"), len(a))
            np.testing.assert_array_equal(a.times, b.times)
            for one, two in zip(a, b):
                np.testing.assert_array_equal(one.points, two.points)
                np.testing.assert_array_equal(one.connectivity, two.connectivity)
                np.testing.assert_array_equal(one.offsets, two.offsets)
                np.testing.assert_array_equal(one.types, two.types)
                for data in ("point_data", "cell_data"):
                    one_data, two_data = getattr(one, data), getattr(two, data)
                    self.assertEqual(list(one_data), sorted(two_data, key=list(one_data).index))
                    for key in one_data:
                        self.assertEqual(one_data[key].dtype, two_data[key].dtype, key)
                        np.testing.assert_array_equal(one_data[key], two_data[key])
                self.assertEqual(one.names, two.names)

    def test_plane_with_cracks(self):
        vtu, hdf = self.both(PLATE, Output={"fields every steps": 100})
        self.compare(vtu, hdf)
        last = hdf.interfaces[-1]
        self.assertEqual(last["kind"].dtype, "u1")
        self.assertEqual(last["block"].dtype, "i4")
        self.assertEqual(last.names["kind"][4], "free")
        self.assertEqual(len(last.names["block"]), len(set(last["block"])))
        # a point for each fragment, as in fragments.csv
        check(self, hdf.folder / "fragments.vtkhdf")
        with h5py.File(hdf.folder / "fragments.vtkhdf", "r") as file:
            root = file["VTKHDF"]
            table = hdf.fragments
            np.testing.assert_array_equal(root["PointData/mass"], table["mass"])
            np.testing.assert_array_equal(root["PointData/fragment"], table["fragment"])
            np.testing.assert_array_equal(
                root["PointData/velocity"][:, 0], table["vx"]
            )
            self.assertEqual(root["PointData/mass"].attrs["unit"], b"kg/m")

    def test_space_and_two_ranks(self):
        for ranks in (1, 2):
            _, hdf = self.both(BRICK, ranks, Time={"end": "1 ns"}, Output={})
            n = check(self, hdf.folder / "fields.vtkhdf")
            self.assertEqual(n, len(hdf.fields))
            volume = nsfd.load(self.scratch / "vtu1").fields[-1]
            self.assertEqual(len(volume.types), len(hdf.fields[-1].types))
            np.testing.assert_array_equal(
                np.sort(volume["displacement"], 0),
                np.sort(hdf.fields[-1]["displacement"], 0),
            )

    def test_a_mesh_that_changes(self):
        vtu, hdf = self.both(
            ADAPTIVE, Time={"end": "500 us"}, Output={"fields every": "50 us"}
        )
        self.compare(vtu, hdf)
        with h5py.File(hdf.folder / "fields.vtkhdf", "r") as file:
            self.assertGreater(len(set(file["VTKHDF/NumberOfPoints"][()])), 1)

    def test_a_hundred_pictures_are_not_larger(self):
        vtu, hdf = self.both(MODE, Output={"fields every steps": 7})
        self.assertGreater(len(vtu.fields), 100)
        small = series_size(hdf.folder, ".vtkhdf")
        self.assertLess(small, 1.1 * series_size(vtu.folder, ".vtu"))

    def test_killed_and_resumed(self):
        settings = {
            "Time": {"end": "30 us"},
            "Output": {
                "format": "vtkhdf",
                "fields every steps": 1,
                "checkpoint every steps": 5,
            },
        }
        whole = nsfd.run(MODE, output=self.scratch / "whole", **settings)
        scene = nsfd.Scene(MODE)
        for section, entries in settings.items():
            for entry, value in entries.items():
                scene[f"{section}/{entry}"] = value
        folder = self.scratch / "killed"
        file = self.scratch / "scene.prm"
        scene.save(file)
        child = subprocess.Popen(
            [find_program(), file, "--quiet", "--output", folder]
        )
        deadline = time.time() + 60
        while not (folder / "checkpoint.h5").exists() and time.time() < deadline:
            time.sleep(0.01)
        child.send_signal(signal.SIGKILL)
        child.wait()
        resumed = nsfd.run(file, output=folder, resume=True)
        n = check(self, folder / "fields.vtkhdf")
        self.assertEqual(n, len(resumed.fields))
        if not (folder / "fields_damaged.vtkhdf").exists():
            np.testing.assert_array_equal(resumed.fields.times, whole.fields.times)
            np.testing.assert_array_equal(
                resumed.fields[-1]["displacement"], whole.fields[-1]["displacement"]
            )

    def test_names_and_integers_in_all_formats(self):
        for form in ("vtu", "hdf5", "vtkhdf"):
            run = nsfd.run(
                nsfd.Scene(HALVES, name="halves"),
                output=self.scratch / form,
                Output={"format": form},
            )
            grid = run.fields[-1]
            self.assertEqual(grid.names["material"], ["left", "right"])
            self.assertEqual(grid["fragment"].dtype.kind, "i")
            self.assertEqual(run.interfaces[-1].names["block"], ["middle", "joints"])


if __name__ == "__main__":
    unittest.main()
