"""Times StrataRay and VTK's mappers of unstructured grids on the same case, view and transfer function.

Run it by `scripts/peers`, which installs what it needs. Each renderer runs in a process of its own, one after the
other, so that its peak memory is known and none can take another down.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from dataclasses import asdict, dataclass
from importlib import metadata
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import resfo
from numpy.typing import NDArray
from PIL import Image

# Extinction per unit length and color at positions in the range of values. VTK interpolates extinction and StrataRay
# opacity, which comes to the same within about one percent between these points.
EXTINCTION = [(0.0, 0.02), (0.25, 0.09), (0.5, 0.16), (0.75, 0.23), (1.0, 0.3)]
COLORS = [(0.0, "#2c3e8f"), (0.25, "#2a9d8f"), (0.5, "#e9c46a"), (0.75, "#e76f51"), (1.0, "#c1121f")]
METERS = {"METRES": 1.0, "FEET": 0.3048, "CM": 0.01}
EXAGGERATION = 5.0
FOVY_DEGREES, TURN_DEGREES = 30.0, 2.0
BUNYK = "VTK, Bunyk"
PEERS = {BUNYK: "vtkUnstructuredGridVolumeRayCastMapper", "VTK, projected tetrahedra": "vtkProjectedTetrahedraMapper"}
STRATEGIES: dict[str, dict[str, Any]] = {
    "PLTS": {"strategy": "plts"}, "LIBC": {"strategy": "libc", "libc": {"integration": "segments"}},
}
LEGEND = """First image: VTK from hexahedra in memory, StrataRay the whole command from reading files to the PNG.
Difference: to Bunyk's image, mean over covered pixels and the three colors, of 255."""


@dataclass
class Mesh:
    """Hexahedra with values at points, in world space: x east, y north, z up and exaggerated."""

    points: NDArray[np.float64]
    hexahedra: NDArray[np.int64]
    values: NDArray[np.float64]


@dataclass
class Look:
    """What all renderers share; opacity refers to the unit length."""

    case: Path
    property: str
    size: tuple[int, int]
    frames: int
    eye: list[float]
    target: list[float]
    range: tuple[float, float]
    unit_length: float


@dataclass
class Result:
    """What a renderer took: wall and CPU seconds of the first image and of the median frame, and memory."""

    renderer: str
    size: tuple[int, int]
    first: tuple[float, float]
    frame: tuple[float, float]
    peak_mb: float
    image: Path
    covered_pixels: int = 0
    difference: float | None = None


class NotRun(Exception):
    """Why a renderer, or all of them, cannot be run, as a sentence."""


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of an Eclipse file by name; of repeated names the first, which is the global grid's."""
    arrays: dict[str, NDArray[Any]] = {}
    for name, array in resfo.read(path):
        arrays.setdefault(name.strip(), np.asarray(array))
    return arrays


