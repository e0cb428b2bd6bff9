#!/usr/bin/env python3
"""Tiles beside the whole cloud: how near, how true, at what cost.

    python3 tests/bench/pipeline/tiles.py build/bench/bin/rfsmooth
    python3 tests/bench/pipeline/tiles.py build/bench/bin/rfsmooth --memory 3G --points 5e6 20e6 60e6 --noise 1.3

The cloud is a bumpy sphere of random points; lengths are in spacings, the mean distance from a point of the surface to its
nearest other. Each line has the difference between tiles and the whole cloud with the same statistics, the mean square
distance to the truth in tiles over that of the whole, of all points and of those within three spacings of another tile, and the
processor time of all steps over that of denoise. With --memory only `denoise --memory` is run, under that limit of address
space: exit code, peak, processor time. --picture draws a seam. Needs python3-numpy.
"""

import argparse
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np

RADIUS = 100.0
ROW = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "u1")])


def surface(directions):
    """Distance of the surface from the middle, for unit vectors n x 3."""
    x, y, z = directions.T
    return RADIUS * (1 + 0.05 * np.sin(6 * x) * np.sin(5 * y) * np.cos(4 * z))


def spacing(points):
    return RADIUS / np.sqrt(points / np.pi)  # half of 1 / sqrt(density)


def write_cloud(path, points, noise):
    random = np.random.default_rng(1)
    fields = "property float x\nproperty float y\nproperty float z\nproperty uchar intensity\n"
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {points}\n{fields}end_header\n".encode())
        for first in range(0, points, 1000000):
            n = min(points - first, 1000000)
            way = random.normal(size=(n, 3))
            way /= np.linalg.norm(way, axis=1)[:, None]
            at = way * surface(way)[:, None] + noise * spacing(points) * random.normal(size=(n, 3))
            rows = np.zeros(n, ROW)
            rows["x"], rows["y"], rows["z"] = at.T
            rows["intensity"] = random.integers(0, 255, n)
            file.write(rows.tobytes())


def read_cloud(path):
    data = pathlib.Path(path).read_bytes()
    rows = np.frombuffer(data[data.index(b"end_header\n") + 11 :], ROW)
    return np.stack([rows["x"], rows["y"], rows["z"]], axis=1).astype(float)


def off_surface(points):
    """Distance to the truth along the radius, with its sign."""
    length = np.linalg.norm(points, axis=1)
    return length - surface(points / length[:, None])


def run(command):
    """Runs it; its exit code, processor time in seconds, and peak memory in bytes."""
    process = subprocess.Popen([str(c) for c in command])
    _, status, used = os.wait4(process.pid, 0)
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, 1024 * used.ru_maxrss


def must(command):
    code, seconds, _ = run(command)
    if code != 0:
        sys.exit(f"exit code {code}: {' '.join(map(str, command))}")
    return seconds


def near_another_tile(points, tiles, reach):
    """Whether each point is so near to the box of a tile beside the one whose box it is in."""
    boxes = np.zeros(len(points), int)
    for tile in tiles:
        low, high = (np.array(end) for end in tile["box"])
        boxes += np.linalg.norm(np.maximum(0, np.maximum(low - points, points - high)), axis=1) <= reach
    return boxes > 1


def smooth_both(rfsmooth, folder, points, noise, tiles):
    """The cloud before, whole and in tiles; the job, its status, and the processor time of the steps and of denoise."""
    job, quiet = folder / "job", ["--quiet", "--threads", 2]
    shutil.rmtree(job, ignore_errors=True)
    cloud, whole, tiled, plain = (folder / name for name in ("in.ply", "whole.ply", "tiled.ply", "plain.ply"))
    write_cloud(cloud, points, noise)
    steps = must([rfsmooth, "tiles", "plan", "--tile-points", int(1.01 * points / tiles), cloud, job, *quiet])
    plan = json.loads((job / "job.json").read_text())
    numbers = range(len(plan["tiles"]))
    for step in (["measure", job, *numbers], ["settle", job], ["run", job, *numbers], ["join", "--force", job, tiled]):
        steps += must([rfsmooth, "tiles", *step, *quiet])
    must([rfsmooth, "denoise", "--force", "--statistics", job / "statistics.json", cloud, whole, *quiet])
    alone = must([rfsmooth, "denoise", "--force", cloud, plain, *quiet])
    status = json.loads(subprocess.run([rfsmooth, "tiles", "status", job, "--json"], capture_output=True, check=True).stdout)
    return [read_cloud(p) for p in (cloud, whole, tiled)], plan, status, steps / alone


