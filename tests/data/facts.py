#!/usr/bin/env python3
"""Facts about small cases, by plain Python that shares nothing with StrataRay: writes facts.json beside itself.

    python3 facts.py            # needs no packages

Keys are named as in the facts about larger models by resdata and xtgeo, with which this script agrees to 1e-6 on
reek and editnnc. Coordinates are those of COORD and ZCORN, MAPAXES not applied.
"""
import json
import os
import struct

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
CASES = [
    "samples/scissor/SCISSOR.EGRID",
    "tests/data/reported/F06_TAPER.EGRID",
    "tests/data/reported/F25_OVERLAP.GRDECL",
]
SIZES = {"INTE": (4, "i"), "REAL": (4, "f"), "DOUB": (8, "d"), "LOGI": (4, "i"), "CHAR": (8, "8s")}


def records(path):
    """Name and values of each array of an unformatted file."""
    data = open(path, "rb").read()
    at = 0

    def block():
        nonlocal at
        (length,) = struct.unpack_from(">i", data, at)
        content = data[at + 4 : at + 4 + length]
        at += 8 + length
        return content

    while at < len(data):
        name, count, kind = struct.unpack(">8si4s", block())
        size, code = SIZES.get(kind.decode(), (0, ""))
        content = b""
        while len(content) < count * size:
            content += block()
        letters = code if code == "8s" else None
        if letters:
            values = [content[8 * n : 8 * n + 8].decode().strip() for n in range(count)]
        else:
            values = list(struct.unpack(f">{count}{code}", content)) if count else []
        yield name.decode().strip(), values


def keywords(path):
    """Values of each keyword of a deck without INCLUDE."""
    found, name = {}, None
    for line in open(path):
        for word in line.split("--")[0].split():
            if name is None:
                name, found[word] = word, []
            elif word == "/":
                name = None
            elif "*" in word:
                times, value = word.split("*")
                found[name] += [value] * int(times)
            else:
                found[name].append(word)
    return found


class Grid:
    def __init__(self, dims, coord, zcorn, actnum):
        self.ni, self.nj, self.nk = dims
        self.coord, self.zcorn = coord, zcorn
        self.actnum = actnum or [1] * (self.ni * self.nj * self.nk)

    def active(self):
        for k in range(self.nk):
            for j in range(self.nj):
                for i in range(self.ni):
                    if self.is_active(i, j, k):
                        yield i, j, k

    def is_active(self, i, j, k):
        return self.actnum[i + self.ni * (j + self.nj * k)] > 0

    def depth(self, i, j, k, di, dj, dk):
        nx, ny = 2 * self.ni, 2 * self.nj
        return self.zcorn[(2 * i + di) + nx * ((2 * j + dj) + ny * (2 * k + dk))]

    def corner(self, i, j, k, di, dj, dk):
        z = self.depth(i, j, k, di, dj, dk)
        at = 6 * ((i + di) + (self.ni + 1) * (j + dj))
        x1, y1, z1, x2, y2, z2 = self.coord[at : at + 6]
        t = 0.0 if abs(z2 - z1) < 1e-10 else (z - z1) / (z2 - z1)
        return x1 + t * (x2 - x1), y1 + t * (y2 - y1), z

    def corners(self, cell):
        return [self.corner(*cell, c & 1, c >> 1 & 1, c >> 2) for c in range(8)]


def minus(a, b):
    return [a[n] - b[n] for n in range(3)]


def triple(a, b, c):
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


def volume(corners):
    """Integral of the Jacobian of the trilinear map, by 2 x 2 x 2 Gauss points, which is exact."""
    total = 0.0
    points = (0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5)
    for u in points:
        for v in points:
            for w in points:
                along = [[0.0] * 3 for _ in range(3)]
                for c, p in enumerate(corners):
                    ends = [c & 1, c >> 1 & 1, c >> 2]
                    weight = [x if e else 1 - x for e, x in zip(ends, (u, v, w))]
                    sign = [1 if e else -1 for e in ends]
                    for a in range(3):
                        b, d = (a + 1) % 3, (a + 2) % 3
                        part = sign[a] * weight[b] * weight[d]
                        for n in range(3):
                            along[a][n] += part * p[n]
                total += triple(*along) / 8
    return total


