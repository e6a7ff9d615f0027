#!/usr/bin/env python3
"""Prints tests/data/golden/flip.csv: FLIP of a pair of pictures, by two-dimensional sums.

Written from the formulas of andersson2020flip alone, in double precision, with nothing but the
standard library: no filter is separated and nothing is shared with tools/harness/flip.cpp.
"""
import math

WIDTH, HEIGHT = 24, 18


def reference_picture(x, y):
    """8-bit sRGB: a coloured gradient with a bright square and a dark line."""
    if 6 <= x < 12 and 5 <= y < 11:
        return (240, 236, 210)
    if y == 14:
        return (12, 20, 40)
    return (40 + 7 * x, 30 + 9 * y, 200 - 5 * x)


def test_picture(x, y):
    """The same, with the square moved, some noise, and one red pixel."""
    if (x, y) == (19, 4):
        return (255, 0, 0)
    noise = (x * 37 + y * 91 + x * y * 53) % 17 - 8
    return tuple(min(max(v + noise, 0), 255) for v in reference_picture(x - 1, y))


def linear(v):
    s = v / 255
    return s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4


M = [[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
     [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
     [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]]
# The published inverse, rounded as it is there.
INVERSE = [[3.241003275, -1.537398934, -0.498615861],
           [-0.969224334, 1.875930071, 0.041554224],
           [0.055639423, -0.204011202, 1.057148933]]
WHITE = (0.950428545, 1.0, 1.088900371)


def times(m, v):
    return [sum(m[i][j] * v[j] for j in range(3)) for i in range(3)]


def ycxcz(rgb):
    x, y, z = (c / w for c, w in zip(times(M, rgb), WHITE))
    return (116 * y - 16, 500 * (x - y), 200 * (y - z))


def hunt_lab(rgb):
    def f(t):
        d = 6 / 29
        return t ** (1 / 3) if t > d ** 3 else t / (3 * d * d) + 4 / 29
    x, y, z = (f(c / w) for c, w in zip(times(M, rgb), WHITE))
    lightness = 116 * y - 16
    return (lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z))


def correlate(plane, kernel, radius):
    result = []
    for y in range(HEIGHT):
        row = []
        for x in range(WIDTH):
            total = 0.0
            for j in range(-radius, radius + 1):
                for i in range(-radius, radius + 1):
                    total += (kernel[j + radius][i + radius] *
                              plane[min(max(y + j, 0), HEIGHT - 1)][min(max(x + i, 0), WIDTH - 1)])
            row.append(total)
        result.append(row)
    return result


def square(radius, f):
    return [[f(i, j) for i in range(-radius, radius + 1)] for j in range(-radius, radius + 1)]


def sensitivity(ppd, a1, b1, a2, b2):
    radius = math.ceil(3 * math.sqrt(0.04 / (2 * math.pi ** 2)) * ppd)

    def f(i, j):
        d2 = (i / ppd) ** 2 + (j / ppd) ** 2
        return sum(a * math.sqrt(math.pi / b) * math.exp(-math.pi ** 2 * d2 / b)
                   for a, b in ((a1, b1), (a2, b2)) if a)
    kernel = square(radius, f)
    total = sum(map(sum, kernel))
    return [[v / total for v in row] for row in kernel], radius


def as_seen(picture, ppd):
    opponent = [[ycxcz(rgb) for rgb in row] for row in picture]
    csf = [(1, 0.0047, 0, 1), (1, 0.0053, 0, 1), (34.1, 0.04, 13.5, 0.025)]
    planes = [correlate([[v[c] for v in row] for row in opponent], *sensitivity(ppd, *csf[c]))
              for c in range(3)]

    def rgb(x, y):
        value = (planes[0][y][x] + 16) / 116
        xyz = (value + planes[1][y][x] / 500, value, value - planes[2][y][x] / 200)
        return [min(max(v, 0.0), 1.0)
                for v in times(INVERSE, [c * w for c, w in zip(xyz, WHITE)])]
    return [[rgb(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


def hyab(a, b):
    return abs(a[0] - b[0]) + math.sqrt((a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


def features(picture, ppd, kind):
    sd = 0.5 * 0.082 * ppd
    radius = math.ceil(3 * sd)

    def f(i, j):
        g = math.exp(-(i * i + j * j) / (2 * sd * sd))
        return -i * g if kind == 'edge' else (i * i / (sd * sd) - 1) * g
    kernel = square(radius, f)
    positive = sum(v for row in kernel for v in row if v > 0)
    negative = -sum(v for row in kernel for v in row if v < 0)
    kernel = [[v / (positive if v > 0 else negative) for v in row] for row in kernel]
    luminance = [[(ycxcz(rgb)[0] + 16) / 116 for rgb in row] for row in picture]
    gx = correlate(luminance, kernel, radius)
    gy = correlate(luminance, [list(column) for column in zip(*kernel)], radius)
    return [[math.hypot(a, b) for a, b in zip(*rows)] for rows in zip(gx, gy)]


def flip(test, reference, ppd):
    largest = hyab(hunt_lab((0, 1, 0)), hunt_lab((0, 0, 1))) ** 0.7
    seen = [as_seen(p, ppd) for p in (test, reference)]
    edges = [features(p, ppd, 'edge') for p in (test, reference)]
    points = [features(p, ppd, 'point') for p in (test, reference)]

    def value(x, y):
        e = hyab(hunt_lab(seen[0][y][x]), hunt_lab(seen[1][y][x])) ** 0.7
        knee = 0.4 * largest
        color = (0.95 / knee * e if e < knee else
                 0.95 + (e - knee) / (largest - knee) * 0.05)
        feature = max(abs(edges[0][y][x] - edges[1][y][x]),
                      abs(points[0][y][x] - points[1][y][x])) / math.sqrt(2)
        return color ** (1 - feature ** 0.5)
    return [[value(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


def main():
    def picture(f):
        return [[[linear(v) for v in f(x, y)] for x in range(WIDTH)] for y in range(HEIGHT)]
    print('pixels_per_degree,x,y,flip')
    for ppd in (3840 * math.pi / 180, 20.0):
        values = flip(picture(test_picture), picture(reference_picture), ppd)
        for y in range(HEIGHT):
            for x in range(WIDTH):
                print(f'{ppd:.12g},{x},{y},{values[y][x]:.9g}')


main()
