#!/usr/bin/env python3
"""The figures and tables of the five papers that can be made again, with our numbers.

    python3 docs/papers/figures.py RFSMOOTH [FIGURE ...]     (all without a name; `list` lists them)

Prints a table for each and writes docs/papers/pictures/FIGURE.png. The papers' own models are mostly not to be had;
each function says what stands in for them: shapes made here, and meshes of Debian's libcgal-demo. Needs python3-numpy.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "papers"))
sys.dont_write_bytecode = True
import meshes  # noqa: E402
from compare import read_off, write_off  # noqa: E402
from flows import Mesh  # noqa: E402

WORK = pathlib.Path(tempfile.mkdtemp(prefix="figures"))
COMMAND = "rfsmooth"
FIGURES = {}


def figure(function):
    FIGURES[function.__name__.replace("_", "-")] = function
    return function


# Shapes and measures


def torus(n=60, m=24, uneven=0.0):
    """Radii 1 and 0.4; uneven > 0 draws the rings of one half closer together."""
    u = np.arange(n) / n
    u = 2 * np.pi * (u + uneven * np.sin(2 * np.pi * u) / (2 * np.pi))
    u, v = np.meshgrid(u, 2 * np.pi * np.arange(m) / m, indexing="ij")
    r = 1 + 0.4 * np.cos(v)
    x = np.c_[(r * np.cos(u)).ravel(), (r * np.sin(u)).ravel(), (0.4 * np.sin(v)).ravel()]
    at = lambda i, j: (i % n) * m + j % m
    faces = []
    for i in range(n):
        for j in range(m):
            faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    return x, np.array(faces)


def torus_error(x):
    return rms(np.hypot(np.hypot(x[:, 0], x[:, 1]) - 1, x[:, 2]) - 0.4)


def round_sphere(levels=3):
    x, faces = meshes.sphere(levels)
    x = x / [1, 1, 1.4]
    return x / np.linalg.norm(x, axis=1)[:, None], faces


def two_density_sphere():
    """A sphere whose upper half is drawn towards the pole: rings there are up to five times closer."""
    x, faces = round_sphere(3)
    z = np.where(x[:, 2] > 0, 1 - (1 - x[:, 2]) ** 2.2, x[:, 2])
    ring = np.hypot(x[:, 0], x[:, 1])
    scale = np.sqrt(np.maximum(0, 1 - z * z)) / np.maximum(ring, 1e-12)
    return np.c_[x[:, 0] * scale, x[:, 1] * scale, z], faces


def cgal(name):
    with tarfile.open("/usr/share/doc/libcgal-dev/data.tar.gz") as archive:
        (WORK / name).write_bytes(archive.extractfile(f"data/meshes/{name}").read())
    words = (WORK / name).read_text().split()
    n, m = int(words[1]), int(words[2])
    x = np.array(words[4 : 4 + 3 * n], float).reshape(n, 3)
    return x, np.array(words[4 + 3 * n : 4 + 3 * n + 4 * m], int).reshape(m, 4)[:, 1:]


def noisy(mesh, times_edge, seed=1):
    x, faces = mesh
    return x + times_edge * edges(mesh)[0] * np.random.default_rng(seed).standard_normal(x.shape), faces


def edges(mesh):
    """Mean length of the edges, and their coefficient of variation around the vertices: how uneven they are."""
    x, faces = mesh
    pairs = np.unique(np.sort(np.r_[faces[:, :2], faces[:, 1:], faces[:, ::2]], axis=1), axis=0)
    length = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1)
    total, square, count = (np.zeros(len(x)) for _ in range(3))
    for end in pairs.T:
        np.add.at(total, end, length)
        np.add.at(square, end, length**2)
        np.add.at(count, end, 1)
    mean = total / count
    return length.mean(), (np.sqrt(np.maximum(0, square / count - mean**2)) / mean).mean()


def volume(mesh):
    a, b, c = (mesh[0][mesh[1][:, k]] for k in range(3))
    return (a * np.cross(b, c)).sum() / 6


def rms(v):
    return float(np.sqrt((np.asarray(v) ** 2).mean()))


def radius_spread(x):
    """Relative spread of the distances from the centre of the sphere that fits best."""
    r = np.linalg.norm(x - best_sphere(x)[0], axis=1)
    return r.std() / r.mean()


def best_sphere(x):
    fit = np.linalg.lstsq(np.c_[2 * x, np.ones(len(x))], (x * x).sum(1), rcond=None)[0]
    return fit[:3], float(np.sqrt(fit[3] + fit[:3] @ fit[:3]))


# The command


def run(name, mesh, *options, suffix="off"):
    """Smooths a mesh; the result as a mesh, its report, the last row of its trace and its file."""
    before, after = WORK / f"in.{suffix}", WORK / f"{name}.{suffix}"
    (write_off if suffix == "off" else write_ply)(before, *mesh)
    subprocess.run([COMMAND, "smooth-mesh", str(before), str(after), "--force", "--quiet", "--report",
                    str(WORK / "report.json"), "--trace", str(WORK / "trace.csv"), *map(str, options)], check=True)
    with open(WORK / "trace.csv", newline="") as file:
        trace = list(csv.DictReader(file))
    x = read_off(after) if suffix == "off" else None
    return (x, mesh[1]), json.loads((WORK / "report.json").read_text()), trace[-1], after


def write_ply(path, x, faces):
    """For what OFF cannot hold."""
    head = f"ply\nformat ascii 1.0\nelement vertex {len(x)}\nproperty double x\nproperty double y\nproperty double z\n"
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header"
    rows = [" ".join(repr(float(c)) for c in p) for p in x] + [f"3 {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join([head, *rows]) + "\n")


def put(name, mesh):
    write_off(WORK / f"{name}.off", *mesh)
    return WORK / f"{name}.off"


def picture(figure_name, files, labels, *options):
    width, levels = ("165", "4") if "--edges" in options else ("250", "20")  # below 60 KB each
    look = ["--height", "175", "--levels", levels] + ([] if "--width" in options else ["--width", width])
    subprocess.run([COMMAND, "render", *map(str, files), "-o", str(HERE / "pictures" / f"{figure_name}.png"), "--force",
                    "--quiet", "--labels", ",".join(labels), *look, *options], check=True)


def table(title, head, rows):
    print(f"\n**{title}**\n\n| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for row in rows:
        print("| " + " | ".join(c if isinstance(c, str) else f"{c:.3g}" for c in row) + " |")


# Vollmer, Mencl, Mueller 1999


@figure
def vollmer_4():
    """Figures 4 to 6: the Laplacian on a noisy torus, and with the original point."""
    clean, rough = torus(), noisy(torus(), 0.25)
    rows, files, labels = [("noisy", "", 100 * volume(rough) / volume(clean), torus_error(rough[0]))], [put("noisy", rough)], ["noisy"]
    for label, options in [("1 step", ["--iterations", 1]), ("2 steps", ["--iterations", 2]), ("3 steps", ["--iterations", 3]),
                           ("alpha 0.1", ["--iterations", 50, "--anchor", "original", "--alpha", 0.1]),
                           ("alpha 0.6", ["--iterations", 50, "--anchor", "original", "--alpha", 0.6]),
                           ("HC 3 steps", None)]:
        flow = ["--flow", "laplacian", *options] if options else ["--flow", "hc", "--iterations", 3]
        mesh, _, trace, file = run(f"v4{len(files)}", rough, "--paper", *flow)
        rows.append((label, float(trace["roughness"]), 100 * volume(mesh) / volume(clean), torus_error(mesh[0])))
        files.append(file)
        labels.append(label)
    table("Vollmer 4 to 6: noisy torus", ["", "roughness, degrees", "volume, %", "error"], rows)
    picture("vollmer-4", [files[k] for k in (0, 3, 4, 6)], [labels[k] for k in (0, 3, 4, 6)])


@figure
def vollmer_8():
    """Figures 8 and 9: a noisy cube, four steps of the Laplacian against four of HC; its two half steps in turn."""
    x, faces = meshes.weld([q for q in cube_quads(12)])
    clean = (x / 12, faces)
    rough = noisy(clean, 0.25)
    rows, files = [("noisy", "", 100 * volume(rough), 1.0)], [put("noisy", rough)]
    for flow in ("laplacian", "hc"):
        for steps in (1, 2, 3, 4):
            mesh, _, trace, file = run(f"v8{flow}{steps}", rough, "--paper", "--flow", flow, "--iterations", steps)
            corner = np.abs(mesh[0] - 0.5).max()
            rows.append((f"{flow}, {steps}", float(trace["roughness"]), 100 * volume(mesh), 2 * corner))
        files.append(file)
    # HC's own first half: the Laplacian step that its second half takes back.
    mesh = run("v8b", run("v8c", rough, "--flow", "hc", "--iterations", 3)[0], "--flow", "laplacian", "--iterations", 1)[0]
    rows.append(("3 of hc and the Laplacian half of the fourth", "", 100 * volume(mesh), 2 * np.abs(mesh[0] - 0.5).max()))
    table("Vollmer 8, 9: noisy cube", ["steps", "roughness, degrees", "volume, %", "largest extent"], rows)
    picture("vollmer-8", files, ["noisy", "Laplacian 4", "HC 4"], "--direction", "-1,-0.7,-0.5")


def cube_quads(k):
    for axis in range(3):
        p, q = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, k):
            for i in range(k):
                for j in range(k):
                    quad = []
                    for dp, dq in [(0, 0), (1, 0), (1, 1), (0, 1)][:: 1 if side else -1]:
                        c = [0, 0, 0]
                        c[axis], c[p], c[q] = side, i + dp, j + dq
                        quad.append(c)
                    yield quad


@figure
def vollmer_10():
    """Figures 10 to 14: noisy points, their EMST, SDG and RFS-mesh, and the RFS-mesh smoothed by HC with swaps."""
    x, _ = noisy(torus(70, 28), 0.25)
    np.savetxt(WORK / "cloud.xyz", x)
    rows, files = [], [WORK / "cloud.xyz"]
    for stage in ("emst", "sdg", "rfs"):
        out = WORK / f"{stage}.ply"
        subprocess.run([COMMAND, "mesh", "--stage", stage, str(WORK / "cloud.xyz"), str(out), "--force", "--quiet", "--encoding", "ascii",
                        "--report", str(WORK / "report.json")], check=True)
        counts = json.loads((WORK / "report.json").read_text())["counts"]
        edges_of = counts.get("edges", counts.get("sdg_edges", 0) + counts.get("bridges", 0) or counts.get("emst_edges"))
        rows.append((stage, edges_of / len(x), counts.get("faces", 0) / len(x)))
        files.append(out)
    subprocess.run([COMMAND, "denoise", "--flow", "hc", str(WORK / "cloud.xyz"), str(WORK / "smooth.xyz"), "--force", "--quiet"],
                   check=True)
    after = np.loadtxt(WORK / "smooth.xyz")
    table("Vollmer 10 to 14: points to RFS-mesh", ["stage", "edges per point", "faces per point"], rows)
    table("after HC with swaps", ["", "error"], [("noisy", torus_error(x)), ("smoothed", torus_error(after))])
    picture("vollmer-10", [*files[1:], WORK / "smooth.xyz"], ["EMST", "SDG", "RFS-mesh", "smoothed"], "--edges")


# Desbrun, Meyer, Schroeder, Barr 1999


@figure
def desbrun_4():
    """Figure 4: ten explicit steps against one implicit one of ten, and 20 of lambda|mu. An elephant for the bunny."""
    rough = noisy(cgal("elephant.off"), 0.15)
    rows, files = [], [put("noisy", rough)]
    for label, options in [("10 explicit, dt = 1", ["--flow", "laplacian", "--iterations", 10]),
                           ("1 implicit, dt = 10", ["--flow", "implicit", "--order", 1, "--dt", 10, "--tolerance", 1e-3]),
                           ("1 implicit, volume kept", ["--flow", "implicit", "--order", 1, "--dt", 10, "--tolerance", 1e-3, "--preserve", "volume"]),
                           ("20 lambda|mu", ["--flow", "taubin", "--iterations", 20])]:
        mesh, report, trace, file = run(f"d4{len(files)}", rough, "--paper", *options)
        rows.append((label, float(trace["roughness"]), 100 * volume(mesh) / volume(rough), str(report["counts"]["solver_iterations"])))
        files.append(file)
    table("Desbrun 4", ["", "roughness, degrees", "volume, %", "solver iterations"], rows)
    picture("desbrun-4", [files[k] for k in (0, 1, 2, 4)], ["noisy", "explicit", "implicit", "lambda|mu"])


@figure
def desbrun_table():
    """The table of 2.8: iterations of the solver at dt = 10 and 100, umbrella, first power."""
    rows = []
    for name in ("elephant.off", "couplingdown.off", "head.off"):
        mesh = noisy(cgal(name), 0.1)
        row = [name, str(len(mesh[1]))]
        for tolerance in (1e-3, 1e-5):
            for dt in (10, 100):
                report = run("t", mesh, "--paper", "--flow", "implicit", "--order", 1, "--dt", dt, "--tolerance", tolerance)[1]
                row.append(str(report["counts"]["solver_iterations"]))
        rows.append(row)
    table("Desbrun, table of 2.8", ["mesh", "faces", "dt 10, eps 1e-3", "dt 100, eps 1e-3", "dt 10, eps 1e-5", "dt 100, eps 1e-5"], rows)


@figure
def desbrun_10():
    """Figures 7 and 10: a sphere of two sampling rates under the three operators, volume kept."""
    clean = two_density_sphere()
    rows, files = [("given", radius_spread(clean[0]), edges(clean)[1])], [put("given", clean)]
    for operator in ("umbrella", "scale-dependent", "curvature"):
        mesh, _, _, file = run(f"d10{operator}", clean, "--paper", "--flow", "implicit", "--order", 1, "--operator", operator,
                               "--dt", 3, "--iterations", 4, "--preserve", "volume")
        rows.append((operator, radius_spread(mesh[0]), edges(mesh)[1]))
        files.append(file)
    table("Desbrun 7, 10: two-density sphere", ["operator", "spread of the radius", "unevenness of edges"], rows)
    picture("desbrun-10", files, ["given", "umbrella", "scale-dep.", "curvature"], "--edges", "--direction", "0,-1,-0.3")


# Ohtake, Belyaev, Bogaevski 2000


def ohtake_flows(steps):
    return [("Laplacian", ["--flow", "laplacian", "--lambda", 0.3, "--iterations", steps]),
            ("Taubin", ["--flow", "taubin", "--lambda", 0.3, "--mu", 0.3093, "--iterations", 2 * steps]),
            ("bilaplacian", ["--flow", "bilaplacian", "--lambda", 0.3, "--iterations", 2 * steps]),
            ("mean curvature", ["--flow", "curvature", "--lambda", 0.3, "--iterations", 2 * steps]),
            ("(11)", ["--flow", "modified-curvature", "--lambda", 0.3, "--iterations", 2 * steps]),
            ("(12), (13)", ["--flow", "median-direction", "--lambda", 0.3, "--iterations", 2 * steps])]


def ohtake_rows(name, rough, measure, steps):
    rows, files = [("noisy", "", measure(rough[0]), edges(rough)[1])], [put("noisy", rough)]
    for label, options in ohtake_flows(steps):
        mesh, _, trace, file = run(f"{name}{len(rows)}", rough, "--paper", *options)
        rows.append((label, float(trace["roughness"]), measure(mesh[0]), edges(mesh)[1]))
        files.append(file)
    return rows, files


@figure
def ohtake_1():
    """Figure 1, top row: a noisy sphere. Error: spread of the radius."""
    rows, files = ohtake_rows("o1", noisy(round_sphere(3), 0.12), radius_spread, 8)
    table("Ohtake 1: noisy sphere", ["flow", "roughness, degrees", "spread of the radius", "unevenness of edges"], rows)
    picture("ohtake-1", [files[k] for k in (0, 2, 4, 6)], ["noisy", "Taubin", "curvature", "(13)"], "--edges", "--width", "155")


@figure
def ohtake_4():
    """Figure 4: a noisy torus of two sampling rates."""
    rows, files = ohtake_rows("o4", noisy(torus(70, 28, 0.7), 0.12), torus_error, 4)
    table("Ohtake 4: torus of two sampling rates", ["flow", "roughness, degrees", "error", "unevenness of edges"], rows)
    picture("ohtake-4", [files[k] for k in (0, 2, 3, 4, 5)], ["noisy", "Taubin", "bilaplacian", "curvature", "(11)"])


@figure
def ohtake_7():
    """Figure 7: a bump of two sampling rates, its rim fixed, is drawn flat."""
    x, faces = meshes.sheet(18)
    x[:, 0] = np.where(x[:, 0] < 0.5, x[:, 0] * 0.5, 0.25 + (x[:, 0] - 0.5) * 1.5)
    x[:, 2] = 0.4 * np.sin(np.pi * x[:, 0]) * np.sin(np.pi * x[:, 1])
    rows, files = [("given", 100.0, edges((x, faces))[1])], [put("given", (x, faces))]
    for label, options in [o for o in ohtake_flows(150) if o[0] in ("Laplacian", "mean curvature", "(12), (13)")]:
        mesh, _, _, file = run(f"o7{len(files)}", (x, faces), *options, "--boundary", "fixed")
        rows.append((label, 100 * np.abs(mesh[0][:, 2]).max() / 0.4, edges(mesh)[1]))
        files.append(file)
    table("Ohtake 7: towards a flat patch", ["flow", "height left, %", "unevenness of edges"], rows)
    picture("ohtake-7", files, ["given", "Laplacian", "curvature", "(13)"], "--edges", "--direction", "0.6,1,-0.9", "--width", "240")


@figure
def ohtake_11():
    """Figure 11: ridges and ravines after smoothing. The L of meshes.py for Godzilla: its edges are known."""
    clean = meshes.part(6)
    rough = noisy(clean, 0.1)
    normals = np.cross(clean[0][clean[1][:, 1]] - clean[0][clean[1][:, 0]], clean[0][clean[1][:, 2]] - clean[0][clean[1][:, 0]])
    seen = np.zeros((len(clean[0]), 3), bool)
    for k in range(3):
        for axis in range(3):
            np.logical_or.at(seen[:, axis], clean[1][:, k], np.abs(normals[:, axis]) > 0.5)
    true = seen.sum(1) > 1
    rows, files = [], []
    for label, options in [("none", ["--iterations", 0, "--flow", "hc"])] + ohtake_flows(5):
        _, _, _, file = run(f"o11{len(files)}", rough, *options, "--ridges", suffix="ply")
        text = file.read_bytes()
        found = np.abs(ridge_field(text)) > 0
        rows.append((label, 100 * (found & true).sum() / true.sum(), 100 * (found & true).sum() / max(1, found.sum())))
        files.append(file)
    table("Ohtake 11: ridges and ravines on a part with known edges", ["smoothed by", "edges found, %", "found that are edges, %"], rows)
    picture("ohtake-11", [files[k] for k in (0, 1, 4, 6)], ["noisy", "Laplacian", "curvature", "(13)"], "--color", "field",
            "--field", "ridge", "--low", "-1", "--high", "1", "--direction", "-1,-0.8,-0.7")


def ridge_field(ply):
    """The last field of the vertices of an ascii PLY."""
    head, body = ply.decode().split("end_header\n", 1)
    n = int(head.split("element vertex ")[1].split()[0])
    return np.array([row.split()[-1] for row in body.split("\n")[:n]], float)


# Zhao, Xu 2005


@figure
def zhao_xu_1():
    """Figure 1: a sphere with noise in front only, smoothed along that direction."""
    x, faces = round_sphere(3)
    h = edges((x, faces))[0]
    front = x[:, 0] > 0.2
    rough = x + np.where(front, 0.15 * h * np.random.default_rng(1).standard_normal(len(x)), 0)[:, None] * x
    rows, files = [], [put("noisy", (rough, faces))]

    def measure(p):
        centre, r = best_sphere(p)  # the flow carries a sphere along: (a, n) / R is the speed of a translation
        off = np.linalg.norm(p - centre, axis=1) - r
        return rms(off[front]), rms(off[~front]), float(np.linalg.norm(centre)), 100 * volume((p, faces)) / volume((rough, faces))

    rows.append(("noisy", *measure(rough)))
    for label, options in [("printed, 10 steps", ["--paper", "--iterations", 10]), ("safe, 10 steps", ["--iterations", 10]),
                           ("safe, 40 steps", ["--iterations", 40]), ("printed, 120 steps", ["--paper", "--iterations", 120]), ("safe, 10 steps against it", ["--iterations", 10])]:
        way = "-1,0,0" if "against" in label else "1,0,0"
        mesh, _, _, file = run(f"z1{len(files)}", (rough, faces), "--flow", "directional", "--direction", way, *options)
        rows.append((label, *measure(mesh[0])))
        files.append(file)
    table("Zhao-Xu 1: noise in front", ["", "error in front", "error behind", "moved along", "volume, %"], rows)
    picture("zhao-xu-1", files[:4], ["noisy", "printed 10", "safe 10", "safe 40"], "--direction", "-1,-0.2,-0.2")


@figure
def zhao_xu_3():
    """Figure 3: local directional flow, dt 0.005, m = 0, eps 0.05, after 4, 6, 8 and 11 steps."""
    clean = meshes.part(8)
    rough = noisy(clean, 0.1)
    file = put("noisy", rough)
    distance = lambda x: rms(box_distance(x, 8))
    rows, files = [("noisy", distance(rough[0]), "", "")], [file]
    for label, options in [("4 steps, printed", ["--iterations", 4, "--paper"]), ("8 steps, printed", ["--iterations", 8, "--paper"]),
                           ("11 steps, printed", ["--iterations", 11, "--paper"]), ("8 steps, safe", ["--iterations", 8]),
                           ("8 steps of 0.5, safe", ["--iterations", 8, "--lambda", 0.5])]:
        mesh, _, trace, file = run(f"z3{len(files)}", rough, "--flow", "local-directional", *options)
        still = (np.linalg.norm(mesh[0] - rough[0], axis=1) == 0).mean()
        rows.append((label, distance(mesh[0]), float(trace["roughness"]), 100 * still))
        files.append(file)
    table("Zhao-Xu 3: local directional flow", ["", "error", "roughness, degrees", "never moved, %"], rows)
    picture("zhao-xu-3", [files[k] for k in (0, 1, 3, 5)], ["noisy", "4 printed", "11 printed", "8 of 0.5"], "--direction", "-1,-0.8,-0.7")


def box_distance(x, k):
    """Distance to the surface of the L of three cubes of edge k: the union of two boxes."""
    def box(p, low, high):
        q = np.maximum(np.array(low) - p, p - np.array(high))
        return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(1), 0)

    return np.minimum(box(x, (0, 0, 0), (2 * k, k, k)), box(x, (0, 0, 0), (k, 2 * k, k)))


# Kobbelt 1997


@figure
def kobbelt_1():
    """Figure 1: an uneven coarse mesh of a sphere interpolated with uniform and with nearly isometric charts."""
    x, faces = round_sphere(1)
    x = x + 0.18 * np.random.default_rng(4).standard_normal(x.shape)
    x /= np.linalg.norm(x, axis=1)[:, None]
    rows, files = [], [put("coarse", (x, faces))]
    for chart in ("uniform", "mixed", "exponential", "tangent"):
        fine, _, _, file = run(f"k1{chart}", (x, faces), "--flow", "hc", "--iterations", 0, "--refine", 3, "--refine-chart", chart)
        r = np.linalg.norm(fine[0], axis=1)
        rows.append((chart, rms(r - 1), float(np.abs(r - 1).max())))
        files.append(file)
    table("Kobbelt 1: uneven points of a sphere", ["chart", "distance from the sphere, rms", "largest"], rows)
    picture("kobbelt-1", [files[k] for k in (0, 1, 2, 3)], ["given", "uniform", "mixed", "exponential"])


@figure
def kobbelt_3():
    """Figure 3: a fair surface of many triangles through a given mesh, an elephant."""
    mesh = cgal("elephant.off")
    start = time.time()
    _, report, _, file = run("k3", mesh, "--flow", "hc", "--iterations", 0, "--refine", 2)
    table("Kobbelt 3", ["", "vertices", "triangles", "seconds"],
          [("given", str(len(mesh[0])), str(len(mesh[1])), ""),
           ("refined", str(report["counts"]["written_points"]), str(report["counts"]["written_faces"]), time.time() - start)])
    picture("kobbelt-3", [put("given", mesh), file], ["given", "refined"])


@figure
def gallery():
    """No figure of a paper: every flow at its defaults on one noisy mesh, the L-shaped part."""
    rough = noisy(meshes.part(8), 0.2)
    truth = volume(meshes.part(8))
    text = subprocess.run([COMMAND, "flows", "--markdown"], check=True, capture_output=True, text=True).stdout
    names = [line.split("`")[1] for line in text.split("\n") if line.startswith("| `")]
    before = rms(box_distance(rough[0], 8))
    rows, files = [("noisy", "", 100.0, 100 * volume(rough) / truth)], [put("noisy", rough)]
    for name in names:
        mesh, _, trace, file = run(f"g{len(files)}", rough, "--flow", name)
        rows.append((name, float(trace["roughness"]), 100 * rms(box_distance(mesh[0], 8)) / before, 100 * volume(mesh) / truth))
        files.append(file)
    table("Every flow on a noisy mesh", ["flow", "roughness, degrees", "error left, %", "volume, %"], rows)
    for half in (0, 1):
        part = slice(7 * half, 7 * half + 7)
        short = {"modified-curvature": "modified", "median-direction": "median", "local-directional": "local dir.",
                 "discrete-fairing": "fairing"}
        labels = [short.get(name, name) for name in ["noisy"] + names]
        picture(f"gallery-{half + 1}", files[part], labels[part], "--direction", "-1,-0.8,-0.7", "--width", "150")


def main():
    global COMMAND
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    names = sys.argv[2:] or list(FIGURES)
    if names == ["list"]:
        sys.exit("\n".join(f"{name:14} {(f.__doc__ or '').strip()}" for name, f in FIGURES.items()))
    COMMAND = sys.argv[1]
    for name in names:
        FIGURES[name]()


if __name__ == "__main__":
    main()
