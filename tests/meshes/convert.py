#!/usr/bin/python3
"""Writes the files of tests/meshes that meshio, VTK and netCDF make.

Debian's python3-meshio (5.0.0), python3-vtk9 (9.1.0) and python3-netcdf4; run it
in tests/meshes.
"""
import meshio
import netCDF4
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk

plate = meshio.read("plate_22_ascii.msh")
for name in ["plate_meshio.vtu", "plate_meshio.vtk", "plate_meshio.inp"]:
    plate.write(name)

# names, which meshio gives to sets of points only
block = meshio.read("block_hexes.msh")
x = block.points
block.point_sets = {
    "ground": numpy.flatnonzero(x[:, 2] == x[:, 2].min()),
    "lid": numpy.flatnonzero(x[:, 2] == x[:, 2].max()),
}
hexes = meshio.Mesh(
    block.points, [c for c in block.cells if c.type == "hexahedron"],
    point_sets=block.point_sets)
hexes.write("block_meshio.e")


def grid():
    """Cells, the curves of the drawing, and values of cells of every kind."""
    result = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(plate.points, deep=True))
    result.SetPoints(points)
    kinds = {"line": vtk.VTK_LINE, "triangle": vtk.VTK_TRIANGLE}
    numbers, quality, angles = [], [], []
    for cells, material in zip(plate.cells, plate.cell_data["gmsh:physical"]):
        for corners, number in zip(cells.data, material):
            ids = vtk.vtkIdList()
            for corner in corners:
                ids.InsertNextId(int(corner))
            result.InsertNextCell(kinds[cells.type], ids)
            numbers.append(number)
            quality.append(0.5 * number)
            angles.append([10.0 * number, 20.0, 30.0])
    for name, values, kind in [
            ("MaterialID", numbers, numpy.int32),
            ("phase", numpy.array(numbers) + 100, numpy.uint8),
            ("quality", quality, numpy.float64),
            ("orientation", angles, numpy.float32)]:
        array = numpy_to_vtk(numpy.array(values, dtype=kind), deep=True)
        array.SetName(name)
        result.GetCellData().AddArray(array)
    return result


def write_xml(name, mode, compressed, bits, encoded=True):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid())
    writer.SetFileName(name)
    getattr(writer, "SetDataModeTo" + mode)()
    if not compressed:
        writer.SetCompressorTypeToNone()
    getattr(writer, f"SetHeaderTypeToUInt{bits}")()
    writer.SetEncodeAppendedData(encoded)
    writer.Write()


def write_legacy(name, binary, version):
    writer = vtk.vtkUnstructuredGridWriter()
    writer.SetInputData(grid())
    writer.SetFileName(name)
    writer.SetFileVersion(version)
    writer.SetFileTypeToBinary() if binary else writer.SetFileTypeToASCII()
    writer.Write()


write_xml("plate_vtk_ascii.vtu", "Ascii", False, 32)
write_xml("plate_vtk_inline.vtu", "Binary", False, 64)
write_xml("plate_vtk_base64.vtu", "Appended", True, 32)
write_xml("plate_vtk_raw.vtu", "Appended", True, 64, encoded=False)
write_legacy("plate_vtk_binary.vtk", True, vtk.vtkUnstructuredGridWriter.VTK_LEGACY_READER_VERSION_5_1)
write_legacy("plate_vtk_ascii.vtk", False, vtk.vtkUnstructuredGridWriter.VTK_LEGACY_READER_VERSION_4_2)

# one block per material, as the Exodus writer of ParaView makes it
parts = vtk.vtkMultiBlockDataSet()
whole = grid()
materials = numpy.concatenate(plate.cell_data["gmsh:physical"])
for number in (1, 2):
    chosen = vtk.vtkExtractCells()
    chosen.SetInputData(whole)
    ids = vtk.vtkIdList()
    for cell in numpy.flatnonzero(materials == number):
        ids.InsertNextId(int(cell))
    chosen.SetCellList(ids)
    chosen.Update()
    parts.SetBlock(number - 1, chosen.GetOutput())
writer = vtk.vtkExodusIIWriter()
writer.SetInputData(parts)
writer.SetFileName("plate_vtk.e")
writer.WriteOutBlockIdArrayOff()
writer.WriteOutGlobalNodeIdArrayOff()
writer.WriteOutGlobalElementIdArrayOff()
writer.Write()


def write_exodus(name, layout):
    """A hex, a tetrahedron and a prism apart, in the layout of SEACAS's library.

    All of their sides are the side set `outside`, and the variable `damage` has
    two times.
    """
    cube = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
            (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    tetrahedron = [(2, 0, 0), (3, 0, 0), (2, 1, 0), (2, 0, 1)]
    prism = [(4, 0, 0), (5, 0, 0), (4, 1, 0), (4, 0, 1), (5, 0, 1), (4, 1, 1)]
    nodes = numpy.array(cube + tetrahedron + prism, dtype=float)
    blocks = [("HEX8", "cube", range(0, 8), 6),
              ("TETRA", "pyramid of three", range(8, 12), 4),
              ("WEDGE6", "", range(12, 18), 5)]
    with netCDF4.Dataset(name, "w", format=layout) as file:
        for key, length in [("len_string", 33), ("len_name", 33),
                            ("time_step", None), ("num_dim", 3),
                            ("num_nodes", len(nodes)), ("num_elem", 3),
                            ("num_el_blk", 3), ("num_side_sets", 1),
                            ("num_side_ss1", 15), ("num_elem_var", 1)]:
            file.createDimension(key, length)

        def texts(variable, dimension, words):
            values = numpy.zeros((len(words), 33), dtype="S1")
            for row, word in zip(values, words):
                row[:len(word)] = list(word)
            file.createVariable(variable, "S1", (dimension, "len_name"))[:] = values

        file.createVariable("time_whole", "f8", ("time_step",))[:] = [0.0, 1.0]
        for d, axis in enumerate("xyz"):
            file.createVariable("coord" + axis, "f8", ("num_nodes",))[:] = nodes[:, d]
        file.createVariable("eb_prop1", "i4", ("num_el_blk",))[:] = [10, 20, 30]
        texts("eb_names", "num_el_blk", [block[1] for block in blocks])
        file.createVariable("ss_prop1", "i4", ("num_side_sets",))[:] = [7]
        texts("ss_names", "num_side_sets", ["outside"])
        texts("name_elem_var", "num_elem_var", ["damage"])
        elements, sides = [], []
        for k, (kind, _, corners, n_sides) in enumerate(blocks, 1):
            file.createDimension(f"num_el_in_blk{k}", 1)
            file.createDimension(f"num_nod_per_el{k}", len(corners))
            connect = file.createVariable(
                f"connect{k}", "i4", (f"num_el_in_blk{k}", f"num_nod_per_el{k}"))
            connect.elem_type = kind
            connect[:] = [[corner + 1 for corner in corners]]
            damage = file.createVariable(
                f"vals_elem_var1eb{k}", "f8", ("time_step", f"num_el_in_blk{k}"))
            damage[:] = [[-1.0], [0.25 * k]]
            elements += [k] * n_sides
            sides += range(1, n_sides + 1)
        file.createVariable("elem_ss1", "i4", ("num_side_ss1",))[:] = elements
        file.createVariable("side_ss1", "i4", ("num_side_ss1",))[:] = sides


write_exodus("block_sides.e", "NETCDF3_CLASSIC")
write_exodus("block_sides_cdf5.exo", "NETCDF3_64BIT_DATA")
