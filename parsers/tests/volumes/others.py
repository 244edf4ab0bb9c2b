"""Volumes between this crate and other programs.

    tests/volumes/others.py FOLDER

reads what the Rust test has written to FOLDER by segyio, pynrrd, SimpleITK and pyvista, and writes the same volume by
them as `theirs...`, which the test reads. Prints a line for each check and ends with 1 where one fails, with 77 where a
package is missing.
"""

import sys
import warnings
from pathlib import Path

try:
    import nrrd
    import numpy as np
    import pyvista
    import segyio
    import SimpleITK as sitk
except ImportError as error:
    print(f"{error.name} is missing: pip install numpy pynrrd pyvista segyio SimpleITK")
    sys.exit(77)

warnings.filterwarnings("ignore")
failures = 0

DIMS = (7, 5, 4)
ORIGIN = np.array([431000.25, 6470000.5, -12.0])
AXES = np.array([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
SPACING = np.array([12.5, 25.0, 4.0])
I, J, K = np.meshgrid(*[np.arange(n) for n in DIMS], indexing="ij")
VALUES = (I * 7 + J * 13 + K * 29 + I * J) % 101


def check(what, is_right, figure=""):
    global failures
    failures += not is_right
    print(f"{'ok' if is_right else 'FAILED'}: {what} {figure}")


def near(a, b):
    return np.allclose(np.asarray(a, float), np.asarray(b, float), rtol=0, atol=1e-6)


def read_nrrd(path):
    data, head = nrrd.read(str(path))
    check(f"pynrrd {path.name} values", np.array_equal(data, VALUES))
    check(f"pynrrd {path.name} axes", near(head["space directions"], AXES * SPACING[:, None]))
    check(f"pynrrd {path.name} origin", near(head["space origin"], ORIGIN))


def read_sitk(path):
    image = sitk.ReadImage(str(path))
    data = sitk.GetArrayFromImage(image).transpose(2, 1, 0)
    check(f"SimpleITK {path.name} values", np.array_equal(data, VALUES))
    place = image.TransformIndexToPhysicalPoint((6, 4, 3))
    check(f"SimpleITK {path.name} place", near(place, ORIGIN + (np.array([6, 4, 3]) * SPACING) @ AXES))


def read_vti(path):
    image = pyvista.read(path)
    data = image["amplitude"].reshape(DIMS, order="F")
    check(f"pyvista {path.name} values", np.array_equal(data, VALUES))
    last = image.points[-1]
    check(f"pyvista {path.name} place", near(last, ORIGIN + (np.array([6, 4, 3]) * SPACING) @ AXES), f"{last}")


def read_segy(path, code):
    endian = "little" if path.name.startswith("little") else "big"
    with segyio.open(path, endian=endian) as file:
        check(f"segyio {path.name} format", int(file.format) == code, f"{file.format}")
        check(f"segyio {path.name} lattice", list(file.ilines) == list(range(10, 24, 2)) and list(file.xlines) == list(range(20, 25)))
        check(f"segyio {path.name} values", np.array_equal(segyio.tools.cube(file), VALUES))
        check(f"segyio {path.name} samples", near(file.samples, 100 + 4.0 * np.arange(4)))
        head = file.header[8]
        scalar = head[segyio.su.scalco]
        place = np.array([head[segyio.su.cdpx], head[segyio.su.cdpy]]) / -scalar
        check(f"segyio {path.name} place", near(place, (ORIGIN + [0.8 * 12.5, 0.6 * 12.5, 0] + 3 * 25.0 * AXES[1])[:2]), f"{place}")
        check(f"segyio {path.name} text", b"a survey by formula" in bytes(file.text[0]))


def write_nrrd(folder):
    head = {"space dimension": 3, "space directions": AXES * SPACING[:, None], "space origin": ORIGIN}
    for kind in ["uint8", "<f4", ">i2", "float64"]:
        for encoding in ["raw", "gzip", "ascii"]:
            name = f"theirs_{np.dtype(kind).name}_{encoding}"
            data = VALUES.astype(kind)
            nrrd.write(str(folder / f"{name}.nrrd"), data, {**head, "encoding": encoding})
        detached = folder / f"theirs_{np.dtype(kind).name}.nhdr"
        nrrd.write(str(detached), data, {**head, "encoding": "gzip"}, detached_header=True)


def write_sitk(folder):
    for kind in [np.uint8, np.int16, np.float32]:
        image = sitk.GetImageFromArray(np.ascontiguousarray(VALUES.astype(kind).transpose(2, 1, 0)))
        image.SetOrigin(ORIGIN.tolist())
        image.SetSpacing(SPACING.tolist())
        image.SetDirection(AXES.T.ravel().tolist())
        for ending in ["mha", "mhd", "nrrd"]:
            for is_packed in [False, True]:
                name = f"theirs_sitk_{np.dtype(kind).name}_{is_packed}.{ending}"
                sitk.WriteImage(image, str(folder / name), is_packed)


def write_vti(folder):
    import vtk

    image = pyvista.ImageData(dimensions=DIMS, spacing=SPACING, origin=ORIGIN, direction_matrix=AXES.T)
    for kind in [np.uint8, np.float32]:
        image["amplitude"] = VALUES.astype(kind).ravel(order="F")
        for mode, set_mode in [("ascii", "SetDataModeToAscii"), ("binary", "SetDataModeToBinary"), ("appended", "SetDataModeToAppended")]:
            for is_packed in [False, True]:
                for is_encoded in [False, True]:
                    writer = vtk.vtkXMLImageDataWriter()
                    writer.SetInputData(image)
                    writer.SetFileName(str(folder / f"theirs_{np.dtype(kind).name}_{mode}_{is_packed}_{is_encoded}.vti"))
                    getattr(writer, set_mode)()
                    writer.SetEncodeAppendedData(is_encoded)
                    writer.SetBlockSize(64)
                    writer.SetCompressorTypeToZLib() if is_packed else writer.SetCompressorTypeToNone()
                    writer.Write()


def write_segy(folder):
    for code in [1, 5, 2, 3, 8]:
        spec = segyio.spec()
        spec.format = code
        spec.sorting = segyio.TraceSortingFormat.INLINE_SORTING
        spec.ilines = np.arange(DIMS[0]) + 1
        spec.xlines = np.arange(DIMS[1]) + 1
        spec.samples = 100 + 4.0 * np.arange(DIMS[2])
        with segyio.create(folder / f"theirs_{code}.sgy", spec) as file:
            file.bin.update({segyio.BinField.Interval: 4000})
            for n in range(DIMS[0] * DIMS[1]):
                i, j = divmod(n, DIMS[1])
                x, y = (ORIGIN + i * 12.5 * AXES[0] + j * 25.0 * AXES[1])[:2]
                file.header[n] = {
                    segyio.su.iline: i + 1,
                    segyio.su.xline: j + 1,
                    segyio.su.cdpx: round(x * 100),
                    segyio.su.cdpy: round(y * 100),
                    segyio.su.scalco: -100,
                    segyio.su.delrt: 100,
                    segyio.su.ns: DIMS[2],
                    segyio.su.dt: 4000,
                }
                file.trace[n] = VALUES[i, j].astype(file.dtype)


def main(folder):
    for name in ["plain", "packed"]:
        read_nrrd(folder / f"{name}.nrrd")
        read_sitk(folder / f"{name}.mha")
    read_vti(folder / "plain.vti")
    for name, code in [("ibm", 1), ("ieee", 5), ("little", 5)]:
        read_segy(folder / f"{name}.sgy", code)
    write_nrrd(folder)
    write_sitk(folder)
    write_vti(folder)
    write_segy(folder)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
