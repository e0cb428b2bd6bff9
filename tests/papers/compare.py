"""Runs every flow of the command with --paper on three meshes, and the same in numpy (flows.py), and compares.

    python3 compare.py RFSMOOTH

Prints a table of the largest differences over all vertices, in units of the mean edge; fails if one is above its
bound. Explicit flows agree to rounding; flows that solve a system to the tolerance they are given.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import flows
import meshes

ROUNDING, SOLVED = 1e-10, 1e-8
# The fit of a chart has a ridge of 1e-6 in ours and none in numpy.
RIDGE = 1e-5

TIGHT = ["--tolerance", "1e-13"]
CASES = [  # name, options of the command, the same in numpy, bound
    ("laplacian", ["--flow", "laplacian", "--iterations", "4"],
     lambda m, x, f: flows.vollmer_laplacian(m, x, f, 4), ROUNDING),
    ("laplacian, sequential", ["--flow", "laplacian", "--iterations", "3", "--update", "sequential"],
     lambda m, x, f: flows.vollmer_sequential(m, x, f, 3), ROUNDING),
    ("laplacian, centre point", ["--flow", "laplacian", "--iterations", "4", "--anchor", "centre", "--alpha", "0.3"],
     lambda m, x, f: flows.vollmer_centre(m, x, f, 4, 0.3), ROUNDING),
    ("laplacian, original point", ["--flow", "laplacian", "--iterations", "4", "--anchor", "original", "--alpha", "0.3"],
     lambda m, x, f: flows.vollmer_original(m, x, f, 4, 0.3), ROUNDING),
    ("laplacian, inverse distance", ["--flow", "laplacian", "--iterations", "4", "--weights", "inverse-distance", "--lambda", "0.5"],
     lambda m, x, f: flows.ohtake_inverse_distance(m, x, f, 4, 0.5), ROUNDING),
    ("hc", ["--flow", "hc", "--iterations", "5", "--alpha", "0.1", "--beta", "0.7"],
     lambda m, x, f: flows.vollmer_hc(m, x, f, 5, 0.1, 0.7), ROUNDING),
    ("hc, sequential", ["--flow", "hc", "--iterations", "3", "--alpha", "0.1", "--beta", "0.7", "--update", "sequential"],
     lambda m, x, f: flows.vollmer_pushed_back(m, x, f, 3, 0.1, 0.7, lambda p: flows.vollmer_sequential(m, p, f, 1)), ROUNDING),
    ("hc-limit", ["--flow", "hc-limit", "--alpha", "0.1", "--beta", "0.7"] + TIGHT,
     lambda m, x, f: flows.vollmer_hc_limit(m, x, f, 0.1, 0.7), SOLVED),
    ("taubin", ["--flow", "taubin", "--iterations", "3", "--lambda", "0.3", "--mu", "0.3093"],
     lambda m, x, f: flows.ohtake_taubin(m, x, f, 3, 0.3, 0.3093), ROUNDING),
    ("taubin, pushed back", ["--flow", "taubin", "--iterations", "3", "--lambda", "0.3", "--mu", "0.3093",
                             "--push-back", "--push-alpha", "0.2", "--push-beta", "0.6"],
     lambda m, x, f: flows.vollmer_pushed_back(m, x, f, 3, 0.2, 0.6, lambda p: flows.ohtake_taubin(m, p, f, 1, 0.3, 0.3093)),
     ROUNDING),
    ("curvature, pushed back", ["--flow", "curvature", "--iterations", "3", "--lambda", "0.2", "--push-back",
                                "--push-alpha", "0.2", "--push-beta", "0.6"],
     lambda m, x, f: flows.vollmer_pushed_back(m, x, f, 3, 0.2, 0.6, lambda p: flows.ohtake_curvature(m, p, f, 1, 0.2)), ROUNDING),
    ("bilaplacian", ["--flow", "bilaplacian", "--iterations", "3", "--lambda", "0.3"],
     lambda m, x, f: flows.ohtake_bilaplacian(m, x, f, 3, 0.3), ROUNDING),
    ("curvature", ["--flow", "curvature", "--iterations", "3", "--lambda", "0.2"],
     lambda m, x, f: flows.ohtake_curvature(m, x, f, 3, 0.2), ROUNDING),
    ("curvature, normalised", ["--flow", "curvature", "--iterations", "3", "--lambda", "0.5", "--normalised"],
     lambda m, x, f: flows.desbrun_normalised(m, x, f, 3, 0.5), ROUNDING),
    ("curvature over a constant", ["--flow", "curvature", "--iterations", "3", "--lambda", "0.2", "--threshold", "constant",
                                   "--threshold-value", "0.1"],
     lambda m, x, f: flows.ohtake_threshold(m, x, f, 3, 0.2, 0.1 * m.edge(x)), ROUNDING),
    ("curvature over one-ring |H|", ["--flow", "curvature", "--iterations", "3", "--lambda", "0.2", "--threshold", "one-ring"],
     lambda m, x, f: flows.ohtake_threshold(m, x, f, 3, 0.2, flows.ohtake_ring_threshold(m, x, 1)), ROUNDING),
    ("curvature over two-ring |H|", ["--flow", "curvature", "--iterations", "3", "--lambda", "0.2", "--threshold", "two-ring"],
     lambda m, x, f: flows.ohtake_threshold(m, x, f, 3, 0.2, flows.ohtake_ring_threshold(m, x, 2)), ROUNDING),
    ("modified-curvature", ["--flow", "modified-curvature", "--iterations", "3", "--lambda", "0.2", "--tangential", "0.5"],
     lambda m, x, f: flows.ohtake_modified(m, x, f, 3, 0.2, 0.5), ROUNDING),
    ("median-direction", ["--flow", "median-direction", "--iterations", "3", "--lambda", "0.2"],
     lambda m, x, f: flows.ohtake_median(m, x, f, 3, 0.2, 0.1), ROUNDING),
    ("median-direction, epsilon 0.3", ["--flow", "median-direction", "--iterations", "3", "--lambda", "0.2", "--least-cosine", "0.3"],
     lambda m, x, f: flows.ohtake_median(m, x, f, 3, 0.2, 0.3), ROUNDING),
    ("implicit, umbrella", ["--flow", "implicit", "--order", "1", "--iterations", "2"] + TIGHT,
     lambda m, x, f: flows.desbrun_implicit(m, x, f, 2, 10, "umbrella", 1, 0), SOLVED),
    ("implicit, umbrella squared", ["--flow", "implicit", "--iterations", "2"] + TIGHT,
     lambda m, x, f: flows.desbrun_implicit(m, x, f, 2, 10, "umbrella", 0, 1), SOLVED),
    ("implicit, a quarter umbrella", ["--flow", "implicit", "--mixture", "0.25", "--iterations", "2"] + TIGHT,
     lambda m, x, f: flows.desbrun_implicit(m, x, f, 2, 10, "umbrella", 0.25, 0.75), SOLVED),
    ("implicit, scale-dependent", ["--flow", "implicit", "--order", "1", "--operator", "scale-dependent", "--iterations", "2"] + TIGHT,
     lambda m, x, f: flows.desbrun_implicit(m, x, f, 2, 10, "scale-dependent", 1, 0), SOLVED),
    ("implicit, curvature", ["--flow", "implicit", "--order", "1", "--operator", "curvature", "--iterations", "2"] + TIGHT,
     lambda m, x, f: flows.desbrun_implicit(m, x, f, 2, 10, "curvature", 1, 0), SOLVED),
    ("directional", ["--flow", "directional", "--iterations", "3"],
     lambda m, x, f: flows.zhao_xu_directional(m, x, f, 3, 0.05, 0), ROUNDING),
    ("directional, m = 1", ["--flow", "directional", "--iterations", "3", "--power", "1"],
     lambda m, x, f: flows.zhao_xu_directional(m, x, f, 3, 0.05, 1), ROUNDING),
    ("local-directional", ["--flow", "local-directional", "--iterations", "3"],
     lambda m, x, f: flows.zhao_xu_local(m, x, f, 3, 0.005, 0, 0.05), ROUNDING),
    ("local-directional, m = 1", ["--flow", "local-directional", "--iterations", "3", "--power", "1"],
     lambda m, x, f: flows.zhao_xu_local(m, x, f, 3, 0.005, 1, 0.05), ROUNDING),
    ("discrete-fairing, tangent", ["--flow", "discrete-fairing", "--chart", "tangent"] + TIGHT,
     lambda m, x, f: flows.kobbelt_fairing(m, x, f, 1, "tangent"), RIDGE),
    ("discrete-fairing, exponential", ["--flow", "discrete-fairing", "--chart", "exponential"] + TIGHT,
     lambda m, x, f: flows.kobbelt_fairing(m, x, f, 1, "exponential"), RIDGE),
    ("discrete-fairing, mixed", ["--flow", "discrete-fairing", "--chart", "mixed"] + TIGHT,
     lambda m, x, f: flows.kobbelt_fairing(m, x, f, 1, "mixed"), RIDGE),
    ("discrete-fairing, uniform", ["--flow", "discrete-fairing", "--chart", "uniform"] + TIGHT,
     lambda m, x, f: flows.kobbelt_fairing(m, x, f, 1, "uniform"), RIDGE),
]


def write_off(path, x, faces):
    rows = [f"OFF\n{len(x)} {len(faces)} 0"] + [" ".join(repr(float(c)) for c in p) for p in x]
    path.write_text("\n".join(rows + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n")


def read_off(path):
    words = path.read_text().split()
    n = int(words[1])
    return np.array(words[4 : 4 + 3 * n], float).reshape(n, 3)


def main():
    command, failures = sys.argv[1], 0
    names = list(meshes.all_meshes())
    print("largest difference to numpy, x mean edge (how far the flow moved in brackets)")
    print(f"{'flow':32}" + "".join(f"{name:>22}" for name in names) + f"{'bound':>10}")
    with tempfile.TemporaryDirectory() as folder:
        before, after = pathlib.Path(folder, "before.off"), pathlib.Path(folder, "after.off")
        ready = {name: (flows.Mesh(len(x), faces), x, faces) for name, (x, faces) in meshes.all_meshes().items()}
        for case, options, reference, bound in CASES:
            row = f"{case:32}"
            for name, (mesh, x, faces) in ready.items():
                write_off(before, x, faces)
                # Every vertex of an edge with one face stays: the papers say nothing of how it would move.
                rim = ["--boundary", "fixed"] if mesh.rim.any() else []
                subprocess.run([command, "smooth-mesh", "--quiet", "--force", "--paper", *options, *rim,
                                str(before), str(after)], check=True)
                ours, theirs, edge = read_off(after), reference(mesh, x, ~mesh.rim), mesh.edge(x)
                apart = np.abs(ours - theirs).max() / edge
                moved = np.linalg.norm(theirs - x, axis=1).max() / edge
                bad = not apart <= bound or not moved > 1e-3
                failures += bad
                row += f"{apart:12.1e} ({moved:5.2f}){' !' if bad else '  '}"
            print(row + f"{bound:10.0e}", flush=True)
    print("all within their bounds" if failures == 0 else f"{failures} above their bounds (!)")
    return failures > 0


if __name__ == "__main__":
    sys.exit(main())