def fault_faces(grid, axis):
    """Faces between active neighbors whose depths differ by more than 1e-3 on either pillar."""
    count = 0
    for i, j, k in grid.active():
        other = (i + 1, j, k) if axis == "I" else (i, j + 1, k)
        if other[0] >= grid.ni or other[1] >= grid.nj or not grid.is_active(*other):
            continue
        pairs = []
        for along in (0, 1):
            for dk in (0, 1):
                near = (1, along) if axis == "I" else (along, 1)
                far = (0, along) if axis == "I" else (along, 0)
                pairs.append((grid.depth(i, j, k, *near, dk), grid.depth(*other, *far, dk)))
        count += any(abs(a - b) > 1e-3 for a, b in pairs)
    return count


def facts_of_grid(grid):
    low, high = [float("inf")] * 3, [float("-inf")] * 3
    total, right, thin, active = 0.0, 0, 0, 0
    for cell in grid.active():
        corners = grid.corners(cell)
        active += 1
        for p in corners:
            low = [min(a, b) for a, b in zip(low, p)]
            high = [max(a, b) for a, b in zip(high, p)]
        signed = volume(corners)
        total += signed
        right += (signed > 0) - (signed < 0)
        thin += max(abs(corners[c + 4][2] - corners[c][2]) for c in range(4)) <= 1e-6
    faults = {axis: fault_faces(grid, axis) for axis in "IJ"}
    return {
        "ni": grid.ni,
        "nj": grid.nj,
        "nk": grid.nk,
        "cells_total": grid.ni * grid.nj * grid.nk,
        "active_cells": active,
        "handedness_signed_volume_positive": right > 0,
        "bbox_active_raw": {axis: [low[n], high[n]] for n, axis in enumerate("xyz")},
        "bulk_volume_active_trilinear": abs(total),
        "zero_thickness_active_cells": thin,
        "fault_faces_active_pairs": {"tol_0.001": faults},
    }


def statistics(values):
    return {"min": min(values), "max": max(values), "mean": sum(values) / len(values)}


def facts_of_deck(path):
    deck = keywords(path)
    dims = [int(n) for n in deck["SPECGRID"][:3]]
    numbers = {name: [float(v) for v in deck.get(name, [])] for name in ("COORD", "ZCORN", "ACTNUM", "PORO")}
    facts = {"grid": facts_of_grid(Grid(dims, numbers["COORD"], numbers["ZCORN"], numbers["ACTNUM"]))}
    # Of active cells, which are all where there is no ACTNUM.
    assert not numbers["ACTNUM"]
    facts["init"] = {"stats": {"PORO": statistics(numbers["PORO"])}}
    return facts


def facts_of_run(path):
    arrays = dict(records(path))
    dims = arrays["GRIDHEAD"][1:4]
    facts = {
        "grid": facts_of_grid(Grid(dims, arrays["COORD"], arrays["ZCORN"], arrays.get("ACTNUM"))),
        "nnc": {"nnc_global_global": len(arrays.get("NNC1", []))},
        "lgr_count": 0,
    }
    stem = os.path.splitext(path)[0]
    count = facts["grid"]["active_cells"]
    init = dict(records(stem + ".INIT"))
    names = ("PORO", "PERMX", "PERMZ", "NTG")
    facts["init"] = {"stats": {n: statistics(init[n]) for n in names if len(init.get(n, [])) == count}}
    if os.path.exists(stem + ".UNRST"):
        facts["restart"] = facts_of_restart(stem + ".UNRST", count)
    return facts


def facts_of_restart(path, count):
    steps, detail = [], []
    for name, values in records(path):
        if name == "SEQNUM":
            steps.append({"report": values[0]})
            detail.append({})
        elif name == "INTEHEAD":
            steps[-1]["date"] = f"{values[66]:04}-{values[65]:02}-{values[64]:02}"
        elif name == "DOUBHEAD":
            steps[-1]["days"] = values[0]
        elif name in ("PRESSURE", "SWAT", "SGAS") and len(values) == count:
            detail[-1][name] = statistics(values)
    chosen = sorted({0, len(steps) // 2, len(steps) - 1})
    return {
        "report_steps": steps,
        "detail": {str(steps[n]["report"]): detail[n] for n in chosen},
    }


def facts(path):
    return facts_of_run(path) if path.endswith(".EGRID") else facts_of_deck(path)


if __name__ == "__main__":
    cases = {case: facts(os.path.join(ROOT, case)) for case in CASES}
    with open(os.path.join(HERE, "facts.json"), "w") as out:
        json.dump(cases, out, indent=1)
        out.write("\n")
