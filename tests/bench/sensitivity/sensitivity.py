#!/usr/bin/env python3
"""Halves and doubles every tuned constant and writes docs/CONSTANTS.md.

    python3 tests/bench/sensitivity/sensitivity.py [--only REGEX] [--jobs N] [-- OPTIONS OF THE PROGRAM]

In a copy of the sources under build/sensitivity each constant reads its factor from the environment. Then development
clouds are denoised with one constant after the other halved and doubled. With --only, the rows of the other constants
stay as the file has them; with the program's option --parts, so do the cells that these parts do not fill. --print
measures nothing: it counts the constants of the sources and writes the file anew, without the rows of those that are gone
or have another value.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

from constants import LITERAL, ROOT, classified, constants_in, sources

OUT = ROOT / "docs/CONSTANTS.md"
HOOK = '''#pragma once
#include <cstdlib>
#include <cstring>
namespace rfsmooth {
/// A number, times the factor that RFSMOOTH_TUNED="key=factor" has for this key; whatever type is asked for.
struct Tuned {
  Tuned(const char* key, double is) : value(is) {
    const char* const asked = std::getenv("RFSMOOTH_TUNED");
    const std::size_t length = std::strlen(key);
    if (asked != nullptr && std::strncmp(asked, key, length) == 0 && asked[length] == '=') value *= std::atof(asked + length + 1);
  }
  template <class Number>
  operator Number() const { return Number(value); }
  double value;
};
}  // namespace rfsmooth
'''
RULE = """A constant is a number with a name (`constexpr ... kName = 2.5;`) in `base`, `rfs_mesh`, `smoothing`, `pipeline` or
`include`; of an array, each number is one. It is **tuned** if another value would make other results that nobody could call
wrong: thresholds, weights, numbers of neighbours, samples and rounds, whether chosen on clouds, taken from a paper or set
with reason. All others are listed, with the reason, at the end; what is not listed there
(`tests/bench/sensitivity/not_tuned.txt`) counts as tuned. Options of the command and of the library are not constants: users
set them, `--help` names them. Numbers without a name, as the exponents of a formula, are not counted."""
COLUMNS = """| constant | value | file | origin | CD | p2s | normals | strays | time | one shape | further |
|---|---|---|---|---|---|---|---|---|---|---|
"""
FIRST, LAST = 4, 11  # cells of figures
UNKNOWN = "-"
MEANING = """Each cell is the change when the constant is halved / doubled. CD, p2s: Chamfer distance and distance to the true surface
(mean squares), mean over the clouds, in per cent. Normals: their mean angle to the true ones, a wrong side included, in per
cent. Strays: points judged wrongly, in per cent of those planted. Time: processor time of all, in per cent, on a machine
that did other work, too: 5 are chance. One shape: the largest share that one shape has in the change of CD, in per cent; what
rests on one shape has 100. Further: the largest change of one of the clouds and commands of
`tests/bench/sensitivity/further.cpp` (rings, steps of depth, voxels, merged scans, sensors in a room, clean clouds, surfaces), in
per cent of its figure, and which it is; of those that a constant's code can act on. "fails": no end, or more than ten times as long. "-": not measured. A row stays until its
constant is measured again (`--only`)."""


def tuned_line(constant):
    def hook(number):
        return f'::rfsmooth::Tuned("{constant.key}", {number})'
    value = constant.value
    return LITERAL.sub(lambda m: hook(m.group()), value) if "{" in value else hook(f"double({value})")


def patched(path, chosen):
    """The source with its tuned constants read from outside."""
    text = re.sub(r"static_assert\([^;]*\);", "", path.read_text())
    found = constants_in(path, text)
    names = [c.name for _, of_it in found for c in of_it if c.key in chosen]
    for match, of_it in reversed(found):
        if not re.search(r"\b(" + "|".join(names) + r")\b", match["names"]):
            continue
        declared = ", ".join(f"{c.name} = {tuned_line(c) if c.key in chosen else c.value}" for c in of_it)
        in_function = text[:match.start()].endswith(" ") and "static" not in match["storage"]
        of_class = "static" in match["storage"]
        storage = "static" if in_function else "inline static" if of_class else "inline" if path.suffix != ".cpp" else ""
        text = f"{text[:match.start()]}{storage} const {match['type']} {declared};{match['rest']}{text[match.end():]}"
    if path.suffix != ".cpp":
        text = text.replace("#pragma once\n", '#pragma once\n#include "base/tuned.h"\n', 1)
    return text


def follow(text, names):
    """The source with those of its constants evaluated as the program starts that are worked out from tuned ones."""
    return re.sub(r"(?m)^(\s*)constexpr ([^=;(){}]* = [^;{}]*\b(?:" + "|".join(names) + r")\b[^;{}]*;)", r"\1const \2", text)


def copy_sources(tree, chosen):
    if tree.exists():
        shutil.rmtree(tree)
    tree.mkdir(parents=True)
    for name in subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).split():
        if (ROOT / name).is_file() and not name.startswith(("clouds/pictures", "tests/fuzz/corpus")):
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, tree / name)
    of_headers = {key.split(":")[1] for key in chosen if not key.split(":")[0].endswith(".cpp")}
    for path in sources():
        own = {c.name for _, of_it in constants_in(path) for c in of_it if c.key in chosen}
        text = patched(path, chosen) if own else path.read_text()
        names = own | of_headers
        (tree / path.relative_to(ROOT)).write_text(follow(text, names) if names else text)
    (tree / "base/tuned.h").write_text(HOOK)


def build(tree):
    subprocess.run(["cmake", "--preset", "bench", "-DRFSMOOTH_WITH_PCL=OFF", "-DRFSMOOTH_WITH_OPEN3D=OFF",
                    "-DCMAKE_CXX_FLAGS=-include base/tuned.h -I" + str(tree)],
                   cwd=tree, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", "--preset", "bench", "--target", "rfsmooth_bench_sensitivity"], cwd=tree, check=True)


class Run:
    """What the program printed: {(kind, shape, cloud): (seconds, figures)}."""

    def __init__(self, text):
        rows = [line.split() for line in text.splitlines()]
        self.rows = {tuple(r[:3]): tuple(map(float, r[3:])) for r in rows}

    def of(self, kind):
        return {key: row for key, row in self.rows.items() if key[0] == kind}


def measure(program, options, tuning=None, limit=None):
    """A Run, or None if it fails or takes more than `limit` seconds."""
    environment = dict(os.environ, **({"RFSMOOTH_TUNED": tuning} if tuning else {}))
    try:
        done = subprocess.run([program, *options], env=environment, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None
    return Run(done.stdout) if done.returncode == 0 else None


def changed(before, after):
    return 100 * (after / before - 1) if before else 0.0 if after == before else 100.0


def signed(change):
    return "0" if change == 0 else f"{change:+.2f}"


def cells_of_laws(before, after):
    """CD, p2s, normals, strays, time (see MEANING)."""
    laws = before.of("laws")
    ratio = [sum(changed(row[column], after.rows[key][column]) for key, row in laws.items()) / len(laws) for column in (1, 2)]

    def total(run, kind):
        return sum(row[1] for row in run.of(kind).values())
    normals = changed(total(before, "normals"), total(after, "normals"))
    strays = 100 * (total(after, "strays") - total(before, "strays")) / len(before.of("strays"))
    seconds = changed(*(sum(row[0] for key, row in run.rows.items() if key[0] != "further") for run in (before, after)))
    return [signed(c) for c in [*ratio, normals, strays, seconds]]


def share_of_one_shape(before, after):
    by_shape = {}
    for (kind, shape, cloud), row in before.of("laws").items():
        by_shape[shape] = by_shape.get(shape, 0) + after.rows[kind, shape, cloud][1] / row[1] - 1
    total = sum(abs(c) for c in by_shape.values())
    return 100 * max(abs(c) for c in by_shape.values()) / total if total > 0 else 0


def cell_of_further(before, after):
    """The largest change of all, and the cloud that has it."""
    of = {key: changed(row[1], after.rows[key][1]) for key, row in before.of("further").items()}
    most = max(of, key=lambda key: abs(of[key]))
    return signed(of[most]) if of[most] == 0 else f"{signed(of[most])} {most[1]} {most[2]}"


def row_of(constant, before, halved, doubled, known):
    """`known`: the row so far, or none."""
    cells = known.strip("| ").split(" | ")[FIRST:LAST] if known else [UNKNOWN] * (LAST - FIRST)
    both = [halved, doubled]
    if before.of("laws"):
        of_each = [["fails"] * 5 if after is None else cells_of_laws(before, after) for after in both]
        cells[:6] = [*map(" / ".join, zip(*of_each)), f"{max((share_of_one_shape(before, a) for a in both if a), default=0):.0f}"]
    if before.of("further"):
        cells[6] = " / ".join("fails" if after is None else cell_of_further(before, after) for after in both)
    told = [f"`{constant.name}`", constant.value, f"`{constant.path}`", constant.origin.replace("|", "/")]
    return "| " + " | ".join(told + cells) + " |"


def row_without(constant):
    why = "sizes an array" if constant.sized else "not measured"
    return f"| `{constant.name}` | {constant.value} | `{constant.path}` | {constant.origin.replace('|', '/')} | {why} |  |  |  |  |  |  |"


def rows_of_file():
    """{(name, value, file): row} of docs/CONSTANTS.md."""
    found = {}
    for line in OUT.read_text().split("\n"):
        cells = [cell.strip(" `") for cell in line.strip("|").split(" | ")]
        if line.startswith("| `") and len(cells) == LAST and cells[FIRST + 1]:
            found[cells[0], cells[1], cells[2]] = line
    return found


def is_idle(row):
    """Whether no figure of the row but time changes by half a per cent."""
    cells = row.strip("| ").split(" | ")
    figures = [figure for k in (4, 5, 6, 7, 10) if k < len(cells) for figure in cells[k].split(" / ")]
    return len(cells) == LAST and all(f == UNKNOWN or f[0] != "f" and abs(float(f.split()[0])) < 0.5 for f in figures)


def measured_on():
    return re.search(r"Measured on ([^.]*)\.", OUT.read_text())[1]


def write(tuned, others, rows, clouds):
    rows = [rows.get((c.name, c.value, c.path), row_without(c)) for c in tuned]
    idle = sum(map(is_idle, rows))
    count = sum(c.numbers() for c in tuned)
    text = (f"# Constants\n\n{count} tuned constants. Printed by `tests/bench/sensitivity/sensitivity.py`.\n\n{RULE}\n\n"
            f"## Tuned\n\nMeasured on {clouds}.\n{MEANING}\n\n{idle} change no figure but time by half a per cent here; the origin of each says what it guards.\n\n{COLUMNS}" + "\n".join(rows) +
            "\n\n## Not tuned\n\n| number | why | which |\n|---|---|---|\n")
    for name, (reason, of_class) in others.items():
        by_path = {}
        for c in of_class:
            by_path.setdefault(c.path, []).append(f"`{c.name}`")
        which = "; ".join(f"{path}: {', '.join(names)}" for path, names in by_path.items())
        text += f"| {sum(c.numbers() for c in of_class)} | {name}: {reason} | {which} |\n"
    OUT.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="regular expression on FILE:NAME")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--print", action="store_true", help="measure nothing")
    parser.add_argument("words", nargs="*", help="options of the program: --parts, --shapes, --laws, --times, --points, --cache")
    options = parser.parse_args()
    tuned, others = classified()
    rows = rows_of_file()
    if options.print:
        print(f"{sum(c.numbers() for c in tuned)} tuned")
        for name, (_, of_class) in others.items():
            print(f"{sum(c.numbers() for c in of_class)} {name}")
        write(tuned, others, rows, measured_on())
        return
    chosen = [c for c in tuned if re.search(options.only, c.key) and not c.sized]
    tree = ROOT / "build/sensitivity"
    copy_sources(tree, {c.key for c in chosen})
    build(tree)
    program = str(tree / "build/bench/bin/sensitivity")
    started = time.monotonic()
    before = measure(program, options.words)
    if not before:
        sys.exit("the program fails as it is")
    # Of the jobs each has its part of the machine, which this run had for itself.
    limit = 10 * options.jobs * (time.monotonic() - started)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = {(c.key, f): pool.submit(measure, program, options.words, f"{c.key}={f}", limit) for c in chosen for f in (0.5, 2)}
        for c in chosen:
            key = c.name, c.value, c.path
            rows[key] = row_of(c, before, *(runs[c.key, f].result() for f in (0.5, 2)), rows.get(key))
            print(rows[key], flush=True)
    of_shapes = [key for key in before.rows if key[0] != "further"]
    shapes, clouds = (", ".join(dict.fromkeys(key[i] for key in of_shapes)) for i in (1, 2))
    write(tuned, others, rows, f"{shapes}, each as {clouds}" if of_shapes else measured_on())


if __name__ == "__main__":
    main()
