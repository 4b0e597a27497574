#!/usr/bin/env python3
"""Writes sugarloaf.asc: a steep granite dome of the Sugarloaf's height with its lower neighbour, from a formula (no survey data).

A dome is H / (1 + (rho / a(phi))^n): round on top, steepest at half its height, with an apron at its foot; rho and phi are polar
coordinates about its axis, stretched along x. Ribs and gullies come from a(phi) = a (1 + sum_k b_k cos(k phi + c_k)).
"""
import math

COLUMNS, ROWS, CELL = 70, 70, 10.0


def dome(x, z, height, radius, stretch, power, ribs):
    rho, phi = math.hypot(x / stretch, z), math.atan2(z, x / stretch)
    a = radius * (1.0 + sum(b * math.cos(k * phi + c) for k, b, c in ribs))
    return height / (1.0 + (rho / a) ** power)


def height(x, z):
    main = dome(x - 60.0, z, 380.0, 115.0, 1.25, 3.6, [(3, 0.05, 0.4), (5, 0.04, 1.9), (9, 0.025, 0.7)])
    neighbour = dome(x + 260.0, z - 70.0, 190.0, 95.0, 1.1, 3.0, [(3, 0.06, 2.0), (7, 0.03, 0.3)])
    apron = 12.0 + 0.012 * (345.0 - z) + 3.0 * math.sin(x / 57.0 + 0.5) * math.cos(z / 43.0)
    return apron + math.sqrt(main * main + neighbour * neighbour)


with open("sugarloaf.asc", "w") as f:
    f.write(f"ncols {COLUMNS}\nnrows {ROWS}\nxllcorner 0\nyllcorner 0\ncellsize {CELL:g}\n")
    for row in range(ROWS):
        z = (row - 0.5 * (ROWS - 1)) * CELL
        f.write(" ".join(f"{height((c - 0.5 * (COLUMNS - 1)) * CELL, z):.2f}" for c in range(COLUMNS)) + "\n")
