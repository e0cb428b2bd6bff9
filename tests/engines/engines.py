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


def holding(command, folder):
    """A command like it, of which the first tile waits to be killed: it is seen however fast the others are."""
    script = folder / "rfsmooth"
    script.write_text(f"""#!/bin/sh
if [ "$2" = run ] && mkdir '{folder}/held' 2> /dev/null; then sleep 60 < /dev/null > /dev/null 2>&1; fi
exec '{command}' "$@"
""")
    script.chmod(0o755)
    return script


def held_tile(script):
    """The process of the tile that waits and its parent, once there is one."""
    if not (script.parent / "held").exists():
        return None
    for process in pathlib.Path("/proc").iterdir():
        if not process.name.isdigit():
            continue
        try:
            words = (process / "cmdline").read_bytes().split(b"\0")
            parent = parent_of(process.name)
        except (OSError, IndexError):
            continue  # it has ended
        if b"run" in words and os.fsencode(script) in words:
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
