#!/usr/bin/env python3
"""Writes grid.grdecl and regions.grdecl: the grid, rock and regions of SCISSOR.DATA.

Python 3, standard library only, seeded: the same script always writes the same file.
Run it in this directory: `python3 make_grid.py`.

Conventions: lengths in meters, depth positive down. i runs along local x, j along local y,
k downwards. Indices count from zero here and from one in the file. A *line* is a row of
pillars: line i lies between the columns i-1 and i.
"""

import math
import random

NI, NJ, NK = 40, 30, 10
DX, DY = 100.0, 100.0
SEED = 20050101

# Faults. F1 and F2 follow lines of constant i and bound a graben; F3 follows a line of
# constant j and starts at F2. Each tuple of cells is half open.
F1_LINE, F2_LINE, F3_LINE = 13, 24, 11
F2_TIP = 21  # line j at which the throw of F2 has died out (the scissor's hinge)
F3_TIP = 34  # line i at which the throw of F3 has died out

# Pillars are straight between these two depths.
Z_TOP, Z_BASE = 2100.0, 2400.0
DATUM = 2200.0

# Layers: thickness where the unit is complete, and the unit it belongs to.
UPPER, SHALE, WEDGE, LOWER = "upper sand", "shale", "wedge", "lower sand"
LAYERS = [
    (8.0, UPPER), (7.0, UPPER), (9.0, UPPER),
    (4.0, SHALE),
    (9.0, WEDGE), (8.0, WEDGE),
    (8.0, LOWER), (9.0, LOWER), (10.0, LOWER), (9.0, LOWER),
]

CHANNEL, OVERBANK = 1, 2  # SATNUM


# ---------------------------------------------------------------- random fields

class SmoothNoise:
    """A sum of random plane waves: zero mean, unit variance, smooth over `length`."""

    def __init__(self, rng, length, waves=24):
        self.waves = []
        for _ in range(waves):
            angle = rng.uniform(0.0, 2.0 * math.pi)
            number = 2.0 * math.pi / length * rng.uniform(0.4, 1.3)
            phase = rng.uniform(0.0, 2.0 * math.pi)
            self.waves.append((number * math.cos(angle), number * math.sin(angle), phase))

    def __call__(self, x, y):
        total = sum(math.cos(a * x + b * y + p) for a, b, p in self.waves)
        return total * math.sqrt(2.0 / len(self.waves))


class Channel:
    """A meandering belt that runs along x with its axis at y = axis(x)."""

    def __init__(self, rng, y, width):
        self.y, self.width = y, width
        self.swing = rng.uniform(110.0, 190.0)
        self.length = rng.uniform(1300.0, 1900.0)
        self.phase = rng.uniform(0.0, 2.0 * math.pi)
        self.drift = rng.uniform(-0.05, 0.05)

    def contains(self, x, y):
        bend = 2.0 * math.pi * x / self.length + self.phase
        axis = self.y + self.drift * (x - 2000.0) + self.swing * math.sin(bend)
        return abs(y - axis) < 0.5 * self.width


# ---------------------------------------------------------------- faults

