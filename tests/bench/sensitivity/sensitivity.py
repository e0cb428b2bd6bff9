#!/usr/bin/env python3
"""Halves and doubles every tuned constant and writes docs/CONSTANTS.md.

    python3 tests/bench/sensitivity/sensitivity.py [--only REGEX] [--jobs N] [-- OPTIONS OF THE PROGRAM]

A constant is a line `constexpr TYPE kName = NUMBER;` of base, rfs_mesh, smoothing or pipeline. In a copy of the sources under
build/sensitivity each reads its factor from the environment; those that the compiler needs as constants (sizes of arrays) are
structure, not tuning, and are listed apart. Then the development clouds are denoised with one constant after the other halved
and doubled. Effects are the change of the mean over all clouds, in per cent; the last column is the largest share that one
shape has in the change of the Chamfer distance: what rests on one shape has 100.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
ROOMS = ("base", "rfs_mesh", "smoothing", "pipeline")
LINE = re.compile(
    r"^(?P<indent> *)(?P<inline>inline )?constexpr (?P<type>double|float|int|std::size_t|Index) (?P<name>k[A-Z]\w*) = "
    r"(?P<value>[-+*/() .0-9eEFf]+);(?P<rest>.*)$")
HOOK = '''#pragma once
#include <cstdlib>
#include <cstring>
namespace rfsmooth {
/// `value`, times the factor that RFSMOOTH_TUNED="key=factor" has for this key.
inline double tuned(const char* key, double value) {
  const char* const asked = std::getenv("RFSMOOTH_TUNED");
  const std::size_t length = std::strlen(key);
  if (asked == nullptr || std::strncmp(asked, key, length) != 0 || asked[length] != '=') return value;
  return value * std::atof(asked + length + 1);
}
}  // namespace rfsmooth
'''


class Constant:
    def __init__(self, path, number, match, origin):
        self.path, self.number, self.match, self.origin = path, number, match, origin
        self.name, self.value, self.key = match["name"], match["value"], f"{path}:{match['name']}"

    def line(self):
        m = self.match
        storage = "inline const" if m["inline"] else "static const"
        return (f'{m["indent"]}{storage} {m["type"]} {m["name"]} = {m["type"]}(::rfsmooth::tuned("{self.key}", '
                f'double({m["value"]})));{m["rest"]}')


def constants():
    """All of the tree, in order of files and lines. The origin is the comment behind or above a constant."""
    found = []
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            lines = path.read_text().split("\n")
            for number, line in enumerate(lines):
                match = LINE.match(line)
                if not match:
                    continue
                origin = match["rest"].strip().lstrip("/<").strip()
                above = number - 1
                while not origin and above >= 0 and LINE.match(lines[above]):
                    above -= 1
                if not origin and above >= 0 and lines[above].strip().startswith("//"):
                    origin = lines[above].strip().lstrip("/").strip()
                found.append(Constant(str(path.relative_to(ROOT)), number, match, origin))
    return found


def compiles(tree, path, chosen):
    """A source, or a header and every source that names a constant of it."""
    sources = [path]
    if path.endswith(".h"):
        names = re.compile(r"\b(" + "|".join(c.name for c in chosen) + r")\b")
        sources += [str(p.relative_to(tree)) for room in ROOMS for p in sorted((tree / room).rglob("*.cpp"))
                    if names.search(p.read_text())]
    command = ["g++", "-std=c++17", "-fsyntax-only", "-I.", "-Iinclude", "-isystem", "/usr/include/eigen3", "-include",
               "base/tuned.h", "-x", "c++"]
    return all(subprocess.run(command + [source], cwd=tree, capture_output=True).returncode == 0 for source in sources)


def patch(tree, path, chosen):
    lines = (ROOT / path).read_text().split("\n")
    for constant in chosen:
        lines[constant.number] = constant.line()
    text = "\n".join(lines)
    if path.endswith(".h"):
        text = text.replace("#pragma once\n", '#pragma once\n#include "base/tuned.h"\n', 1)
    (tree / path).write_text(text)


def tunable(tree, path, all_of_file):
    """Those of a file that need not be known to the compiler; the copy is left with just these."""
    patch(tree, path, all_of_file)
    if compiles(tree, path, all_of_file):
        return all_of_file
    kept = []
    for constant in all_of_file:
        patch(tree, path, kept + [constant])
        if compiles(tree, path, kept + [constant]):
            kept.append(constant)
    patch(tree, path, kept)
    return kept


def copy_sources(tree):
    if tree.exists():
        shutil.rmtree(tree)
    tree.mkdir(parents=True)
    names = subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).split("\n")
    for name in filter(None, names):
        if (ROOT / name).is_file() and not name.startswith(("clouds/pictures", "tests/fuzz/corpus")):
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, tree / name)
    (tree / "base/tuned.h").write_text(HOOK)


def build(tree):
    subprocess.run(["cmake", "--preset", "bench", "-DRFSMOOTH_WITH_PCL=OFF", "-DRFSMOOTH_WITH_OPEN3D=OFF",
                    "-DCMAKE_CXX_FLAGS=-include base/tuned.h -I" + str(tree)],
                   cwd=tree, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", "--preset", "bench", "--target", "rfsmooth_bench_sensitivity"], cwd=tree,
                   check=True, stdout=subprocess.DEVNULL)


def measure(program, options, tuning=None):
    """{(shape, noise): (Chamfer, p2s, seconds)}, or None if the run fails."""
    environment = dict(os.environ, **({"RFSMOOTH_TUNED": tuning} if tuning else {}))
    try:
        done = subprocess.run([program, *options], env=environment, capture_output=True, text=True, timeout=600)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode != 0:
        return None
    rows = [line.split() for line in done.stdout.splitlines()]
    return {(r[0], r[1]): tuple(map(float, r[2:])) for r in rows}


def change(before, after, column):
    """The mean over the clouds, each against itself, in per cent."""
    return 100 * sum(after[key][column] / row[column] - 1 for key, row in before.items()) / len(before)


def share_of_one_shape(before, after):
    """The largest share that one shape has in the change of the Chamfer distance, in per cent."""
    by_shape = {}
    for (shape, noise), row in before.items():
        by_shape[shape] = by_shape.get(shape, 0) + after[shape, noise][0] / row[0] - 1
    total = sum(abs(c) for c in by_shape.values())
    return 100 * max(abs(c) for c in by_shape.values()) / total if total > 0 else 0


def row_of(constant, before, halved, doubled):
    cells = [f"`{constant.name}`", constant.value.strip(), f"`{constant.path}`", constant.origin.replace("|", "/")]
    for after in (halved, doubled):
        cells += ["fails"] * 3 if after is None else [f"{change(before, after, c):+.2f}" for c in range(3)]
    shares = [share_of_one_shape(before, after) for after in (halved, doubled) if after]
    cells.append(f"{max(shares):.0f}" if shares else "")
    return "| " + " | ".join(cells) + " |"


def is_idle(before, afters):
    return all(after is not None and abs(change(before, after, 0)) < 0.5 and abs(change(before, after, 1)) < 0.5
               for after in afters)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="regular expression on FILE:NAME")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("words", nargs="*", help="options of the program: --shapes, --laws, --times, --points, --cache")
    parser.add_argument("--out", default=str(ROOT / "docs/CONSTANTS.md"))
    options = parser.parse_args()
    tree = ROOT / "build/sensitivity"
    copy_sources(tree)
    everything = [c for c in constants() if re.search(options.only, c.key)]
    chosen = []
    for path in dict.fromkeys(c.path for c in everything):
        chosen += tunable(tree, path, [c for c in everything if c.path == path])
    build(tree)
    program = str(tree / "build/bench/bin/sensitivity")
    before = measure(program, options.words)
    if not before:
        sys.exit("the program fails as it is")
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = {(c.key, f): pool.submit(measure, program, options.words, f"{c.key}={f}") for c in chosen for f in (0.5, 2)}
        results = {key: run.result() for key, run in runs.items()}
    with open(options.out, "w") as out:
        cells = [", ".join(sorted({key[i] for key in before})) for i in (0, 1)]
        idle = sum(is_idle(before, [results[c.key, f] for f in (0.5, 2)]) for c in chosen)
        out.write("# Tuned constants\n\nMade by `tests/bench/sensitivity/sensitivity.py`: each constant halved and doubled, the "
                  f"change in per cent of the mean\nover {len(before)} clouds ({cells[0]}; {cells[1]}).\n\n{len(chosen)} constants; {idle} change neither "
                  "the Chamfer distance (CD) nor the distance to the surface (p2s) by half a per cent here.\n\n"
                  "| constant | value | file | origin | CD / 2 | p2s / 2 | time / 2 | CD x 2 | p2s x 2 | time x 2 | "
                  "one shape's share |\n|---|---|---|---|---|---|---|---|---|---|---|\n")
        for c in chosen:
            out.write(row_of(c, before, results[c.key, 0.5], results[c.key, 2]) + "\n")
        structure = [c for c in everything if c not in chosen]
        if structure:
            out.write("\nNeeded by the compiler (sizes of arrays and the like), not tuned: "
                      + ", ".join(f"`{c.name}`" for c in structure) + ".\n")


if __name__ == "__main__":
    main()
