"""Fields of a run over time: VTU files, HDF5 with an XDMF file, or VTKHDF."""

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .errors import Error

_TYPES = {
    "Float64": "<f8",
    "Float32": "<f4",
    "Int64": "<i8",
    "UInt64": "<u8",
    "Int32": "<i4",
    "UInt32": "<u4",
    "UInt8": "u1",
    "Int8": "i1",
}
# of XDMF: the shape of VTK, and its corners (None: their number follows)
_SHAPES = {
    1: (2, None),
    2: (3, None),
    3: (7, None),
    4: (5, 3),
    5: (9, 4),
    6: (10, 4),
    9: (12, 8),
}


class Grid:
    """Points and cells with data at one time, all of the undeformed mesh.

    points has the shape (points, 3); connectivity, offsets and types are those
    of VTK: offsets[c] ends the corners of cell c, types[c] is the number of its
    shape. point_data and cell_data have arrays by name, of the shape (n,) or
    (n, components). grid["stress"] looks in both. names["kind"] is a list with
    what the numbers of an array of codes mean."""

    def __init__(
        self,
        time,
        points,
        connectivity,
        offsets,
        types,
        point_data,
        cell_data,
        names=None,
    ):
        self.time, self.points = time, points
        self.connectivity, self.offsets, self.types = connectivity, offsets, types
        self.point_data, self.cell_data = point_data, cell_data
        self.names = names or {}

    @property
    def cells(self):
        """Numbers of the corners, (cells, corners), of cells of one shape."""
        corners = np.diff(self.offsets, prepend=0)
        if corners.size and np.any(corners != corners[0]):
            raise Error(
                "these cells have different numbers of corners: use connectivity "
                "and offsets"
            )
        return self.connectivity.reshape(corners.size, -1)

    def __getitem__(self, name):
        for data in (self.point_data, self.cell_data):
            if name in data:
                return data[name]
        known = ", ".join([*self.point_data, *self.cell_data])
        raise KeyError(f"there is no field {name!r}; there are {known}")

    def __repr__(self):
        names = ", ".join([*self.point_data, *self.cell_data])
        return (
            f"<t = {self.time:.6g} s, {len(self.points)} points, "
            f"{len(self.types)} cells: {names}>"
        )


class Series(Sequence):
    """The Grids of a run: series[0], series[-1], series.at(time); times is an
    array in s. Files are read when a Grid is asked for."""

    def __init__(self, times, read):
        self.times = np.array(times, dtype=float)
        self._read = read

    def __len__(self):
        return len(self.times)

    def __getitem__(self, number):
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        if not -len(self) <= number < len(self):
            raise IndexError(f"there are {len(self)} times, no number {number}")
        number %= len(self)
        return self._read(number)

    def at(self, time):
        """The Grid whose time is nearest."""
        if not len(self):
            raise IndexError("there are no fields: see section Output of the scene")
        return self[int(np.argmin(np.abs(self.times - time)))]

    def __repr__(self):
        return f"<{len(self)} times>"


def read_series(folder, name):
    """The Series fields or interfaces in a folder; empty if there is none."""
    folder = Path(folder)
    if (folder / f"{name}.vtkhdf").exists():
        return _vtkhdf_series(folder / f"{name}.vtkhdf")
    if (folder / f"{name}.xdmf").exists():
        return _xdmf_series(folder, name)
    file = folder / f"{name}.pvd"
    if not file.exists():
        return Series([], None)
    sets = ElementTree.parse(file).getroot().iter("DataSet")
    entries = [(float(one.get("timestep")), one.get("file")) for one in sets]
    return Series(
        [time for time, _ in entries],
        lambda k: _read_vtk(folder / entries[k][1], entries[k][0]),
    )


def _read_vtk(path, time):
    if path.suffix == ".pvtu":
        pieces = ElementTree.parse(path).getroot().iter("Piece")
        parts = [_read_vtu(path.parent / one.get("Source")) for one in pieces]
    else:
        parts = [_read_vtu(path)]
    points, connectivity, offsets, types, point_data, cell_data, names = zip(*parts)
    first_point = np.cumsum([0, *map(len, points)])
    first_entry = np.cumsum([0, *map(len, connectivity)])

    def joined(data):
        return {name: np.concatenate([one[name] for one in data]) for name in data[0]}

    return Grid(
        time,
        np.concatenate(points),
        np.concatenate([a + b for a, b in zip(connectivity, first_point)]),
        np.concatenate([a + b for a, b in zip(offsets, first_entry)]),
        np.concatenate(types),
        joined(point_data),
        joined(cell_data),
        names[0],
    )


