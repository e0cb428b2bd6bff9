"""What the tests share: clouds with noise, and the command.

RFSMOOTH_COMMAND is the command that was built with the module, RFSMOOTH_SOURCE the checkout.
"""

import os
import pathlib
import subprocess

import numpy as np
import pytest

SOURCE = pathlib.Path(os.environ.get("RFSMOOTH_SOURCE", pathlib.Path(__file__).parents[2]))


def noisy_sphere(n=4000, noise=0.5, seed=1):
    """A unit sphere, evenly sampled, with noise of that many spacings along the normal."""
    k = np.arange(n)
    z = 1 - (2 * k + 1) / n
    turn = k * np.pi * (3 - np.sqrt(5))
    sphere = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], axis=1)
    spacing = np.sqrt(4 * np.pi / n)
    radius = 1 + noise * spacing * np.random.default_rng(seed).standard_normal(n)
    return sphere * radius[:, None]


def error_of(points):
    """Root mean square distance from the unit sphere."""
    return np.sqrt(np.mean((np.linalg.norm(points, axis=1) - 1) ** 2))


@pytest.fixture
def sphere():
    return noisy_sphere()


@pytest.fixture
def command(tmp_path):
    """Runs the command in the test's folder."""
    program = os.environ.get("RFSMOOTH_COMMAND")
    if program is None:
        pytest.skip("RFSMOOTH_COMMAND is not set")

    def run(*arguments):
        return subprocess.run([program, *map(str, arguments)], cwd=tmp_path, check=True, capture_output=True, text=True)

    return run
