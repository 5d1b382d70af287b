"""Finds the targets of simulated ground control in an orthophoto: squares of four fields, black and white in turn, in any direction."""
import math


def brightness(raster, column, row):
    """Between cell centres; cell (0, 0) has its centre at (0.5, 0.5). NaN outside and where there is no data."""
    x, y = column - 0.5, row - 0.5
    i, j = math.floor(x), math.floor(y)
    if not (0 <= i < raster.width - 1 and 0 <= j < raster.height - 1):
        return math.nan
    a, b = x - i, y - j
    upper, lower = raster.values[j], raster.values[j + 1]
    return (upper[i] * (1 - a) + upper[i + 1] * a) * (1 - b) + (lower[i] * (1 - a) + lower[i + 1] * a) * b


def pattern(half, angle):
    """(column, row, sign) of samples in the four fields of a target with sides of 2 half cells."""
    steps = [-0.8, -0.5, -0.2, 0.2, 0.5, 0.8]
    c, s = half * math.cos(angle), half * math.sin(angle)
    return [(u * c - v * s, u * s + v * c, 1 if u * v > 0 else -1) for u in steps for v in steps]


def contrast(raster, column, row, samples):
    """Of the fields, 0 to 1."""
    return abs(sum(sign * brightness(raster, column + x, row + y) for x, y, sign in samples)) / (255.0 * len(samples) / 2.0)


def find_target(raster, easting, northing, side_m, reach_m):
    """(contrast, east, north): the best place at most reach_m from a position, on each axis, and how far it is from there in metres. Contrast 0: none."""
    column, row = (easting - raster.left) / raster.cell, (raster.top - northing) / raster.cell
    half, best, angle = side_m / 2.0 / raster.cell, (0.0, 0.0, 0.0), 0.0
    steps = math.ceil(2.0 * reach_m / raster.cell)
    for samples_angle in (math.radians(10.0 * k) for k in range(9)):
        samples = pattern(half, samples_angle)
        for x in range(-steps, steps + 1):
            for y in range(-steps, steps + 1):
                found = contrast(raster, column + x / 2.0, row + y / 2.0, samples)
                if found > best[0]:
                    best, angle = (found, x / 2.0, y / 2.0), samples_angle
    samples, coarse = pattern(half, angle), best
    for x in range(-4, 5):
        for y in range(-4, 5):
            at = (coarse[1] + x / 8.0, coarse[2] + y / 8.0)
            best = max(best, (contrast(raster, column + at[0], row + at[1], samples), *at))
    return best[0], best[1] * raster.cell, -best[2] * raster.cell
