"""Times StrataRay and VTK's mappers of unstructured grids on the same case, view and transfer function.

Run it by `scripts/peers`, which installs what it needs. Each renderer runs in a process of its own, one after the
other, so that its peak memory is known and none can take another down.
"""

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from importlib import metadata
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import resfo
from numpy.typing import NDArray
from PIL import Image

# Extinction per unit length, and color, at positions in the range of values. Points are so close that it does not
# matter whether a renderer interpolates extinction, as VTK does, or opacity, as StrataRay does.
EXTINCTION = [(float(p), float(0.02 + 0.28 * p)) for p in np.linspace(0.0, 1.0, 17)]
COLORS = [(0.0, "#2c3e8f"), (0.33, "#2a9d8f"), (0.67, "#e9c46a"), (1.0, "#c1121f")]
METERS = {"METRES": 1.0, "FEET": 0.3048, "CM": 0.01}
FOVY_DEGREES = 30.0
TURN_DEGREES = 2.0
PEERS = {"Bunyk": "vtkUnstructuredGridVolumeRayCastMapper", "projected tetrahedra": "vtkProjectedTetrahedraMapper"}
ADAPTERS = ["cpu", "llvmpipe"]
STRATEGIES: dict[str, dict[str, Any]] = {
    "PLTS": {"strategy": "plts"},
    "LIBC": {"strategy": "libc"},
    "LIBC, segments": {"strategy": "libc", "libc": {"integration": "segments"}},
}


@dataclass
class Mesh:
    """Hexahedra with values at points, in world space: x east, y north, z up and exaggerated."""

    points: NDArray[np.float64]
    hexahedra: NDArray[np.int64]
    values: NDArray[np.float64]


@dataclass
class Look:
    """What all renderers share: case, size, camera, range of values, unit length of opacity."""

    case: Path
    property: str
    exaggeration: float
    size: tuple[int, int]
    frames: int
    eye: list[float]
    target: list[float]
    range: tuple[float, float]
    unit_length: float


@dataclass
class Result:
    """What a renderer took; times in seconds."""

    renderer: str
    size: tuple[int, int]
    first_s: float
    first_cpu_s: float
    frame_s: float
    frame_cpu_s: float
    peak_mb: float
    image: Path
    covered_pixels: int = 0
    difference: float | None = None


class NotRun(Exception):
    """Why a renderer, or all of them, cannot be run, as a sentence."""


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of an Eclipse file by name; of repeated names the first, which is the global grid's."""
    arrays: dict[str, NDArray[Any]] = {}
    try:
        for name, array in resfo.read(path):
            arrays.setdefault(name.strip(), array)
    except (OSError, resfo.ResfoParsingError) as error:
        raise NotRun(f"{path} cannot be read: {error}") from error
    return arrays