def _read_vtu(path):
    """What nsfd writes: arrays as they are, behind the text of the file."""
    content = path.read_bytes()
    mark = re.search(rb'<AppendedData encoding="raw">\s*_', content)
    if not mark:
        raise Error(f"'{path}' is not a file of nsfd: its data are not appended raw")
    root = ElementTree.fromstring(content[: mark.start()] + b"</VTKFile>")

    def array(node):
        begin = mark.end() + int(node.get("offset"))
        (size,) = np.frombuffer(content, "<u8", 1, begin)
        kind = np.dtype(_TYPES[node.get("type")])
        values = np.frombuffer(content, kind, int(size) // kind.itemsize, begin + 8)
        components = int(node.get("NumberOfComponents", 1))
        return values.reshape(-1, components) if components > 1 else values

    def arrays(section):
        nodes = root.iterfind(f".//{section}/DataArray")
        return {node.get("Name"): array(node) for node in nodes}

    def texts(node):
        codes = [int(code) for code in (node.text or "").split()]
        return bytes(codes).decode("utf-8", "replace").split("\0")[:-1]

    cells = arrays("Cells")
    return (
        arrays("Points")["Points"],
        cells["connectivity"],
        cells["offsets"],
        cells["types"],
        arrays("PointData"),
        arrays("CellData"),
        {
            _array_of(node.get("Name")): texts(node)
            for node in root.iterfind(".//FieldData/DataArray")
            if node.get("type") == "String"
        },
    )


def _array_of(names):
    return names.removesuffix("_names")


def _texts(group):
    return {_array_of(key): list(value.asstr()[()]) for key, value in group.items()}


def _vtkhdf_series(path):
    import h5py

    with h5py.File(path, "r") as file:
        steps = file["VTKHDF/Steps"]
        times = steps["Values"][: int(steps.attrs["NSteps"])]

    def read(number):
        with h5py.File(path, "r") as file:
            root = file["VTKHDF"]
            steps = root["Steps"]
            part, point = steps["PartOffsets"][number], steps["PointOffsets"][number]
            cell = steps["CellOffsets"][number, 0]
            entry = steps["ConnectivityIdOffsets"][number, 0]
            n_points, n_cells, n_entries = (
                root[f"NumberOf{what}"][part]
                for what in ("Points", "Cells", "ConnectivityIds")
            )

            def data(kind, rows):
                begin = {
                    key: value[number]
                    for key, value in steps[f"{kind}Offsets"].items()
                }
                return {
                    key: value[begin[key] : begin[key] + rows]
                    for key, value in root[kind].items()
                }

            # each mesh has a zero before the ends of its cells
            first = cell + part + 1
            return Grid(
                float(times[number]),
                root["Points"][point : point + n_points],
                root["Connectivity"][entry : entry + n_entries],
                root["Offsets"][first : first + n_cells],
                root["Types"][cell : cell + n_cells],
                data("PointData", n_points),
                data("CellData", n_cells),
                _texts(root["FieldData"]),
            )

    return Series(times, read)


def _xdmf_series(folder, name):
    grids = ElementTree.parse(folder / f"{name}.xdmf").getroot()
    entries = [
        (float(one.find("Time").get("Value")), one.get("Name"))
        for one in grids.iter("Grid")
        if one.find("Time") is not None
    ]

    def read(number):
        import h5py

        time, group = entries[number]
        with h5py.File(folder / f"{name}.h5", "r") as file:
            part = file[group]

            def data(kind):
                return {key: _columns(value[()]) for key, value in part[kind].items()}

            cells = _from_mixed(part["cells"][()])
            return Grid(
                time,
                part["points"][()],
                *cells,
                data("point_data"),
                data("cell_data"),
                _texts(file["names"]) if "names" in file else {},
            )

    return Series([time for time, _ in entries], read)


def _columns(values):
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values


def _from_mixed(topology):
    """connectivity, offsets and types from shape, corners, shape, corners, ..."""
    if not topology.size:
        return topology, topology, topology.astype("u1")
    shape, corners = _SHAPES[int(topology[0])]
    head = 1 if corners else 2
    corners = corners or int(topology[1])
    # as a rule all cells are of one shape
    if topology.size % (head + corners) == 0:
        table = topology.reshape(-1, head + corners)
        if np.all(table[:, :head] == table[0, :head]):
            return (
                table[:, head:].ravel(),
                corners * np.arange(1, len(table) + 1),
                np.full(len(table), shape, "u1"),
            )
    connectivity, offsets, types, at = [], [], [], 0
    while at < topology.size:
        shape, corners = _SHAPES[int(topology[at])]
        at += 1
        if corners is None:
            corners = int(topology[at])
            at += 1
        connectivity.extend(topology[at : at + corners])
        offsets.append(len(connectivity))
        types.append(shape)
        at += corners
    return np.array(connectivity), np.array(offsets), np.array(types, "u1")