def world_from_grid(arrays: dict[str, NDArray[Any]], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points with MAPAXES applied, in the grid's unit."""
    grid_words = [word.decode().strip() for word in arrays.get("GRIDUNIT", [b"METRES"])]
    if "MAPAXES" not in arrays or "MAP" in grid_words[1:]:
        return points
    map_word = arrays["MAPUNITS"][0].decode().strip() if "MAPUNITS" in arrays else grid_words[0]
    axes = arrays["MAPAXES"].astype(np.float64).reshape(3, 2)
    directions = np.array([axes[2] - axes[1], axes[0] - axes[1]])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points[:, :2] = points[:, :2] @ directions + axes[1] * METERS.get(map_word, 1.0) / METERS.get(grid_words[0], 1.0)
    return points


def read_mesh(case: Path, name: str) -> Mesh:
    """The active cells with thickness, corners merged where equal on a pillar, the property averaged to points."""
    arrays, properties = read_arrays(case), read_arrays(case.with_suffix(".INIT"))
    if not {"GRIDHEAD", "COORD", "ZCORN"} <= arrays.keys() or arrays["GRIDHEAD"][0] != 1:
        raise NotRun(f"{case} has no corner-point grid")
    ni, nj, nk = (int(n) for n in arrays["GRIDHEAD"][1:4])
    zcorn = arrays["ZCORN"].astype(np.float32).reshape(nk, 2, nj, 2, ni, 2) + np.float32(0.0)
    order = [(kk, jj, ii) for kk in (0, 1) for jj, ii in ((0, 0), (0, 1), (1, 1), (1, 0))]
    depths = np.stack([zcorn[:, kk, :, jj, :, ii].ravel() for kk, jj, ii in order], axis=1)
    _, j, i = (a.ravel() for a in np.indices((nk, nj, ni)))
    pillars = np.stack([(j + jj) * (ni + 1) + i + ii for _, jj, ii in order], axis=1)
    active = arrays.get("ACTNUM", np.ones(ni * nj * nk)) > 0
    drawn = active & ((depths[:, 4:] - depths[:, :4]).max(axis=1) > 0.0)
    values = properties.get(name, np.empty(0))
    if values.size not in (active.size, np.count_nonzero(active)):
        raise NotRun(f"the INIT file of {case} has no property {name} of the grid's cells")
    values = values[drawn if values.size == active.size else drawn[active]].astype(np.float64)

    # A corner is known by its pillar and the bits of its depth.
    keys = (pillars[drawn] << 32) | depths[drawn].view(np.uint32)
    corners, hexahedra = np.unique(keys, return_inverse=True)
    depth = (corners & 0xFFFFFFFF).astype(np.uint32).view(np.float32).astype(np.float64)
    coord = arrays["COORD"].astype(np.float64).reshape(-1, 6)[corners >> 32]
    height = coord[:, 5] - coord[:, 2]
    along = np.divide(depth - coord[:, 2], height, out=np.zeros_like(depth), where=height != 0.0)
    points = np.column_stack([coord[:, :2] + along[:, None] * (coord[:, 3:5] - coord[:, :2]), -EXAGGERATION * depth])

    # A cell that is pinched out on a pillar counts once there.
    weights = np.ones(hexahedra.shape)
    weights[:, 4:] = hexahedra[:, 4:] != hexahedra[:, :4]
    sums = np.bincount(hexahedra.ravel(), (weights * values[:, None]).ravel())
    return Mesh(world_from_grid(arrays, points), hexahedra, sums / np.bincount(hexahedra.ravel(), weights.ravel()))


def mean_edge(mesh: Mesh) -> float:
    """The cube root of the mean volume of cells, each taken for the parallelepiped of the edges at its first corner."""
    corners = mesh.points[mesh.hexahedra]
    return float(np.abs(np.linalg.det(corners[:, [1, 3, 4]] - corners[:, [0]])).mean() ** (1.0 / 3.0))


def framed(mesh: Mesh, aspect: float) -> tuple[list[float], list[float]]:
    """Eye and target of a camera in the south-east, 35 degrees above the horizon, that sees all points."""
    target = (mesh.points.min(axis=0) + mesh.points.max(axis=0)) / 2.0
    azimuth, elevation = np.radians([150.0, 35.0])
    back = np.array([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)])
    right = np.array([-np.cos(azimuth), np.sin(azimuth), 0.0])
    offsets = mesh.points - target
    extents = np.maximum(np.abs(offsets @ right) / aspect, np.abs(offsets @ np.cross(back, right)))
    distance = float((extents / (0.95 * np.tan(np.radians(FOVY_DEGREES) / 2.0)) + offsets @ back).max())
    return (target + distance * back).tolist(), target.tolist()


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Wall and CPU time of this process, all threads."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return time.perf_counter() - wall, time.process_time() - cpu


def tetrahedra(mesh: Mesh, origin: list[float]) -> Any:
    """The mesh cut into tetrahedra by VTK, coordinates from an origin, so that single precision is enough."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

    grid = vtk.vtkUnstructuredGrid(points=vtk.vtkPoints(data=numpy_to_vtk(mesh.points - origin, deep=True)))
    grid.GetPointData().SetScalars(numpy_to_vtk(mesh.values.astype(np.float32), deep=True))
    hexahedra, whole = vtk.vtkCellArray(), vtk.vtkCellArray()
    hexahedra.SetData(8, numpy_to_vtkIdTypeArray(mesh.hexahedra.ravel(), deep=True))
    grid.SetCells(vtk.VTK_HEXAHEDRON, hexahedra)
    cut = vtk.vtkDataSetTriangleFilter()
    cut.SetInputData(grid)
    cut.Update()
    # Those that have a point twice crash Bunyk's mapper.
    ids = vtk_to_numpy(cut.GetOutput().GetCells().GetConnectivityArray()).reshape(-1, 4).astype(np.int64)
    is_whole = (np.diff(np.sort(ids, axis=1), axis=1) > 0).all(axis=1)
    whole.SetData(4, numpy_to_vtkIdTypeArray(ids[is_whole].ravel(), deep=True))
    cut.GetOutput().SetCells(vtk.VTK_TETRA, whole)
    return cut.GetOutput()


def vtk_window(mapper: Any, look: Look) -> Any:
    """A window off screen that shows a mapper's volume on white. These mappers take opacity for extinction."""
    import vtk

    low, extent = look.range[0], look.range[1] - look.range[0]
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for position, text in COLORS:
        color.AddRGBPoint(low + position * extent, *(byte / 255.0 for byte in bytes.fromhex(text[1:])))
    for position, extinction in EXTINCTION:
        opacity.AddPoint(low + position * extent, extinction)
    shown = vtk.vtkVolumeProperty(color=color, scalar_opacity=opacity, scalar_opacity_unit_distance=look.unit_length)
    renderer = vtk.vtkRenderer(background=(1.0, 1.0, 1.0))
    renderer.AddVolume(vtk.vtkVolume(mapper=mapper, property=shown))
    eye = [e - t for e, t in zip(look.eye, look.target)]
    camera = vtk.vtkCamera(position=eye, focal_point=(0, 0, 0), view_up=(0, 0, 1), view_angle=FOVY_DEGREES)
    renderer.SetActiveCamera(camera)
    window = vtk.vtkRenderWindow(off_screen_rendering=True, multi_samples=0, size=look.size)
    window.AddRenderer(renderer)
    return window


