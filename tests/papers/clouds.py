"""What is promised of every flow on clouds, and of the rough mesh, through the command line.

    python3 clouds.py RFSMOOTH VIRTUAL_SCANNER

Every flow leaves less than half of the error on a noisy sphere and a noisy CAD part, at noise of half a spacing, or
`rfsmooth flows` says what it is for instead. The rough mesh has nearly as many faces as a valid mesh, and a turned
cloud shares most of them. Prints its tables; fails if something is not so.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

COMMAND, SCANNER = sys.argv[1:3]
WORK = pathlib.Path(tempfile.mkdtemp(prefix="clouds"))
FAILURES = []


def call(*words):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout


def expect(fine, what):
    if not fine:
        FAILURES.append(what)


def error(cloud, truth):
    return float(re.search(r'"p2s_root": ([-0-9.e]+)', call(COMMAND, "compare", cloud, truth, "--json"))[1])


def flows():
    """Name and summary of every flow, as `rfsmooth flows` says them."""
    return re.findall(r"^\| `([^`]*)` \| ([^|]*) \|", call(COMMAND, "flows", "--markdown"), re.M)


def half_the_error():
    """One row for every flow: what it leaves of the error."""
    shapes = ("sphere", "l_part")
    for shape in shapes:
        call(SCANNER, "truth", shape, WORK / f"{shape}_truth.ply")
        call(SCANNER, "sample", shape, WORK / f"{shape}.ply", "--points", 6000, "--noise", 0.5, "--seed", 9, "--encoding", "binary")
    before = [error(WORK / f"{s}.ply", WORK / f"{s}_truth.ply") for s in shapes]
    print("error left, %: " + ", ".join(shapes))
    for flow, summary in flows():
        left = []
        for shape, noise in zip(shapes, before):
            call(COMMAND, "denoise", "--flow", flow, "--quiet", WORK / f"{shape}.ply", WORK / "out.ply", "--force")
            left.append(100 * error(WORK / "out.ply", WORK / f"{shape}_truth.ply") / noise)
        says = re.search(r"for (closed )?meshes", summary) is not None
        print(f"  {flow:20}" + "".join(f"{v:8.0f}" for v in left) + ("   says that it is for meshes" if says else ""))
        expect(max(left) < 50 or says, f"{flow} leaves {max(left):.0f} % and does not say what it is for")


def rough_faces(cloud):
    """Faces of the rough mesh as rows of three point numbers, ascending."""
    out = WORK / "mesh.ply"
    call(COMMAND, "mesh", "--stage", "rfs", "--quiet", cloud, out, "--force", "--encoding", "ascii")
    head, body = out.read_text().split("end_header\n", 1)
    n, m = (int(re.search(rf"element {what} (\d+)", head)[1]) for what in ("vertex", "face"))
    faces = np.array([row.split()[1:4] for row in body.split("\n")[n : n + m]], int)
    return np.sort(faces, axis=1), n


def noisy_torus(n, seed):
    rng = np.random.default_rng(seed)
    u, v = 2 * np.pi * rng.random((2, 8 * n))
    keep = rng.random(8 * n) < (1 + 0.4 * np.cos(v)) / 1.4  # even over the area
    u, v = u[keep][:n], v[keep][:n]
    x = np.c_[(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)]
    return x + 0.5 * np.sqrt(4 * np.pi**2 * 0.4 / n) / 2 * rng.standard_normal(x.shape)


def rough_mesh():
    """Faces for each point, edges with one face, and faces in common after turning the cloud."""
    x = noisy_torus(6000, 1)
    turn = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))[0]
    found = []
    for rotation in (np.eye(3), turn):
        np.savetxt(WORK / "torus.xyz", x @ rotation.T, fmt="%.17g")
        found.append(rough_faces(WORK / "torus.xyz"))
    (faces, n), turned = found[0], found[1][0]
    edges, count = np.unique(np.sort(np.r_[faces[:, :2], faces[:, 1:], faces[:, ::2]], axis=1), axis=0, return_counts=True)
    one, most = 100 * (count == 1).mean(), count.max()
    common = len(set(map(tuple, faces)) & set(map(tuple, turned)))
    shared = 100 * common / (len(faces) + len(turned) - common)
    print(f"rough mesh of a noisy torus: {len(faces) / n:.2f} faces and {len(edges) / n:.2f} edges for each point, "
          f"{one:.1f} % of the edges with one face; turned it shares {shared:.1f} % of its faces")
    expect(most == 2, "an edge has more than two faces")
    # A valid mesh has two faces for each point. What was measured when this was written, less a little: 1.79 faces,
    # 33.0 % and 67.6 % here; the bounds are there to be drawn tighter.
    expect(len(faces) / n > 1.75, "fewer faces than a surface has")
    expect(one < 35, "more edges with one face")
    expect(shared > 65, "the pose matters more")


if __name__ == "__main__":
    rough_mesh()
    half_the_error()
    print("\n".join(FAILURES) if FAILURES else "all as promised")
    sys.exit(bool(FAILURES))