def world_from_grid(arrays: dict[str, NDArray[Any]], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points with MAPAXES applied, in the grid's unit."""
    words = [word.decode().strip() for word in arrays.get("GRIDUNIT", [])]
    if "MAPAXES" not in arrays or "MAP" in words[1:]:
        return points
    axes = arrays["MAPAXES"].astype(np.float64).reshape(3, 2)
    x_axis, y_axis = axes[2] - axes[1], axes[0] - axes[1]
    rotation = np.array([x_axis / np.linalg.norm(x_axis), y_axis / np.linalg.norm(y_axis)])
    grid_unit = METERS.get(words[0] if words else "METRES", 1.0)
    map_unit = METERS.get(arrays["MAPUNITS"][0].decode().strip(), grid_unit) if "MAPUNITS" in arrays else grid_unit
    points[:, :2] = points[:, :2] @ rotation + axes[1] * map_unit / grid_unit
    return points


def cell_values(init: Path, name: str, active: NDArray[np.bool_]) -> NDArray[np.float64]:
    """A property of all cells, which the file may have of the active ones alone."""
    arrays = read_arrays(init)
    if name not in arrays or len(arrays[name]) not in (active.size, np.count_nonzero(active)):
        raise NotRun(f"{init} has no property {name} of the grid's cells")
    if len(arrays[name]) == active.size:
        return arrays[name].astype(np.float64)
    values = np.zeros(active.size)
    values[active] = arrays[name]
    return values


def read_mesh(case: Path, property_name: str, exaggeration: float) -> Mesh:
    """The active cells with thickness, corners merged where equal on a pillar, the property averaged to points."""
    arrays = read_arrays(case)
    if not {"GRIDHEAD", "COORD", "ZCORN"} <= arrays.keys() or arrays["GRIDHEAD"][0] != 1:
        raise NotRun(f"{case} has no corner-point grid")
    ni, nj, nk = (int(n) for n in arrays["GRIDHEAD"][1:4])
    zcorn = arrays["ZCORN"].astype(np.float32).reshape(nk, 2, nj, 2, ni, 2)
    k, j, i = (a.ravel() for a in np.indices((nk, nj, ni)))
    order = [(kk, jj, ii) for kk in (0, 1) for jj, ii in ((0, 0), (0, 1), (1, 1), (1, 0))]
    depths = np.stack([zcorn[:, kk, :, jj, :, ii].ravel() for kk, jj, ii in order], axis=1) + np.float32(0.0)
    pillars = np.stack([(j + jj) * (ni + 1) + i + ii for _, jj, ii in order], axis=1)

    actnum = arrays.get("ACTNUM")
    active = np.ones(ni * nj * nk, bool) if actnum is None else actnum > 0
    drawn = active & ((depths[:, 4:] - depths[:, :4]).max(axis=1) > 0.0)
    values = cell_values(case.with_suffix(".INIT"), property_name, active)[drawn]

    # A corner is known by its pillar and the bits of its depth.
    keys = (pillars[drawn] << 32) | depths[drawn].view(np.uint32)
    corners, hexahedra = np.unique(keys, return_inverse=True)
    hexahedra = hexahedra.reshape(-1, 8)
    depth = (corners & 0xFFFFFFFF).astype(np.uint32).view(np.float32).astype(np.float64)
    coord = arrays["COORD"].astype(np.float64).reshape(-1, 6)[corners >> 32]
    height = coord[:, 5] - coord[:, 2]
    along = np.divide(depth - coord[:, 2], height, out=np.zeros_like(depth), where=height != 0.0)
    points = np.column_stack([coord[:, :2] + along[:, None] * (coord[:, 3:5] - coord[:, :2]), -exaggeration * depth])

    # A cell that is pinched out on a pillar counts once there.
    weights = np.ones(hexahedra.shape)
    weights[:, 4:] = hexahedra[:, 4:] != hexahedra[:, :4]
    sums = np.bincount(hexahedra.ravel(), (weights * values[:, None]).ravel())
    means = sums / np.bincount(hexahedra.ravel(), weights.ravel())
    return Mesh(world_from_grid(arrays, points), hexahedra, means)


def mean_edge(mesh: Mesh) -> float:
    """The cube root of the mean volume of cells, each taken for the parallelepiped of its mean edges."""
    near_far = [([0, 3, 4, 7], [1, 2, 5, 6]), ([0, 1, 4, 5], [2, 3, 6, 7]), ([0, 1, 2, 3], [4, 5, 6, 7])]
    corners = mesh.points[mesh.hexahedra]
    edges = np.stack([corners[:, far].mean(axis=1) - corners[:, near].mean(axis=1) for near, far in near_far], axis=1)
    return float(np.abs(np.linalg.det(edges)).mean() ** (1.0 / 3.0))


def framed(mesh: Mesh, aspect: float) -> tuple[list[float], list[float]]:
    """Eye and target of a camera in the south-east, 35 degrees above the horizon, that sees all points."""
    target = (mesh.points.min(axis=0) + mesh.points.max(axis=0)) / 2.0
    azimuth, elevation = np.radians(150.0), np.radians(35.0)
    back = np.array([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)])
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    offsets = mesh.points - target
    half = 0.95 * np.tan(np.radians(FOVY_DEGREES) / 2.0)
    extents = np.maximum(np.abs(offsets @ right) / aspect, np.abs(offsets @ np.cross(back, right)))
    distance = float((extents / half + offsets @ back).max())
    return (target + distance * back).tolist(), target.tolist()


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Wall and CPU time of this process, all threads, in seconds."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - wall, time.process_time() - cpu