def run_vtk(name: str, look: Look, image: Path) -> Result:
    """Times one of VTK's mappers: cutting into tetrahedra and the first image, then frames of a turning camera."""
    import vtk

    vtk.vtkLogger.SetStderrVerbosity(vtk.vtkLogger.VERBOSITY_OFF)
    mesh = read_mesh(look.case, look.property)
    mapper = getattr(vtk, PEERS[name])()
    if name == BUNYK:
        mapper.AutoAdjustSampleDistancesOff()
    window = vtk_window(mapper, look)
    renderer = window.GetRenderers().GetFirstRenderer()

    def frame() -> None:
        renderer.ResetCameraClippingRange()
        window.Render()
        window.WaitForCompletion()

    cutting = timed(lambda: mapper.SetInputData(tetrahedra(mesh, look.target)))
    showing = timed(frame)
    if name != BUNYK and not mapper.IsSupported(window):
        raise NotRun(f"{PEERS[name]} does not support this OpenGL driver")
    picture = vtk.vtkWindowToImageFilter(input=window, read_front_buffer=False)
    vtk.vtkPNGWriter(input_connection=picture.GetOutputPort(), file_name=str(image)).Write()
    times = []
    for _ in range(look.frames):
        renderer.GetActiveCamera().Azimuth(TURN_DEGREES)
        times.append(timed(frame))
    first = cutting[0] + showing[0], cutting[1] + showing[1]
    wall, cpu = np.median(times, axis=0).tolist()
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return Result(name, look.size, first, (wall, cpu), usage.ru_maxrss / 1000, image)


def scene(look: Look, strategy: str) -> dict[str, Any]:
    """The look as a scene file of StrataRay."""
    opacity = [(position, float(1.0 - np.exp(-extinction))) for position, extinction in EXTINCTION]
    return STRATEGIES[strategy] | {
        "size": look.size, "background": "#ffffff", "vertical_exaggeration": EXAGGERATION, "mode": "volume",
        "camera": {"eye": look.eye, "target": look.target, "up": [0, 0, 1], "fovy_degrees": FOVY_DEGREES},
        "property": look.property, "interpolation": "vertex", "range": look.range,
        "transfer": {"color": COLORS, "opacity": opacity, "reference_length": look.unit_length},
        "show": {"box": False, "legend": False, "info": False, "hull": "hidden"},
    }


def run_strataray(adapter: str, strategy: str, look: Look, image: Path) -> Result:
    """Times StrataRay: the whole command for one image, then frames by its own statistics."""
    scene_file, stats_file = image.with_suffix(".scene.json"), image.with_suffix(".stats.json")
    scene_file.write_text(json.dumps(scene(look, strategy), indent=1))
    command = [os.environ["STRATARAY"], "render", str(look.case), "--scene", str(scene_file), "--adapter", adapter]
    command += ["--lighting", "off", "--plain", "--quiet", "-o", str(image)]

    def render(*more: str) -> None:
        done = subprocess.run([*command, *more], capture_output=True, text=True)
        if done.returncode != 0:
            raise NotRun(done.stderr.strip() or f"it ended with {done.returncode}")

    wall, _ = timed(render)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    first = wall, usage.ru_utime + usage.ru_stime
    render("--frames", str(look.frames), "--stats", str(stats_file))
    stats = json.loads(stats_file.read_text())
    frame = stats["frame_wall_ms"] / 1e3, stats["frame_cpu_ms"] / 1e3
    return Result(f"StrataRay, {strategy}, {adapter}", look.size, first, frame, usage.ru_maxrss / 1000, image)


