#!/usr/bin/env python3
"""Pictures of a finished `calomel simulate CASE --fields`: strain records, and a section through the middle plane y = 0.

  full_size_picture.py OUT_DIR RECORDS.png SECTION.png

Needs numpy, matplotlib and netCDF4 (Debian: python3-matplotlib python3-netcdf4).
"""
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import netCDF4
import numpy as np
from matplotlib.collections import PolyCollection


def names(variable):
    return ["".join(c.decode() for c in row if c not in (b"\0", np.ma.masked)).strip() for row in variable[:]]


def records(path, picture):
    with netCDF4.Dataset(path) as data:
        time, strain = 1e6 * data["time"][:], 1e6 * np.asarray(data["strain"][:])
        sensors = [str(s) for s in data["sensor"][:]]
    strain = strain.reshape(len(sensors), -1)
    rows = (len(sensors) + 2) // 3
    figure, axes = plt.subplots(rows, 3, figsize=(12, 1.7 * rows), sharex=True, squeeze=False)
    for axis, name, history in zip(axes.flat, sensors, strain):
        axis.plot(time, history, lw=0.7, color="#1f6f8b")
        axis.set_title(name, fontsize=9, loc="left", pad=2)
        axis.axhline(0, color="#ccc", lw=0.5, zorder=0)
        axis.tick_params(labelsize=7)
    for axis in axes[-1]:
        axis.set_xlabel("time, µs", fontsize=8)
    for axis in axes[:, 0]:
        axis.set_ylabel("strain, 1e-6", fontsize=8)
    figure.tight_layout()
    figure.savefig(picture, dpi=100)


class Section:
    """The elements at y = 0 as quadrilaterals in x and z, block by block."""

    def __init__(self, data):
        x, y, z = (np.asarray(data["coord" + c][:]) for c in "xyz")
        flat = np.abs(y) < 1e-6
        self.blocks = []
        for block in range(1, len(data.dimensions["num_el_blk"]) + 1):
            corners = np.asarray(data[f"connect{block}"][:]) - 1
            here = np.flatnonzero(flat[corners].sum(axis=1) >= 4)
            quads = []
            for element in here:
                face = corners[element][flat[corners[element]]][:4]
                points = np.column_stack([x[face], z[face]])
                around = points - points.mean(axis=0)
                quads.append(1e3 * points[np.argsort(np.arctan2(around[:, 1], around[:, 0]))])
            self.blocks.append((here, quads))

    def draw(self, axis, block, values, colours, limits):
        quads = self.blocks[block][1]
        drawn = PolyCollection(quads, array=values, cmap=colours, edgecolors="face", linewidths=0.1)
        drawn.set_clim(*limits)
        axis.add_collection(drawn)
        axis.autoscale_view()
        axis.set_aspect("equal")
        axis.tick_params(labelsize=7)
        return drawn


def sections(path, picture):
    with netCDF4.Dataset(path) as data:
        section, time = Section(data), 1e6 * np.asarray(data["time_whole"][:])
        variables = names(data["name_elem_var"])
        number = {name: i + 1 for i, name in enumerate(variables)}
        blocks = names(data["eb_names"])
        steel, mercury = blocks.index("steel"), blocks.index("mercury")

        def values(name, block, step):
            return np.asarray(data[f"vals_elem_var{number[name]}eb{block + 1}"][step])[section.blocks[block][0]]

        steps = sorted({1, len(time) // 2, len(time) - 1})
        counted = "time_at_cutoff" in number  # with an energy balance
        figure, axes = plt.subplots(len(steps) + counted, 1, figsize=(10, 2.2 * (len(steps) + counted)), sharex=True, layout="constrained")
        for axis, step in zip(axes, steps):
            pressure = section.draw(axis, mercury, 1e-6 * values("pressure", mercury, step), "RdBu_r", (-2, 2))
            stress = section.draw(axis, steel, 1e-6 * values("effective_stress", steel, step), "viridis", (0, 60))
            axis.set_title(f"{time[step]:.0f} µs: pressure of the mercury, effective stress of the steel", fontsize=9, loc="left", pad=2)
            for drawn, what in ((stress, "steel, MPa"), (pressure, "mercury, MPa")):
                figure.colorbar(drawn, ax=axis, fraction=0.02).set_label(what, fontsize=7)
        if counted:
            held = section.draw(axes[-1], mercury, 1e6 * values("time_at_cutoff", mercury, steps[-1]), "magma_r", (0, None))
            axes[-1].set_title("time at the cutoff", fontsize=9, loc="left", pad=2)
            figure.colorbar(held, ax=axes[-1], fraction=0.02).set_label("µs", fontsize=7)
        axes[-1].set_xlabel("x, mm", fontsize=8)
        for axis in axes:
            axis.set_ylabel("z, mm", fontsize=8)
        figure.savefig(picture, dpi=100)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    records(os.path.join(sys.argv[1], "simulate.nc"), sys.argv[2])
    sections(os.path.join(sys.argv[1], "fields.exo"), sys.argv[3])