def peak_mb(who: int) -> float:
    """Peak resident memory in MB; kilobytes is what Linux counts it in."""
    return resource.getrusage(who).ru_maxrss * 1024 / 1e6


def set_cells(grid: Any, kind: int, ids: NDArray[np.int64]) -> None:
    """Gives a grid of VTK cells of one kind by the points of each."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtkIdTypeArray as to_vtk

    cells = vtk.vtkCellArray()
    cells.SetData(to_vtk(np.arange(0, ids.size + 1, ids.shape[1]), deep=True), to_vtk(ids.ravel(), deep=True))
    grid.SetCells(kind, cells)


def vtk_grid(mesh: Mesh, origin: list[float]) -> Any:
    """The mesh as VTK's unstructured grid; coordinates from an origin, so that single precision is enough."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    points, grid = vtk.vtkPoints(), vtk.vtkUnstructuredGrid()
    points.SetData(numpy_to_vtk(mesh.points - origin, deep=True))
    grid.SetPoints(points)
    set_cells(grid, vtk.VTK_HEXAHEDRON, mesh.hexahedra)
    grid.GetPointData().SetScalars(numpy_to_vtk(mesh.values.astype(np.float32), deep=True))
    return grid


def tetrahedra(grid: Any) -> Any:
    """The grid cut into tetrahedra, without those that have a point twice, which crash Bunyk's mapper."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    cut = vtk.vtkDataSetTriangleFilter()
    cut.SetInputData(grid)
    cut.Update()
    ids = vtk_to_numpy(cut.GetOutput().GetCells().GetConnectivityArray()).reshape(-1, 4)
    is_whole = (np.diff(np.sort(ids, axis=1), axis=1) > 0).all(axis=1)
    set_cells(cut.GetOutput(), vtk.VTK_TETRA, ids[is_whole].astype(np.int64))
    return cut.GetOutput()


def vtk_property(look: Look) -> Any:
    """Color and opacity for VTK, which takes the opacity of these mappers for extinction."""
    import vtk

    def value(position: float) -> float:
        return look.range[0] + position * (look.range[1] - look.range[0])

    color, opacity, made = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction(), vtk.vtkVolumeProperty()
    for position, hexadecimal in COLORS:
        color.AddRGBPoint(value(position), *(byte / 255.0 for byte in bytes.fromhex(hexadecimal[1:])))
    for position, extinction in EXTINCTION:
        opacity.AddPoint(value(position), extinction)
    made.SetColor(color)
    made.SetScalarOpacity(opacity)
    made.SetScalarOpacityUnitDistance(look.unit_length)
    made.SetInterpolationTypeToLinear()
    made.ShadeOff()
    return made


def vtk_window(mapper: Any, look: Look) -> tuple[Any, Any]:
    """A window off screen that shows a mapper's volume on white, and its renderer."""
    import vtk

    volume, renderer, window = vtk.vtkVolume(), vtk.vtkRenderer(), vtk.vtkRenderWindow()
    volume.SetMapper(mapper)
    volume.SetProperty(vtk_property(look))
    renderer.SetBackground(1.0, 1.0, 1.0)
    renderer.AddVolume(volume)
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*look.size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*(e - t for e, t in zip(look.eye, look.target)))
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetViewUp(0.0, 0.0, 1.0)
    camera.SetViewAngle(FOVY_DEGREES)
    return window, renderer


def run_vtk(name: str, look: Look, image: Path) -> Result:
    """Times one of VTK's mappers: cutting into tetrahedra and the first image, then frames of a turning camera."""
    import vtk

    vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_OFF)
    grid = vtk_grid(read_mesh(look.case, look.property, look.exaggeration), look.target)
    mapper = getattr(vtk, PEERS[name])()
    if name == "Bunyk":
        mapper.AutoAdjustSampleDistancesOff()
        mapper.SetImageSampleDistance(1.0)
    window, renderer = vtk_window(mapper, look)

    def frame() -> None:
        renderer.ResetCameraClippingRange()
        window.Render()
        window.WaitForCompletion()

    def first() -> None:
        mapper.SetInputData(tetrahedra(grid))
        frame()

    first_s, first_cpu_s = timed(first)
    if name != "Bunyk" and not mapper.IsSupported(window):
        raise NotRun(f"{PEERS[name]} does not support this OpenGL driver")
    picture, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer.SetInputConnection(picture.GetOutputPort())
    writer.SetFileName(str(image))
    writer.Write()
    times = []
    for _ in range(look.frames):
        renderer.GetActiveCamera().Azimuth(TURN_DEGREES)
        times.append(timed(frame))
    frame_s, frame_cpu_s = (statistics.median(column) for column in zip(*times))
    peak = peak_mb(resource.RUSAGE_SELF)
    return Result(f"VTK, {name}", look.size, first_s, first_cpu_s, frame_s, frame_cpu_s, peak, image)


