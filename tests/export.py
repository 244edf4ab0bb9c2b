"""What `strataray export` writes, as other programs read it.

    tests/export.py STRATARAY CASE.EGRID STATIC DYNAMIC

exports a case to every format and reads the files by resfo, xtgeo, pyvista and pyarrow. Grid and values have to be
those of the case's own files, as resfo and xtgeo read these. Prints a line for each check and ends with 1 where one
fails, with 77 where a package is missing.
"""

import csv
import json
import struct
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

try:
    import numpy as np
    import pyarrow.parquet
    import pyvista
    import resfo
    import xtgeo
except ImportError as error:
    print(f"{error.name} is missing: pip install numpy pyarrow pyvista resfo xtgeo")
    sys.exit(77)

warnings.filterwarnings("ignore")
failures = 0


def check(what, is_right, figure=""):
    global failures
    failures += not is_right
    print(f"{'ok' if is_right else 'FAILED'}: {what} {figure}")


def largest(a, b):
    """Largest difference of two arrays; infinite where they do not belong together."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    if a.shape != b.shape:
        return np.inf
    gone = np.isnan(a)
    if (gone != np.isnan(b)).any():
        return np.inf
    return np.abs(a - b)[~gone].max(initial=0.0)


def arrays(path):
    """Arrays of a file by name and number of their appearance."""
    found = {}
    for name, values in resfo.read(path):
        found.setdefault(name.strip(), []).append(values)
    return found


def values(grid, name, path, form, **options):
    """Values of all cells, NaN where inactive."""
    read = xtgeo.gridproperty_from_file(path, name=name, fformat=form, grid=grid, **options)
    masked = np.ma.filled(read.values.astype(np.float64), np.nan)
    return np.where(grid.get_actnum().values == 1, masked, np.nan)


def corners(grid):
    return np.stack([np.ma.filled(c.values, np.nan) for c in grid.get_xyz_corners()])


class Case:
    """A case as xtgeo and resfo read it."""

    def __init__(self, path, static, dynamic):
        self.path, self.static, self.dynamic = path, static, dynamic
        self.grid = xtgeo.grid_from_file(path, fformat="egrid")
        self.actnum = self.grid.get_actnum().values == 1
        self.init, self.restart = path.with_suffix(".INIT"), path.with_suffix(".UNRST")
        self.steps = [self.spread(v) for v in arrays(self.restart)[dynamic]]
        day, month, year = arrays(self.restart)["INTEHEAD"][0][64:67]
        self.first_date = f"{year:04}{month:02}{day:02}"
        init = arrays(self.init)
        self.poro = self.spread(init[static][0])
        # Whole numbers, and values of all cells.
        self.others = [name for name in ("SATNUM", "PORV") if name in init]

    def spread(self, given):
        """Values of active cells, i fastest, as an array of all cells."""
        full = np.full(self.actnum.shape, np.nan)
        flat = full.ravel(order="F")
        flat[self.actnum.ravel(order="F")] = given
        return flat.reshape(self.actnum.shape, order="F")


def eclipse(case, made):
    for ending, names in [
        ("EGRID", ["COORD", "ZCORN"]),
        ("INIT", [case.static, *case.others]),
        ("UNRST", [case.dynamic, "SEQNUM"]),
    ]:
        before, after = [arrays(path.with_suffix(f".{ending}")) for path in (case.path, made)]
        for name in names:
            same = len(before[name]) == len(after.get(name, []))
            pairs = list(zip(before[name], after.get(name, [])))
            same = same and all(a.dtype == b.dtype and np.array_equal(a, b) for a, b in pairs)
            check(f"resfo {ending} {name}: the same bits", same, f"{len(before[name])} arrays")
    grid = xtgeo.grid_from_file(made, fformat="egrid")
    check("xtgeo EGRID corners", largest(corners(grid), corners(case.grid)) == 0.0)
    check("xtgeo EGRID active cells", np.array_equal(grid.get_actnum().values == 1, case.actnum))
    found = values(grid, case.static, made.with_suffix(".INIT"), "init")
    check("xtgeo INIT values", largest(found, case.poro) == 0.0)
    restart = xtgeo.gridproperties_from_file(
        made.with_suffix(".UNRST"), fformat="unrst", names=[case.dynamic], dates="last", grid=grid
    )
    found = np.ma.filled(restart.props[0].values, np.nan)
    check("xtgeo UNRST values of the last date", largest(found, case.steps[-1]) == 0.0)


def text(case, made):
    grid = xtgeo.grid_from_file(made, fformat="grdecl")
    apart = largest(corners(grid), corners(case.grid))
    check("xtgeo GRDECL corners", apart < 1e-3, f"differ by {apart:.2g}")
    for name, path, expected in [
        (case.static, made, case.poro),
        (case.dynamic, made.with_stem(made.stem + "_0000"), case.steps[0]),
    ]:
        apart = largest(values(grid, name, path, "grdecl"), expected)
        check(f"xtgeo GRDECL {name}", apart <= 1e-7 * np.nanmax(expected), f"differ by {apart:.2g}")


def roff(case, made):
    grid = xtgeo.grid_from_file(made, fformat="roff")
    apart = largest(corners(grid), corners(case.grid))
    check("xtgeo ROFF corners in map coordinates", apart < 2e-3, f"differ by {apart:.2g}")
    check("xtgeo ROFF active cells", np.array_equal(grid.get_actnum().values == 1, case.actnum))
    found = values(grid, case.static, made, "roff")
    check(f"xtgeo ROFF {case.static}", largest(found, case.poro) == 0.0)
    name = f"{case.dynamic}_{case.first_date}"
    found = values(grid, name, made, "roff")
    check(f"xtgeo ROFF {name}", largest(found, case.steps[0]) == 0.0)


def vtu(case, made):
    last = made.with_name(f"{made.stem}_{len(case.steps) - 1:04}.vtu")
    mesh = pyvista.read(last)
    check("pyvista VTU cells", mesh.n_cells == case.actnum.sum(), f"{mesh.n_cells}")
    place = tuple(mesh[axis] - 1 for axis in "IJK")
    check(f"pyvista VTU {case.static}", largest(mesh[case.static], case.poro[place]) == 0.0)
    check(f"pyvista VTU {case.dynamic}", largest(mesh[case.dynamic], case.steps[-1][place]) == 0.0)
    # xtgeo's corners are around the upper face first, depths downward; as sets they are the same points.
    found = mesh.points[mesh.cell_connectivity.reshape(-1, 8)] * [1, 1, -1]
    expected = corners(case.grid)[(slice(None), *place)].T.reshape(-1, 8, 3)
    order = [np.lexsort((c[:, :, 2], c[:, :, 1].round(2), c[:, :, 0].round(2))) for c in (found, expected)]
    found, expected = [np.take_along_axis(c, o[:, :, None], 1) for c, o in zip((found, expected), order)]
    apart = largest(found, expected)
    check("pyvista VTU corners in map coordinates", apart < 2e-2, f"differ by {apart:.2g}")
    volumes = mesh.compute_cell_sizes(length=False, area=False)["Volume"]
    bulk = np.ma.filled(case.grid.get_bulk_volume(asmasked=True).values, 0.0).sum()
    part = abs(volumes.sum() / bulk - 1)
    check("pyvista VTU volume is positive and xtgeo's", part < 1e-3, f"but for {part:.1e}")
    series = pyvista.get_reader(made.with_suffix(".pvd"))
    check("pyvista PVD steps", len(series.time_values) == len(case.steps), f"{series.time_values[:3]}...")
    series.set_active_time_point(len(case.steps) - 1)
    check("pyvista PVD last step", largest(series.read()[0][case.dynamic], mesh[case.dynamic]) == 0.0)


def tables(case, csv_path, parquet_path):
    with open(csv_path, newline="") as file:
        rows = list(csv.DictReader(file))
    count = case.actnum.sum() * (1 + len(case.steps))
    check("rows of CSV", len(rows) == count, f"{len(rows)}")
    table = pyarrow.parquet.read_table(parquet_path)
    check("rows and columns of Parquet", table.num_rows == count and table.column_names == list(rows[0]))
    columns = table.to_pydict()
    for name, of_parquet in columns.items():
        of_csv = [row[name] for row in rows]
        if name == "value":
            same = np.array_equal(np.float32(of_csv), np.float32(of_parquet))
        else:
            same = of_csv == ["" if v is None else str(v) for v in of_parquet]
        check(f"CSV and Parquet column {name}", same)
    last = np.asarray(columns["step"], dtype=object) == len(case.steps) - 1
    place = tuple(np.asarray(columns[axis])[last] - 1 for axis in "ijk")
    found = np.asarray(columns["value"], dtype=np.float32)[last]
    check("Parquet values of the last step", largest(found, case.steps[-1][place]) == 0.0)


def gltf(case, made):
    data = made.read_bytes()
    magic, version, length = struct.unpack("<4sII", data[:12])
    check("glTF head", (magic, version, length) == (b"glTF", 2, len(data)))
    size = struct.unpack("<I", data[12:16])[0]
    scene = json.loads(data[20 : 20 + size])
    root = scene["nodes"][0]
    origin = np.asarray(root["extras"]["origin_meters"])
    mesh = pyvista.read(made)
    names = [node["name"] for node in scene["nodes"][1:]]
    check("glTF has a hull", names[0] == "hull", f"beside {len(names) - 1} nodes")
    hull = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    low, high = [np.asarray(hull[end])[[0, 2, 1]] * [1, -1, 1] + origin for end in ("min", "max")]
    # y of the map runs against z of the file.
    found = [[low[0], high[1], low[2]], [high[0], low[1], high[2]]]
    points = corners(case.grid)[:, case.actnum]
    axes = [points[axis::3] for axis in range(3)]
    expected = [[a.min() for a in axes], [a.max() for a in axes]]
    expected[0][2], expected[1][2] = -expected[1][2], -expected[0][2]
    apart = largest(found, expected)
    check("glTF hull in meters on the map", apart < 2e-2, f"differs by {apart:.2g}")
    check("pyvista reads it", mesh.n_blocks > 0, f"{mesh.combine().n_cells} triangles")


def main(program, path, static, dynamic):
    case = Case(Path(path), static, dynamic)
    with tempfile.TemporaryDirectory() as folder:
        files = {}
        for name in ["A.EGRID", "b.grdecl", "c.roff", "d.vtu", "e.csv", "f.parquet", "g.glb"]:
            made = Path(folder) / name
            files[made.suffix] = made
            properties = [dynamic] if made.suffix == ".glb" else [static, dynamic]
            properties += case.others if made.suffix == ".EGRID" else []
            subprocess.run(
                [program, "export", path, "--quiet", "--property", *properties, "-o", made],
                check=True,
                stdout=subprocess.DEVNULL,
            )
        eclipse(case, files[".EGRID"])
        text(case, files[".grdecl"])
        roff(case, files[".roff"])
        vtu(case, files[".vtu"])
        tables(case, files[".csv"], files[".parquet"])
        gltf(case, files[".glb"])
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
