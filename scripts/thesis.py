"""Measures models of the sizes of campagnolo-2021, chapter 4, with its settings, beside its figures.

Run it by `scripts/thesis`. The geometry of the models is synthetic (`strataray sample`); dimensions, active cells and
settings are the paper's. Frame rates are another machine's: what carries over are bytes, ratios and orders.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

STRATARAY = os.environ["STRATARAY"]
SCENES = Path(__file__).resolve().parent.parent / "samples" / "thesis"
MB = 1 << 20


@dataclass
class Paper:
    """Figures of tables 4.1 to 4.4."""

    grid_mb: float
    srg_mb: float
    light_mb: float
    # Frames a second: plain, pre-illuminated, at every sample (at most).
    plain: float
    preilluminated: float
    image: float


PAPER = {
    "R1": Paper(1.1, 450, 0.5, 426, 334, 65),
    "R2": Paper(2.3, 1935, 4.0, 91, 70, 10),
    "R3": Paper(4.4, 967, 4.0, 105, 80, 12),
    "R4": Paper(17.7, 484, 8.0, 85, 54, 3),
    "R5": Paper(211.5, 5947, 122.1, 17, 7, 1),
}


def measured(model: str, scene: dict[str, Any], options: argparse.Namespace) -> tuple[dict[str, Any], dict[str, Any]]:
    """The case's figures and those of its one strategy, by `strataray bench`."""
    with tempfile.TemporaryDirectory() as folder:
        written, report = Path(folder) / "scene.json", Path(folder) / "bench.json"
        written.write_text(json.dumps(scene))
        command = [STRATARAY, "bench", model, "--scene", str(written), "--strategy", scene["strategy"]]
        command += ["--frames", str(options.frames), "--json", str(report), "--quiet"]
        for name in ("adapter", "size"):
            if getattr(options, name):
                command += [f"--{name}", getattr(options, name)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        bench = json.loads(report.read_text())
    if bench["failures"]:
        raise SystemExit(f"{model}: {bench['failures'][0]['error']}")
    case = bench["cases"][0]
    return case, case["strategies"][0]


def scene_of(model: str, mode: str | None, strategy: str = "libc") -> dict[str, Any]:
    """The paper's scene with occlusion found so, or without light."""
    scene: dict[str, Any] = json.loads((SCENES / f"{model}.json").read_text())
    scene["strategy"] = strategy
    if mode is None:
        scene["lighting"] = {}
    else:
        scene["lighting"]["occlusion"]["mode"] = mode
    return scene


def row(model: str, options: argparse.Namespace) -> list[str]:
    """One line of the table."""
    paper = PAPER[model]
    case, plain = measured(model, scene_of(model, None), options)
    _, srg = measured(model, scene_of(model, None, "srg"), options)
    lit_case, lit = measured(model, scene_of(model, "preilluminated"), options)
    volume = json.loads((SCENES / f"{model}.json").read_text())["lighting"]["volume"]
    light = 2 * volume["light_size"][0] * volume["light_size"][1] * volume["light_size"][2] / MB
    held = plain["gpu_bytes"]["geometry"] + plain["gpu_bytes"]["acceleration"]
    ratio = lit["frame_cpu_ms"] / plain["frame_cpu_ms"]
    image = "not measured"
    if not options.without_image_space:
        _, at_samples = measured(model, scene_of(model, "image"), options)
        image = f"{at_samples['frame_cpu_ms'] / plain['frame_cpu_ms']:.1f}"
    return [
        f"{model}, {case['active']:,} cells",
        f"{held / case['active']:.1f} ({paper.grid_mb * 1e6 / case['active']:.0f})",
        f"{srg['gpu_bytes']['resampled'] / MB:.0f} ({paper.srg_mb:.0f})",
        f"{light:.1f} ({paper.light_mb})",
        f"{ratio:.2f} ({paper.plain / paper.preilluminated:.2f})",
        f"{image} ({paper.plain / paper.image:.1f})",
        f"{srg['frame_cpu_ms'] / plain['frame_cpu_ms']:.2f}",
        f"{lit_case['light_field_ms'] + lit_case['light_extinction_ms']:,.0f}",
    ]


HEADINGS = [
    "model",
    "geometry, bytes per active cell",
    "SRG, MB",
    "light volume in half floats, MB",
    "pre-illuminated / plain",
    "at every sample / plain",
    "SRG / LIBC",
    "values and extinction, ms",
]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(prog="scripts/thesis", description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=["R1", "R2", "R3"], help="R1 to R5")
    parser.add_argument("--adapter", help="as of strataray bench")
    parser.add_argument("--size", help="pixels, 1000x1000 as the paper where it is absent")
    parser.add_argument("--frames", type=int, default=1, help="frames that are timed")
    parser.add_argument("--without-image-space", action="store_true", help="leave out cones at every sample: slow")
    options = parser.parse_args()
    unknown = [model for model in options.models if model.upper() not in PAPER]
    if unknown:
        parser.error(f"there is no model {unknown[0]}; there are {', '.join(PAPER)}")
    print("Ours, in brackets the paper's. Ratios are of CPU time per frame here, of frame rates on a GPU there.\n")
    print("| " + " | ".join(HEADINGS) + " |")
    print("|" + " --- |" * len(HEADINGS))
    for model in options.models:
        print("| " + " | ".join(row(model.upper(), options)) + " |")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
