"""What the tests of engines share: a cloud, its tiles one after the other, and whom to kill."""
import hashlib
import math
import os
import pathlib
import random
import struct
import subprocess

TILE_POINTS = 3000


def strip(path):
    """A long strip of a bent surface with noise, as binary PLY."""
    random.seed(4)
    rows = [(i + random.gauss(0, 0.2), j + random.gauss(0, 0.2), 6 * math.sin(i / 40) + random.gauss(0, 0.4))
            for i in range(900) for j in range(24)]
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(rows)
    head += "".join("property double %s\n" % axis for axis in "xyz") + "end_header\n"
    path.write_bytes(head.encode() + b"".join(struct.pack("<3d", *row) for row in rows))


def tiles(command, *arguments):
    subprocess.run([command, "tiles", *map(str, arguments), "--quiet"], check=True)


def parent_of(process):
    """Its number. Raises OSError if it has ended."""
    return int(pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[1])


def running_tile(folder):
    """The process of a tile of the job in `folder` and its parent, once there is one."""
    for process in pathlib.Path("/proc").iterdir():
        if not process.name.isdigit():
            continue
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
            parent = parent_of(process.name)
        except (OSError, IndexError):
            continue  # it has ended
        if b"run" in words and os.fsencode(folder) in words:
            return int(process.name), parent
    return None


def hash_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def alone(command, folder):
    """Makes in.ply in the folder and smooths it tile by tile in this process. The hash of what comes out."""
    strip(folder / "in.ply")
    job = folder / "alone"
    tiles(command, "plan", "--tile-points", TILE_POINTS, folder / "in.ply", job)
    numbers = range(len(list((job / "cut").iterdir())))
    tiles(command, "measure", job, *numbers)
    tiles(command, "settle", job)
    tiles(command, "run", job, *numbers)
    tiles(command, "join", job, folder / "alone.ply")
    return hash_of(folder / "alone.ply")