def ramp(t):
    """Rises smoothly from 0 at t <= 0 to 1 at t >= 1."""
    t = min(max(t, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def throw_f1(j):
    """Down to the east along the whole model, largest in the middle."""
    return 9.0 + 19.0 * math.sin(math.pi * j / NJ) ** 2


def throw_f2(j):
    """Down to the west, a scissor: 46 m in the south, nothing from the tip northwards."""
    return 46.0 * ramp((F2_TIP - j) / F2_TIP)


def throw_f3(i):
    """Down to the south, largest at F2, dying out eastwards."""
    return 24.0 * ramp((F3_TIP - i) / (F3_TIP - F2_LINE))


def drag(throw, distance, hanging):
    """Displacement at a distance from a fault; both walls bend back to the regional level."""
    share = 0.6 if hanging else -0.4
    return share * throw * math.exp(-abs(distance) / 900.0)


def displacement(pi, pj, ci, cj):
    """Depth change at pillar (pi, pj) as the cell column (ci, cj) beside it sees it.

    The pillar gives the distance and the column the side, so that depths jump at a fault
    and nowhere else.
    """
    total = drag(throw_f1(pj), DX * (pi - F1_LINE), ci >= F1_LINE)
    total += drag(throw_f2(pj), DX * (pi - F2_LINE), ci < F2_LINE)
    if ci >= F2_LINE:
        fade = ramp((F2_TIP - pj) / (F2_TIP - F3_LINE))  # nothing left at the tip of F2
        total += fade * drag(throw_f3(pi), DY * (pj - F3_LINE), cj < F3_LINE)
    return total


# ---------------------------------------------------------------- pillars

def pillar_foot(i, j):
    """Local x, y of a pillar at DATUM: lines bend so that the fault traces curve."""
    x, y = DX * i, DY * j
    bend = 130.0 * math.sin(math.pi * (y / (DY * NJ) * 1.2 + 0.35 * x / (DX * NI)))
    sway = 90.0 * math.sin(math.pi * (x / (DX * NI) * 1.4 + 0.2))
    return x + bend, y + sway


def pillar_slope(i, j):
    """Horizontal shift (x, y) per meter of depth: steepest leaning on the fault lines."""
    def near(line, p):
        return ramp(1.0 - abs(p - line) / 6.0)

    east = 0.50 * near(F1_LINE, i)
    west = 0.45 * near(F2_LINE, i) * ramp((F2_TIP + 4 - j) / 8.0)
    along_f3 = ramp((F3_TIP + 2 - i) / 6.0) * ramp((i - F2_LINE + 5) / 5.0)
    south = 0.40 * near(F3_LINE, j) * along_f3
    return east - west, -south


def pillar_at(i, j, depth):
    (x, y), (sx, sy) = pillar_foot(i, j), pillar_slope(i, j)
    return x + sx * (depth - DATUM), y + sy * (depth - DATUM)


# ---------------------------------------------------------------- layers

class Geology:
    """Everything random, drawn once in a fixed order."""

    def __init__(self):
        rng = random.Random(SEED)
        self.relief = SmoothNoise(rng, 2200.0)
        self.isopach = SmoothNoise(rng, 2600.0)
        self.edge = SmoothNoise(rng, 1400.0)
        self.quality = [SmoothNoise(rng, 700.0) for _ in LAYERS]
        self.channels = {
            UPPER: [Channel(rng, y, 260.0) for y in (650.0, 1450.0, 2250.0)],
            WEDGE: [Channel(rng, y, 300.0) for y in (900.0, 1900.0)],
            LOWER: [Channel(rng, y, 320.0) for y in (1100.0, 2100.0)],
        }

    def top(self, x, y):
        """Top of the reservoir before faulting: a regional dip to the west and a gentle dome."""
        u, v = (x - 2750.0) / 1500.0, (y - 1350.0) / 1250.0
        return 2140.0 + 48.0 * (u * u + v * v) / (1.0 + 0.18 * (u * u + v * v)) \
            - 0.008 * (x - 2750.0) + 3.0 * self.relief(x, y)

    def thickness(self, k, x, y):
        """Zero, exactly, where the wedge has pinched out towards the north-east."""
        full, unit = LAYERS[k]
        t = full * (1.0 + 0.10 * self.isopach(x, y))
        if unit is WEDGE:
            inside = 2900.0 - (0.80 * (x - 300.0) + 0.75 * (y - 300.0)) + 90.0 * self.edge(x, y)
            # The deeper of the two wedge layers reaches farther.
            t *= min(max((inside + (250.0 if k == 5 else 0.0)) / 1300.0, 0.0), 1.0)
        return t if t > 0.25 else 0.0

    def in_channel(self, k, x, y):
        shift = 40.0 * (k % 3)  # belts wander from layer to layer
        return any(c.contains(x, y + shift) for c in self.channels.get(LAYERS[k][1], []))


def column_depths(geo, ci, cj):
    """Depths of a column: for each of its four pillars (di fastest) the NK + 1 interfaces."""
    columns = []
    for dj in (0, 1):
        for di in (0, 1):
            pi, pj = ci + di, cj + dj
            x, y = pillar_foot(pi, pj)
            depths = [geo.top(x, y) + displacement(pi, pj, ci, cj)]
            for k in range(NK):
                depths.append(depths[-1] + geo.thickness(k, x, y))
            columns.append([round(d, 2) for d in depths])
    return columns


# ---------------------------------------------------------------- cells

def in_field(geo, i, j):
    """The irregular outline of the model and the mud-filled hole in the graben."""
    u, v = (i + 0.5 - NI / 2) / (NI / 2), (j + 0.5 - NJ / 2) / (NJ / 2)
    radius = (abs(u) ** 3.2 + abs(v) ** 3.2) ** (1 / 3.2)
    if radius > 0.98 + 0.05 * geo.edge(DX * i, DY * j):
        return False
    return ((i - 18.5) / 2.2) ** 2 + ((j - 9.5) / 3.0) ** 2 > 1.0


def in_shale_patch(i, j, k):
    """Inactive shale in the lower sand only: a hole that does not reach the top."""
    return LAYERS[k][1] is LOWER and ((i - 29.5) / 2.7) ** 2 + ((j - 18.0) / 2.2) ** 2 < 1.0


def rock(geo, i, j, k, x, y):
    """Facies, porosity, permeability (mD), net to gross and kv/kh of a cell."""
    noise, unit = geo.quality[k](x, y), LAYERS[k][1]
    if unit is SHALE:
        return OVERBANK, 0.09 + 0.01 * noise, 2.0 * math.exp(0.4 * noise), 0.25, 0.01
    if geo.in_channel(k, x, y):
        best = 2200.0 if unit is UPPER else 1300.0
        return CHANNEL, 0.27 + 0.012 * noise, best * math.exp(0.30 * noise), 0.95, 0.2
    base = 70.0 if unit is UPPER else 130.0
    return OVERBANK, 0.19 + 0.02 * noise, base * math.exp(0.55 * noise), 0.70 + 0.06 * noise, 0.05


def block(i, j):
    """Fault block (FIPNUM): west, graben, east, and south-east behind F2 and F3."""
    if i < F1_LINE:
        return 1
    if i < F2_LINE:
        return 2
    return 4 if j < F3_LINE else 3


# ---------------------------------------------------------------- file

def write_keyword(out, name, values, per_line=12):
    """Writes a keyword; runs of equal values become `n*value`."""
    items, n = [], 0
    while n < len(values):
        end = n
        while end < len(values) and values[end] == values[n]:
            end += 1
        items.append(values[n] if end - n == 1 else f"{end - n}*{values[n]}")
        n = end
    out.write(f"{name}\n")
    for start in range(0, len(items), per_line):
        out.write(" ".join(items[start:start + per_line]) + "\n")
    out.write("/\n\n")


def coord():
    values = []
    for j in range(NJ + 1):
        for i in range(NI + 1):
            for depth in (Z_TOP, Z_BASE):
                values += [f"{c:.2f}" for c in (*pillar_at(i, j, depth), depth)]
    return values


def zcorn(columns):
    """i fastest with both corners of a cell, then j likewise, then top and base of k."""
    return [
        f"{columns[i][j][2 * dj + di][k + dk]:.2f}"
        for k in range(NK) for dk in (0, 1)
        for j in range(NJ) for dj in (0, 1)
        for i in range(NI) for di in (0, 1)
    ]


def main():
    geo = Geology()
    columns = [[column_depths(geo, i, j) for j in range(NJ)] for i in range(NI)]
    actnum, satnum, fipnum, poro, permx, permz, ntg = ([] for _ in range(7))
    for k in range(NK):
        for j in range(NJ):
            for i in range(NI):
                x, y = pillar_foot(i + 0.5, j + 0.5)
                facies, phi, perm, net, ratio = rock(geo, i, j, k, x, y)
                thick = any(c[k + 1] > c[k] for c in columns[i][j])
                active = thick and in_field(geo, i, j) and not in_shale_patch(i, j, k)
                actnum.append("1" if active else "0")
                satnum.append(str(facies))
                fipnum.append(str(block(i, j)))
                poro.append(f"{phi:.3f}")
                permx.append(f"{perm:.3g}" if perm < 1000 else f"{perm:.0f}")
                permz.append(f"{perm * ratio:.3g}")
                ntg.append(f"{net:.2f}")
    with open("grid.grdecl", "w", encoding="ascii", newline="\n") as out:
        out.write("-- Written by make_grid.py; change the script, not this file.\n\n")
        write_keyword(out, "COORD", coord(), 6)
        write_keyword(out, "ZCORN", zcorn(columns))
        write_keyword(out, "ACTNUM", actnum, 20)
        for name, values in (("PORO", poro), ("PERMX", permx), ("PERMZ", permz), ("NTG", ntg)):
            write_keyword(out, name, values)
    with open("regions.grdecl", "w", encoding="ascii", newline="\n") as out:
        out.write("-- Written by make_grid.py; change the script, not this file.\n\n")
        write_keyword(out, "SATNUM", satnum, 20)
        write_keyword(out, "FIPNUM", fipnum, 20)


if __name__ == "__main__":
    main()
