"""RESQML packages of all kinds, written and read back by resqpy.

    tests/resqml.py FOLDER

writes packages into a folder, each `NAME.epc` with its `NAME.h5`, and beside it `NAME.json`: what resqpy itself reads
there, in map coordinates with depth downward and layers from the top. Ends with 77 where a package is missing.
"""

import json
import logging
import sys
from pathlib import Path

try:
    import numpy as np
    import resqpy.crs as rqc
    import resqpy.grid as rqg
    import resqpy.model as rq
    import resqpy.property as rqp
    import resqpy.rq_import as rqi
    import resqpy.time_series as rqt
except ImportError as error:
    print(f"{error.name} is missing: pip install numpy resqpy")
    sys.exit(77)

logging.disable(logging.CRITICAL)
WHO = {"originator": "test"}


def corners(ni, nj, nk, throw=0.0, bend=0.0, gap=None, upward=False):
    """Corner points, indices k, j, i, then of the corner, then x, y, z; the eastern half is thrown down."""
    points = np.empty((nk, nj, ni, 2, 2, 2, 3))
    for k, j, i, kp, jp, ip in np.ndindex(points.shape[:-1]):
        row, column = j + jp, i + ip
        depth = 1000.0 + 3.0 * row + 2.0 * column + 10.0 * (k + kp) + throw * (i >= (ni + 1) // 2)
        depth += 0.0 if gap is None or k < gap else 4.0
        x = 50.0 * column + 2.0 * row + 0.1 * (depth - 1000.0) + bend * (depth - 1000.0) ** 2
        y = 40.0 * row - 0.05 * column * (depth - 1000.0)
        points[k, j, i, kp, jp, ip] = x, y, depth
    if upward:
        points[..., 2] *= -1.0
        points = points[::-1, :, :, ::-1]
    return points


def write(folder, name, *, crs=None, points=None, active=None, parametric=False, nan=None, fill=None, upward=False):
    """A package with one grid of corner points."""
    model = rq.new_model(str(folder / f"{name}.epc"))
    crs = rqc.Crs(model, title="crs", **(crs or {}))
    crs.create_xml(**WHO)
    grid = rqi.grid_from_cp(model, points, crs.uuid, active_mask=active, max_z_void=0.1, treat_as_nan=nan)
    grid.title = f"grid of {name}"
    grid.k_direction_is_down = not upward
    grid.write_hdf5(use_parametric_lines=parametric)
    grid.create_xml(title=grid.title, use_parametric_lines=parametric, **WHO)
    if fill:
        fill(model, grid)
    model.store_epc()
    return model


def add(model, grid, title, values, kind, **options):
    rqp.Property.from_array(
        model, values, "test", title, grid.uuid, property_kind=kind, indexable_element="cells", **options
    )


def properties(model, grid):
    """Properties of every kind."""
    shape = tuple(grid.extent_kji)
    number = np.arange(np.prod(shape)).reshape(shape)
    holes = np.where(number % 5 == 1, np.nan, 0.05 + 0.01 * number)
    add(model, grid, "PORO", holes, "porosity", uom="m3/m3")
    add(model, grid, "PERMX", 10.0 + number, "permeability rock", uom="mD", facet_type="direction", facet="I")
    add(model, grid, "net to gross", None, "net to gross ratio", uom="m3/m3", const_value=0.75)
    add(model, grid, "SATNUM", np.where(number % 4 == 3, -1, number % 3), "region initialization", discrete=True,
        null_value=-1)
    lookup = rqp.StringLookup(model, int_to_str_dict={0: "sand", 1: "shale"}, title="facies")
    lookup.create_xml(**WHO)
    add(model, grid, "Facies", number % 2, "facies", discrete=True, string_lookup_uuid=lookup.uuid)
    series = rqt.TimeSeries(model, first_timestamp="2020-01-01", title="series")
    series.add_timestamp("2020-02-01")
    series.add_timestamp("2021-01-01T06:30:00Z")
    series.create_xml(**WHO)
    for step in range(3):
        options = {"time_series_uuid": series.uuid, "time_index": step}
        add(model, grid, "PRESSURE", 200.0 + number - 7.0 * step, "pressure", uom="bar", **options)
        if step > 0:
            add(model, grid, "SWAT", 0.01 * number + 0.1 * step, "saturation", uom="m3/m3", **options)


def few(model, grid):
    """Some of them, for a package of few bytes."""
    number = np.arange(8.0).reshape(2, 2, 2)
    add(model, grid, "PORO", np.where(number == 1, np.nan, 0.125 + number / 64.0), "porosity", uom="m3/m3")
    series = rqt.TimeSeries(model, first_timestamp="2020-01-01", title="series")
    series.add_timestamp("2020-02-01")
    series.create_xml(**WHO)
    for step in range(2):
        options = {"time_series_uuid": series.uuid, "time_index": step}
        add(model, grid, "PRESSURE", 200.0 + number - 8.0 * step, "pressure", uom="bar", **options)


def told(folder, name):
    """What resqpy reads, as JSON."""
    model = rq.Model(str(folder / f"{name}.epc"))
    grid = rqg.Grid(model, uuid=model.uuids(obj_type="IjkGridRepresentation")[0])
    grid.cache_all_geometry_arrays()
    points = grid.corner_points().copy()
    crs = rqc.Crs(model, uuid=grid.crs_uuid)
    crs.local_to_global_array(points.reshape(-1, 3))
    meters = {"m": 1.0, "ft": 0.3048}
    points[..., 2] *= meters[crs.z_units] / meters[crs.xy_units]
    active = ~grid.extract_inactive_mask()
    flip = not grid.k_direction_is_down
    turned = lambda values: values[::-1] if flip else values
    found = {}
    for part in model.parts_list_of_type("DiscreteProperty") + model.parts_list_of_type("ContinuousProperty") \
            + model.parts_list_of_type("CategoricalProperty"):
        one = rqp.Property(model, uuid=model.uuid_for_part(part))
        values = one.array_ref(exclude_null=True, dtype=float)
        if one.null_value() is not None:
            values = np.where(values == one.null_value(), np.nan, values)
        steps = found.setdefault(one.title, {})
        step = "static" if one.time_index() is None else str(one.time_index())
        steps[step] = [None if np.isnan(v) else float(v) for v in turned(np.asarray(values, float)).ravel()]
    series = model.uuid(obj_type="TimeSeries")
    text = {
        "dims": [int(n) for n in reversed(grid.extent_kji)],
        "unit": {"m": "METRES", "ft": "FEET"}[crs.xy_units],
        "active": [bool(a) for a in turned(active).ravel()],
        "corners": (points[::-1, :, :, ::-1] if flip else points).ravel().round(9).tolist(),
        "properties": found,
        "times": [] if series is None else rqt.TimeSeries(model, uuid=series).timestamps,
    }
    # Geometry that is not defined is no number.
    text["corners"] = [None if np.isnan(v) else v for v in text["corners"]]
    (folder / f"{name}.json").write_text(json.dumps(text))


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    hole = np.ones((3, 3, 4), bool)
    hole[1, 2, 3] = hole[0, 0, 0] = False
    turned = {"x_offset": 431000.5, "y_offset": 6521000.25, "z_offset": 25.0, "rotation": 30.0, "rotation_units": "dega"}
    whole = corners(4, 3, 3)
    corner = np.ones((3, 3, 4), bool)
    corner[:, 0, 0] = False
    packages = {
        "plain": {"points": whole},
        "faulted": {"points": corners(4, 3, 3, throw=15.0), "crs": turned, "active": hole, "fill": properties},
        "lines": {"points": corners(4, 3, 3, throw=15.0), "parametric": True},
        "gaps": {"points": corners(4, 3, 3, throw=15.0, gap=2)},
        "upward": {"points": corners(4, 3, 3, throw=15.0, gap=2, upward=True), "upward": True, "crs": {"z_inc_down": False, "rotation": -20.0,
                   "rotation_units": "dega", "z_offset": 100.0}, "fill": properties},
        "mixed": {"points": corners(3, 2, 2), "crs": {"xy_units": "m", "z_units": "ft"}},
        "feet": {"points": corners(3, 2, 2), "crs": {"xy_units": "ft", "z_units": "ft", "axis_order": "northing easting"}},
        "undefined": {"points": whole, "active": corner, "nan": "inactive"},
        "bent": {"points": corners(4, 3, 3, bend=0.002)},
        "small": {"points": corners(2, 2, 2, throw=15.0), "active": np.arange(8).reshape(2, 2, 2) != 5,
                  "fill": few},
    }
    for name, options in packages.items():
        write(folder, name, **options)
        told(folder, name)


main(Path(sys.argv[1]))
