"""What a program meets while a call is running: progress, other threads, Ctrl-C."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import rfsmooth
from conftest import noisy_sphere


def test_progress_rises_to_one_through_the_stages(sphere):
    heard = []
    rfsmooth.denoise(np.tile(sphere, (1, 1)), progress=lambda stage, share: heard.append((stage, share)))
    shares = [share for _, share in heard]
    assert shares and shares == sorted(shares) and 0 <= shares[0] and shares[-1] <= 1
    assert all(isinstance(stage, str) for stage, _ in heard)


def test_what_progress_raises_ends_the_call(sphere):
    def stop(stage, share):
        raise RuntimeError("enough")

    kept = sphere.copy()
    with pytest.raises(RuntimeError, match="enough"):
        rfsmooth.denoise(noisy_sphere(20000), progress=stop)
    assert np.array_equal(sphere, kept)


def test_a_bar_by_tqdm(sphere, capsys):
    pytest.importorskip("tqdm")
    rfsmooth.denoise(sphere, progress=True)
    assert "%" in capsys.readouterr().err


def test_other_threads_go_on():
    """A thread of Python counts while a call runs; with the interpreter held it would not get a single turn."""
    turns, over = [], threading.Event()

    def count():
        while not over.is_set():
            turns.append(time.perf_counter())
            time.sleep(0.005)

    points = noisy_sphere(60000)
    thread = threading.Thread(target=count)
    thread.start()
    start = time.perf_counter()
    rfsmooth.denoise(points, threads=1)
    end = time.perf_counter()
    over.set()
    thread.join()
    meanwhile = [t for t in turns if start < t < end]
    assert len(meanwhile) >= 10


def test_several_calls_at_once_give_what_one_does(sphere):
    expected, _ = rfsmooth.denoise(sphere)
    results = [None] * 4

    def run(k):
        results[k] = rfsmooth.denoise(sphere)[0]

    threads = [threading.Thread(target=run, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(result, expected) for result in results)


INTERRUPTED = """
import os, signal, sys, threading, time
import numpy as np
import rfsmooth
sys.path.insert(0, sys.argv[1])
from conftest import noisy_sphere
points = noisy_sphere(1_000_000)
kept = points.copy()
sent = [0.0]
def send():
    time.sleep(float(sys.argv[2]))
    sent[0] = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send).start()
try:
    rfsmooth.denoise(points)
except KeyboardInterrupt:
    print("late by", time.perf_counter() - sent[0], "unchanged", np.array_equal(points, kept))
"""


@pytest.mark.parametrize("after", [0.05, 0.7, 2.0])
def test_ctrl_c_raises_keyboard_interrupt_at_a_million_points(after):
    """Within half a second, on a machine that does nothing else; here it may do."""
    ran = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, os.path.dirname(__file__), str(after)],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert ran.returncode == 0, ran.stderr
    words = ran.stdout.split()
    assert words[:2] == ["late", "by"] and words[-1] == "True", ran.stdout + ran.stderr
    assert float(words[2]) < 5