def compare_images(results: list[Result]) -> None:
    """Counts covered pixels, and takes the mean absolute difference to Bunyk's image where either covers."""
    images = [np.asarray(Image.open(result.image).convert("RGB"), np.float64) for result in results]
    covered = [(image < 255.0).any(axis=2) for image in images]
    for result, image, mask in zip(results, images, covered):
        result.covered_pixels = int(mask.sum())
        if results[0].renderer == BUNYK:
            result.difference = float(np.abs(image - images[0])[mask | covered[0]].mean())


def results_of(look: Look, args: argparse.Namespace, folder: Path, not_run: list[str]) -> list[Result]:
    """Runs every renderer at one size, and notes those that could not be run."""
    runs: list[tuple[str, Callable[..., Result], tuple[str, ...]]] = [(name, run_vtk, (name,)) for name in PEERS]
    for adapter in args.adapter:
        runs += [(f"StrataRay, {s}, {adapter}", run_strataray, (adapter, s)) for s in STRATEGIES]
    results = []
    for name, work, arguments in runs:
        label = f"{look.case.stem}, {name}, {look.size[0]}x{look.size[1]}"
        print(f"running {label}", file=sys.stderr)
        image = folder / f"{label.lower().replace(', ', '-').replace(' ', '-')}.png"
        try:
            with ProcessPoolExecutor(max_workers=1, mp_context=get_context("spawn")) as pool:
                results.append(pool.submit(work, *arguments, look, image).result())
        except (NotRun, BrokenExecutor) as reason:
            not_run.append(f"{label}: {reason}")
    compare_images(results)
    return results


def table(results: list[Result]) -> str:
    """The results as a Markdown table."""
    names = ["size", "renderer", "first image s (CPU)", "frame s (CPU)", "covered pixels", "peak MB", "difference"]
    lines = ["| " + " | ".join(names) + " |", "| --- " * len(names) + "|"]
    for r in results:
        times = f"{r.first[0]:.2f} ({r.first[1]:.2f}) | {r.frame[0]:.2f} ({r.frame[1]:.2f})"
        seen = f"{r.covered_pixels:,} | {r.peak_mb:.0f} | {'' if r.difference is None else round(r.difference, 1)}"
        lines.append(f"| {r.size[0]}x{r.size[1]} | {r.renderer} | {times} | {seen} |")
    return "\n".join(lines)


def command_line() -> argparse.Namespace:
    """What is asked for."""
    parser = argparse.ArgumentParser(prog="scripts/peers", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("case", type=Path, help="an EGRID file with an INIT file beside it")
    parser.add_argument("--property", default="PORO", help="a property of the INIT file")
    parser.add_argument("--size", nargs="+", default=["500x500"], metavar="WxH")
    parser.add_argument("--frames", type=int, default=3, help="frames to time after the first image")
    parser.add_argument("--adapter", nargs="+", default=["cpu", "llvmpipe"], help="adapters of StrataRay")
    parser.add_argument("--json", type=Path, help="file for all figures; the images are saved beside it")
    return parser.parse_args()


def main() -> None:
    """Measures at every size, prints the table and writes the JSON."""
    args = command_line()
    out = args.json or Path(__file__).parents[1] / "target" / "peers" / f"{args.case.stem.lower()}.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    mesh = read_mesh(args.case, args.property)
    low, high = np.percentile(mesh.values, [2.0, 98.0]).tolist()
    about = f"{args.case.name}, {len(mesh.hexahedra):,} cells, {args.property}; VTK {metadata.version('vtk')}, "
    about += subprocess.check_output([os.environ["STRATARAY"], "--version"], text=True).strip()
    about += f"; {os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f} before"
    results, not_run = list[Result](), list[str]()
    for width, height in (map(int, text.split("x")) for text in args.size):
        camera = framed(mesh, width / height)
        look = Look(args.case, args.property, (width, height), args.frames, *camera, (low, high), mean_edge(mesh))
        results += results_of(look, args, out.parent, not_run)
    print(f"{about}\n\n{table(results)}\n\n{LEGEND}")
    print("\n".join(f"Not run: {reason}" for reason in not_run))
    figures = {"about": about, "results": [asdict(result) for result in results], "not_run": not_run}
    out.write_text(json.dumps(figures, indent=1, default=str))


if __name__ == "__main__":
    try:
        main()
    except (NotRun, OSError, resfo.ResfoParsingError) as why:
        sys.exit(f"peers: {why}")
