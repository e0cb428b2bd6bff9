"""python -m rfsmooth: the command, and LAZ files besides."""

import os
import sys

from . import _rfsmooth
from ._error import Error
from ._options import python_name


def _is_laspys(path):
    return path.lower().endswith(".laz")


def _counted(n, what):
    return f"{n} {what}" if n == 1 else f"{n} {what}s"


def _denoise_las(files, options):
    """One LAS or LAZ file by laspy; says what the command would say."""
    from . import las

    if "output" in options:
        files = [*files, options.pop("output")]
    if len(files) != 2 or not all(path.lower().endswith((".las", ".laz")) for path in files):
        raise Error("usage", "LAZ goes to LAZ or LAS, one file at a time: rfsmooth denoise IN.laz OUT.laz")
    of_files = {"force", "threads", "quiet", "verbose", *las.denoise_file.table.entries}
    for name in options:
        if name not in of_files:
            raise Error("usage", f"--{name} has no meaning for LAZ files here")
    quiet = options.pop("quiet", False)
    bar = not quiet and sys.stderr.isatty()
    options.pop("verbose", None)
    report = las.denoise_file(*files, progress=bar, **options)
    if not quiet:
        counts, left = report["counts"], report["noise_left"]
        about = "" if left is None else f", about {left:.3g} left"
        for line in (
            f"{files[0]} -> {files[1]}: {_counted(counts['points'], 'point')}, {_counted(counts['outliers'], 'outlier')}",
            f"noise {report['noise']:.3g}{about}; spacing {report['spacing']:.4g}",
            report["scale"],
            report["index"],
        ):
            if line:
                print(f"rfsmooth: {line}", file=sys.stderr)


def _las_arguments(arguments):
    """The files and options of a `denoise` that names a LAZ file; None for anything else."""
    if arguments[:1] != ["denoise"] or not any(_is_laspys(a) for a in arguments) or {"-h", "--help", "--help-all"} & set(arguments):
        return None
    _, files, options = _rfsmooth.parse_command(arguments)
    flags = {"true": True, "false": False}
    values = {python_name(name): flags.get(text, text) for name, text in options}
    threads = values.get("threads", "auto")
    if threads != "auto" and not (threads.isdecimal() and int(threads) > 0):
        raise Error("usage", f"--threads is '{threads}'; it must be a whole number, 1 or more")
    values["threads"] = 0 if threads == "auto" else int(threads)
    return files, values


def main():
    """Runs the command and ends the process with its exit code."""
    arguments = sys.argv[1:]
    try:
        las = _las_arguments(arguments)
        if las is not None:
            _denoise_las(*las)
            sys.exit(0)
    except Error as error:
        print(f"rfsmooth: error: {error}", file=sys.stderr)
        sys.exit(_rfsmooth.exit_codes[error.code])
    except KeyboardInterrupt:
        print("rfsmooth: error: cancelled", file=sys.stderr)
        sys.exit(130)
    sys.stdout.flush()
    sys.stderr.flush()
    # The command closes standard output when it is done: nothing of Python's may come after it.
    os._exit(_rfsmooth.run_command(arguments))


if __name__ == "__main__":
    main()