def compare(rfsmooth, folder, points, noise, tiles, picture):
    (before, whole, tiled), plan, status, cost = smooth_both(rfsmooth, folder, points, noise, tiles)
    h = spacing(points)
    apart = np.linalg.norm(tiled - whole, axis=1) / h
    seam = near_another_tile(before, plan["tiles"], 3 * h)
    truth = lambda rows: np.mean(off_surface(tiled)[rows] ** 2) / np.mean(off_surface(whole)[rows] ** 2)
    print(
        f"{points:>9} points, {len(plan['tiles'])} tiles, noise {noise:>3}: rms {np.sqrt(np.mean(apart**2)):.4f}, within 0.1 "
        f"{100 * np.mean(apart < 0.1):.2f} %, truth {truth(slice(None)):.4f}, at seams {truth(seam):.4f} "
        f"({100 * np.mean(seam):.1f} % of the points), time {cost:.2f}, halo {status['halo'] / h:.0f} spacings, "
        f"{100 * status['halo_share']:.0f} % more points",
        flush=True,
    )
    if picture:
        draw(picture, before, whole, tiled, plan, h, noise)


def stay_within(rfsmooth, folder, points, noise, memory):
    cloud = folder / "in.ply"
    write_cloud(cloud, points, noise)
    limit = int(float(memory[:-1]) * 1000 ** (1 + "KMGT".index(memory[-1])))
    command = ["prlimit", f"--as={limit}", rfsmooth, "denoise", "--force", "--quiet", "--threads", 2, "--memory", memory]
    code, seconds, peak = run([*command, cloud, folder / "out.ply"])
    print(f"{points:>9} points, noise {noise}, {memory}: exit code {code}, peak {peak / 1e9:.2f} GB, {seconds:.0f} s of processor "
          f"time, {1e6 * seconds / points:.1f} a million points", flush=True)  # fmt: skip


def write_png(path, pixels):
    height, width, _ = pixels.shape
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    pathlib.Path(path).write_bytes(b"\x89PNG\r\n\x1a\n" + body)


def draw(path, before, whole, tiled, plan, h, noise):
    """Four squares around a cut seen along the radius: how far points are off the truth, before, whole, and in tiles, and how far
    tiles are off the whole. Blue inside, red outside, the cut in grey."""
    side, size = 60 * h, 330
    low, high = (np.array(end) for end in plan["tiles"][0]["box"])
    axis = int(np.argmax([min(abs(b["box"][0][a] - high[a]) for b in plan["tiles"][1:]) < h for a in range(3)]))
    centre = (low + high) / 2
    centre[axis] = high[axis]
    rest = [a for a in range(3) if a != axis]
    centre[rest] *= np.sqrt(max(0, RADIUS**2 - centre[axis] ** 2)) / np.linalg.norm(centre[rest])
    up = centre / np.linalg.norm(centre)
    across = np.eye(3)[axis] - up[axis] * up
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(up, across)])
    here = np.nonzero((before @ up > 0) & (np.abs((before - centre) @ frame.T) < 0.75 * side).all(axis=1))[0]
    panels = []
    for points, value, most in [(before, off_surface(before[here]), 2 * noise), (whole, off_surface(whole[here]), 0.3 * noise),
                                (tiled, off_surface(tiled[here]), 0.3 * noise),
                                (tiled, off_surface(tiled[here]) - off_surface(whole[here]), 0.3 * noise)]:  # fmt: skip
        pixels = np.full((size, size, 3), 255, np.uint8)
        pixels[:, size // 2] = 128
        share = np.clip(value / (most * h), -1, 1)
        colour = np.stack([1 + np.minimum(0, share), 1 - np.abs(share), 1 - np.maximum(0, share)], axis=1)
        colour = (225 * colour).astype(np.uint8)
        place = np.round(((points[here] - centre) @ frame.T / side + 0.5) * size).astype(int)
        for dx, dy in np.ndindex(4, 4):
            x, y = place[:, 0] + dx - 1, place[:, 1] + dy - 1
            inside = (x >= 0) & (x < size) & (y >= 0) & (y < size)
            pixels[y[inside], x[inside]] = colour[inside]
        panels += [pixels, np.full((size, 6, 3), 255, np.uint8)]
    write_png(path, np.concatenate(panels[:-1], axis=1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rfsmooth", help="the command")
    parser.add_argument("--points", type=float, nargs="+", default=[1e6])
    parser.add_argument("--noise", type=float, nargs="+", default=[0.1, 0.5, 1.3, 2], help="spacings")
    parser.add_argument("--tiles", type=int, default=8)
    parser.add_argument("--memory", help="3G, say: only denoise --memory, under that limit")
    parser.add_argument("--picture", help="PNG of a seam, of the last cloud")
    parser.add_argument("--folder", help="for the clouds; default: one that goes")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        for points in map(int, options.points):
            for noise in options.noise:
                if options.memory:
                    stay_within(options.rfsmooth, pathlib.Path(folder), points, noise, options.memory)
                else:
                    compare(options.rfsmooth, pathlib.Path(folder), points, noise, options.tiles, options.picture)


main()
