"""Three small noisy meshes with oriented faces: closed, open, and a CAD part. Same ones every time."""

import numpy as np


def weld(corners):
    """Vertices and faces of quads given by their four corners on a grid of whole numbers, cut into triangles."""
    index, faces = {}, []
    for quad in corners:
        a, b, c, d = (index.setdefault(tuple(p), len(index)) for p in quad)
        faces += [(a, b, c), (a, c, d)]
    return np.array(list(index), float), np.array(faces)


def sphere(levels=2):
    """An icosahedron cut finer, drawn out along z and bumpy."""
    g = (1 + 5**0.5) / 2
    x = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
         (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    x = [np.array(p) / np.linalg.norm(p) for p in x]
    for _ in range(levels):
        middle, finer = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(x)
                x.append((x[a] + x[b]) / np.linalg.norm(x[a] + x[b]))
            return middle[key]

        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    x = np.array(x)
    x *= (1 + 0.2 * x[:, :1] * x[:, 1:2] + 0.1 * x[:, 2:] ** 3)
    return x * [1, 1, 1.4], np.array(faces)


def sheet(n=14):
    """A wavy square whose points stand unevenly."""
    u, v = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    x = np.c_[u.ravel(), v.ravel(), np.zeros(n * n)].astype(float) / (n - 1)
    x[:, 0] = x[:, 0] ** 1.3
    x[:, 2] = 0.2 * np.sin(4 * x[:, 0]) * np.cos(3 * x[:, 1])
    at = lambda i, j: i * n + j
    faces = []
    for i in range(n - 1):
        for j in range(n - 1):
            faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    return x, np.array(faces)


def part(k=4):
    """An L of three cubes with k squares along an edge: flat sides, sharp edges, one of them concave."""
    solid = {(0, 0, 0), (1, 0, 0), (0, 1, 0)}
    cells = {(k * a + i, k * b + j, l) for a, b, _ in solid for i in range(k) for j in range(k) for l in range(k)}
    quads = []
    for cell in cells:
        for axis in range(3):
            for side in (0, 1):
                beside = list(cell)
                beside[axis] += 2 * side - 1
                if tuple(beside) in cells:
                    continue
                p, q = (axis + 1) % 3, (axis + 2) % 3
                loop = [(0, 0), (1, 0), (1, 1), (0, 1)]
                quad = []
                for dp, dq in loop if side else loop[::-1]:
                    corner = list(cell)
                    corner[axis] += side
                    corner[p] += dp
                    corner[q] += dq
                    quad.append(corner)
                quads.append(quad)
    return weld(sorted(quads))


def cube(k):
    """[-1, 1]^3 with k squares along an edge."""
    square, quads = [(0, 0), (1, 0), (1, 1), (0, 1)], []
    for axis in range(3):
        for side in (0, k):
            for i in range(k):
                for j in range(k):
                    quad = [np.roll([side, i + a, j + b], axis) for a, b in (square if side else square[::-1])]
                    quads.append(quad)
    x, faces = weld(quads)
    return 2 * x / k - 1, faces


def noisy_torus_points(n, seed, times_spacing=0.5):
    """Points of a torus of radii 1 and 0.4, even over its area, with noise in times their mean spacing."""
    rng = np.random.default_rng(seed)
    u, v = 2 * np.pi * rng.random((2, 8 * n))
    keep = rng.random(8 * n) < (1 + 0.4 * np.cos(v)) / 1.4
    u, v = u[keep][:n], v[keep][:n]
    x = np.c_[(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)]
    return x + times_spacing * np.sqrt(4 * np.pi**2 * 0.4 / n) / 2 * rng.standard_normal(x.shape)


def noisy(mesh, seed, times_edge=0.08):
    x, faces = mesh
    edge = np.linalg.norm(x[faces[:, 0]] - x[faces[:, 1]], axis=1).mean()
    return x + times_edge * edge * np.random.default_rng(seed).standard_normal(x.shape), faces


def all_meshes():
    return {"closed": noisy(sphere(), 1), "open": noisy(sheet(), 2), "CAD": noisy(part(), 3)}
