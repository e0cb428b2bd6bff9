"""Tiles by Dask: four workers, one killed in the middle with what it runs; the same bytes as one after the other."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from engines import TILE_POINTS, alone, hash_of, held_tile, holding

COMMAND, SCRIPT = sys.argv[1:3]

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    expected = alone(COMMAND, folder)
    job = folder / "job"
    script = holding(COMMAND, folder)
    dask = subprocess.Popen([sys.executable, SCRIPT, folder / "in.ply", job, folder / "dask.ply",
                             "--tile-points", str(TILE_POINTS)], env={**os.environ, "RFSMOOTH": str(script)})
    found = None
    while found is None and dask.poll() is None:
        found = held_tile(script)
        time.sleep(0.01)
    assert found is not None, "no tile was seen running"
    tile, worker = found
    assert worker != dask.pid, "a tile runs in a worker"
    for process in (worker, tile):
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            assert process == tile, "the worker is there"
    assert dask.wait(timeout=900) == 0
    assert hash_of(folder / "dask.ply") == expected
print("a worker was killed; the same bytes")
