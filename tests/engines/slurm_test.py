"""Tiles by Slurm: four nodes on this host, one lost in the middle; its tiles are requeued, the bytes are the same."""
import os
import pathlib
import secrets
import signal
import socket
import subprocess
import sys
import tempfile
import time

from engines import TILE_POINTS, alone, hash_of, held_tile, holding, parent_of

COMMAND, SCRIPT = sys.argv[1:3]
SKIPPED = 77
NODES, MINUTES = 4, 10

CONFIGURATION = """
ClusterName=tiles
SlurmctldHost={host}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/control.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/control.log
SlurmdLogFile={folder}/%n.log
SlurmctldPort={port}
SlurmdTimeout=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SchedulerParameters=sched_interval=1
NodeName=n[1-{nodes}] NodeHostname={host} Port=[{first}-{last}] CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
"""


def say(*words):
    return subprocess.run([str(word) for word in words], check=True, stdout=subprocess.PIPE, text=True).stdout


def free_ports(count):
    """So many ports in a row that nobody listens at."""
    for first in range(26000, 30000, count):
        try:
            for port in range(first, first + count):
                with socket.socket() as test:
                    test.bind(("", port))
            return first
        except OSError:
            continue
    raise RuntimeError("no free ports")


def start(folder):
    """Starts munge, the controller and the nodes."""
    for part in ("state", "munge", "spool"):
        (folder / part).mkdir()
    munge = folder / "munge"
    munge.chmod(0o700)
    (munge / "key").write_bytes(secrets.token_bytes(128))
    (munge / "key").chmod(0o400)
    say("munged", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket", f"--pid-file={munge}/pid",
        f"--log-file={munge}/log", f"--seed-file={munge}/seed")
    port = free_ports(NODES + 1)
    file = folder / "slurm.conf"
    file.write_text(CONFIGURATION.format(host=socket.gethostname().split(".")[0], folder=folder, port=port,
                                         first=port + 1, last=port + NODES, nodes=NODES))
    os.environ["SLURM_CONF"] = str(file)
    say("slurmctld", "-f", file)
    for node in range(1, NODES + 1):
        say("slurmd", "-N", f"n{node}", "-f", file)


def stop(folder):
    for file in (*folder.glob("*.pid"), folder / "munge" / "pid"):
        try:
            os.kill(int(file.read_text()), signal.SIGKILL)
        except (OSError, ValueError):
            pass  # it has ended


def lose_node(tile):
    """Kills the node that runs a tile, and what it runs."""
    words = pathlib.Path(f"/proc/{tile}/environ").read_bytes().split(b"\0")
    node = next(word.split(b"=")[1].decode() for word in words if word.startswith(b"SLURMD_NODENAME="))
    daemon = int((folder / f"{node}.pid").read_text())
    line = [tile]  # up to the one that would tell the controller: it goes first
    while (parent := parent_of(line[-1])) not in (0, 1, daemon):
        line.append(parent)
    for process in (daemon, *reversed(line)):
        os.kill(process, signal.SIGKILL)
    return node


def hurry():
    """Slurm waits two minutes before it starts a requeued job: the test does not."""
    for line in say("squeue", "-h", "-t", "PD", "-o", "%i %r").splitlines():
        number, reason = line.split()
        if reason.strip("()") == "BeginTime":
            subprocess.run(["scontrol", "update", f"JobId={number}", "StartTime=now"], check=False)


if os.geteuid() != 0:
    print("Slurm's nodes are started by root only")
    sys.exit(SKIPPED)
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    expected = alone(COMMAND, folder)
    job = folder / "job"
    try:
        start(folder)
        script = holding(COMMAND, folder)
        os.environ.update(RFSMOOTH=str(script), TILE_POINTS=str(TILE_POINTS))
        say("sh", SCRIPT, job, folder / "slurm.ply", folder / "in.ply")
        end, lost = time.time() + 60 * MINUTES, None
        while not (folder / "slurm.ply").exists():
            assert time.time() < end, say("squeue") + say("sinfo")
            found = held_tile(script) if lost is None else None
            if found is not None:
                try:
                    lost = lose_node(found[0])
                except (OSError, StopIteration):
                    pass  # that tile had ended
            time.sleep(0.01 if lost is None else 1)
            if lost is not None:
                hurry()
        assert lost is not None, "no tile was seen running"
        assert hash_of(folder / "slurm.ply") == expected
        print(f"node {lost} was lost; the same bytes")
    finally:
        stop(folder)
