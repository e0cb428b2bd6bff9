"""The stub says what the module has: as mypy sees both, and as a program that uses it is checked."""

import os
import pathlib
import subprocess
import sys

import pytest

import rfsmooth

pytest.importorskip("mypy")
PACKAGE = pathlib.Path(rfsmooth.__file__).parent


def mypy(module, *arguments, folder):
    return subprocess.run(
        [sys.executable, "-m", module, *arguments],
        cwd=folder,
        env={**os.environ, "MYPYPATH": str(PACKAGE.parent)},
        capture_output=True,
        text=True,
    )


def test_there_is_a_stub_and_a_mark():
    assert (PACKAGE / "py.typed").exists() and (PACKAGE / "__init__.pyi").exists()


def test_signatures_of_stub_and_module_agree(tmp_path):
    (tmp_path / "allowed").write_text("rfsmooth\\._.*\nrfsmooth\\.(las|open3d|__main__).*\nrfsmooth\\.Cloud.*\n")
    (tmp_path / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\n")  # laspy, open3d
    given = ("--allowlist", "allowed", "--ignore-unused-allowlist", "--mypy-config-file", "mypy.ini")
    ran = mypy("mypy.stubtest", "rfsmooth", *given, folder=tmp_path)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_a_program_is_checked(tmp_path):
    (tmp_path / "right.py").write_text(
        "import numpy as np, rfsmooth\n"
        "out, report = rfsmooth.denoise(np.zeros((9, 3)), strength=0.5, flow='auto', noise='2x', progress=True)\n"
        "made, _ = rfsmooth.mesh(out, stage='sdg')\nprint(made.vertices, report['noise'])\n"
    )
    (tmp_path / "wrong.py").write_text(
        "import numpy as np, rfsmooth\nrfsmooth.denoise(np.zeros((9, 3)), flow='autom')\nrfsmooth.denoise(1, strenght=2)\n"
    )
    assert mypy("mypy", "right.py", folder=tmp_path).returncode == 0
    wrong = mypy("mypy", "wrong.py", folder=tmp_path)
    assert wrong.returncode == 1 and wrong.stdout.count("error:") >= 2