def scene(look: Look, strategy: str) -> dict[str, Any]:
    """The look as a scene file of StrataRay."""
    opacity = [(position, float(1.0 - np.exp(-extinction))) for position, extinction in EXTINCTION]
    return {
        "size": look.size,
        "background": "#ffffff",
        "camera": {"eye": look.eye, "target": look.target, "up": [0, 0, 1], "fovy_degrees": FOVY_DEGREES},
        "vertical_exaggeration": look.exaggeration,
        "mode": "volume",
        "property": look.property,
        "interpolation": "vertex",
        "range": look.range,
        "transfer": {"color": COLORS, "opacity": opacity, "reference_length": look.unit_length},
        "show": {"box": False, "legend": False, "info": False, "hull": "hidden"},
    } | STRATEGIES[strategy]


def run_strataray(binary: str, adapter: str, strategy: str, look: Look, image: Path) -> Result:
    """Times StrataRay: the whole command for one image, then frames by its own statistics."""
    scene_file, stats_file = image.with_suffix(".scene.json"), image.with_suffix(".stats.json")
    scene_file.write_text(json.dumps(scene(look, strategy), indent=1))
    command = [binary, "render", str(look.case), "--scene", str(scene_file), "--adapter", adapter, "--lighting", "off"]
    command += ["--plain", "--quiet", "-o", str(image)]

    def call(*more: str) -> None:
        done = subprocess.run(command + list(more), capture_output=True, text=True)
        if done.returncode != 0:
            raise NotRun(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}")

    first_s, _ = timed(call)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    peak = peak_mb(resource.RUSAGE_CHILDREN)
    call("--frames", str(look.frames), "--stats", str(stats_file))
    stats = json.loads(stats_file.read_text())
    frame_s, frame_cpu_s = stats["frame_wall_ms"] / 1e3, stats["frame_cpu_ms"] / 1e3
    name = f"StrataRay, {strategy}, {adapter}"
    return Result(name, look.size, first_s, usage.ru_utime + usage.ru_stime, frame_s, frame_cpu_s, peak, image)


def in_own_process(work: Callable[..., Result], *arguments: object) -> Result:
    """Calls in a fresh process, whose peak memory is the renderer's and whose end is not this one's."""
    with ProcessPoolExecutor(max_workers=1, mp_context=get_context("spawn")) as pool:
        try:
            return pool.submit(work, *arguments).result()
        except BrokenProcessPool as error:
            raise NotRun("its process ended abruptly") from error


def read_image(path: Path) -> NDArray[np.float64]:
    """Red, green and blue of each pixel, 0 to 255."""
    return np.asarray(Image.open(path).convert("RGB"), np.float64).reshape(-1, 3)


def compare_images(results: list[Result]) -> None:
    """Counts covered pixels, and takes the mean absolute difference to the first image where either covers."""
    images = [read_image(result.image) for result in results]
    covered = [(image < 255.0).any(axis=1) for image in images]
    has_reference = bool(results) and results[0].renderer == "VTK, Bunyk"
    for result, image, mask in zip(results, images, covered):
        result.covered_pixels = int(mask.sum())
        if has_reference:
            result.difference = float(np.abs(image - images[0])[mask | covered[0]].mean())


