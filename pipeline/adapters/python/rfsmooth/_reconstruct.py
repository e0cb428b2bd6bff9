"""The program rfsmooth-reconstruct, which links what the module does not."""

import json
import os
import shutil
import subprocess
import tempfile

from . import _rfsmooth
from ._error import Error

_CODES = {exit_code: code for code, exit_code in _rfsmooth.exit_codes.items()}


def _typed(name, text):
    if text in ("true", "false"):
        return f"--{name}" if text == "true" else f"--no-{name}"
    return f"--{name}={text}"


def run_reconstruct(cloud, options, config, threads):
    """The surface as a Cloud with faces, and the report. config: the options of an earlier run that are not among `options`,
    which may leave some of them without effect; both are names and texts.
    """
    program = shutil.which("rfsmooth-reconstruct")
    if program is None:
        raise Error("not_installed", "the program rfsmooth-reconstruct is not in PATH; it comes with the package of that name")
    with tempfile.TemporaryDirectory(prefix="rfsmooth-") as folder:
        names = ("points.ply", "surface.ply", "report.json", "config.json")
        source, target, report, earlier = (os.path.join(folder, name) for name in names)
        with open(earlier, "w", encoding="utf-8") as file:
            json.dump(dict(config), file)
        _rfsmooth.write_file(cloud, source, None, None, False, False)
        arguments = [_typed(name, text) for name, text in options if text != "auto"]
        if threads:
            arguments.append(f"--threads={threads}")
        ran = subprocess.run(
            [program, *arguments, "--quiet", f"--report={report}", f"--config={earlier}", source, target],
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
        if ran.returncode != 0:
            lines = [line for line in ran.stderr.splitlines() if ": error: " in line]
            message = lines[0].split(": error: ", 1)[1] if lines else f"ended with {ran.returncode}: {ran.stderr}"
            raise Error(_CODES.get(ran.returncode, "internal"), message.replace(source, "points"))
        with open(report, encoding="utf-8") as file:
            return _rfsmooth.read_file(target), json.load(file)
