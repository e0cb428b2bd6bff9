"""Smooths clouds larger than memory on a Dask cluster: every tile is a task.

    python3 smooth.py IN... JOB OUT [--scheduler ADDRESS]

JOB is a folder that all workers see. Without a scheduler's address the workers are of this machine. A task that is
done again, wherever a worker was lost, does no harm: what is there complete is not made again.
"""
import argparse
import json
import os
import subprocess

import dask
from distributed import Client, LocalCluster

RFSMOOTH = os.environ.get("RFSMOOTH", "rfsmooth")


def tiles(*arguments):
    """A step of `rfsmooth tiles`; what it prints."""
    return subprocess.run([RFSMOOTH, "tiles", *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", metavar="IN... JOB OUT")
    parser.add_argument("--scheduler")
    parser.add_argument("--workers", type=int, default=4)
    parser.add_argument("--tile-points", default="5M")
    options = parser.parse_args()
    *inputs, job, out = options.names
    # A worker that is lost takes its tasks with it through no fault of theirs: three would be too few.
    dask.config.set({"distributed.scheduler.allowed-failures": 100})
    cluster = options.scheduler or LocalCluster(n_workers=options.workers, threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        tiles("plan", "--tile-points", options.tile_points, *inputs, job)
        numbers = range(json.loads(tiles("status", job, "--json"))["tiles"])
        for step in ("measure", "run"):
            # Not pure: the value of a task is what it leaves in the folder.
            client.gather(client.map(lambda tile: tiles(step, job, tile, "--threads", 1), numbers, pure=False))
            if step == "measure":
                tiles("settle", job)
        tiles("join", job, out)


if __name__ == "__main__":
    main()