def runs_of_size(look: Look, binary: str, folder: Path, not_run: list[str]) -> list[Result]:
    """Runs every renderer at one size, and notes those that could not be run."""
    runs: list[tuple[str, Callable[..., Result], tuple[object, ...]]] = []
    for name in PEERS:
        runs.append((f"VTK {name}", run_vtk, (name,)))
    for adapter in ADAPTERS:
        for strategy in STRATEGIES:
            runs.append((f"StrataRay {strategy} {adapter}", run_strataray, (binary, adapter, strategy)))
    results = []
    for name, work, arguments in runs:
        label = f"{name} {look.size[0]}x{look.size[1]}"
        image = folder / f"{look.case.stem} {label}.png".lower().replace(",", "").replace(" ", "-")
        print(f"running {label}", file=sys.stderr)
        try:
            results.append(in_own_process(work, *arguments, look, image))
        except NotRun as reason:
            not_run.append(f"{label}: {reason}")
    compare_images(results)
    return results


def table(results: list[Result]) -> str:
    """The results as a Markdown table."""
    head = ["size", "renderer", "first image s (CPU)", "frame s (CPU)", "covered pixels", "peak MB", "difference to Bunyk"]
    lines = ["| " + " | ".join(head) + " |", "| --- " * len(head) + "|"]
    for r in results:
        first, frame = f"{r.first_s:.2f} ({r.first_cpu_s:.2f})", f"{r.frame_s:.3f} ({r.frame_cpu_s:.3f})"
        difference = "" if r.difference is None else f"{r.difference:.1f}"
        size = f"{r.size[0]}x{r.size[1]}"
        lines.append(f"| {size} | {r.renderer} | {first} | {frame} | {r.covered_pixels:,} | {r.peak_mb:.0f} | {difference} |")
    return "\n".join(lines)


def machine(binary: str) -> dict[str, Any]:
    """What was measured on which machine."""
    models = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    version = subprocess.run([binary, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return {
        "processor": models[0].split(":")[1].strip() if models else platform.machine(),
        "cores": os.cpu_count(),
        "load_average": round(os.getloadavg()[0], 1),
        "versions": [version, f"VTK {metadata.version('vtk')}"],
    }


def size_of(text: str) -> tuple[int, int]:
    """Width and height of WxH."""
    width, height = text.lower().split("x")
    return int(width), int(height)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="peers", description=__doc__.splitlines()[0])
    parser.add_argument("case", type=Path, help="an EGRID file with an INIT file beside it")
    parser.add_argument("--property", default="PORO", help="a property of the INIT file")
    parser.add_argument("--size", type=size_of, nargs="+", default=[(500, 500)], metavar="WxH")
    parser.add_argument("--frames", type=int, default=3, help="frames to time after the first image")
    parser.add_argument("--exaggeration", type=float, default=5.0)
    parser.add_argument("--json", type=Path, help="file for all figures; the images are saved beside it")
    parser.add_argument("--binary", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, required=True, help=argparse.SUPPRESS)
    return parser.parse_args()


def main() -> None:
    """Measures at every size, prints the table and writes the JSON."""
    args = arguments()
    out = args.json or args.folder / f"{args.case.stem.lower()}.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    mesh = read_mesh(args.case, args.property, args.exaggeration)
    low, high = np.percentile(mesh.values, [2.0, 98.0])
    about = machine(args.binary)
    results: list[Result] = []
    not_run: list[str] = []
    for size in args.size:
        eye, target = framed(mesh, size[0] / size[1])
        look = Look(args.case, args.property, args.exaggeration, size, args.frames, eye, target,
                    (float(low), float(high)), mean_edge(mesh))
        results += runs_of_size(look, args.binary, out.parent, not_run)
    about |= {"case": args.case.name, "property": args.property, "cells": len(mesh.hexahedra)}
    print(f"{about['case']}, {about['cells']:,} cells drawn, {about['property']}; {', '.join(about['versions'])}; "
          f"{about['cores']} cores, {about['processor']}, load average {about['load_average']} before\n")
    print(table(results))
    print("\nFirst image: VTK from the hexahedra in memory; StrataRay the whole command, files read and written.\n"
          "Difference: mean over covered pixels and the three colors, of 255.")
    for reason in not_run:
        print(f"\nNot run: {reason}")
    out.write_text(json.dumps(about | {"results": [asdict(r) for r in results], "not_run": not_run}, indent=1, default=str))


if __name__ == "__main__":
    try:
        main()
    except NotRun as reason:
        sys.exit(f"peers: {reason}")
