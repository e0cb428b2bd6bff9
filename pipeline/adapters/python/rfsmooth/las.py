"""LAS and LAZ files, read and written by laspy (pip install rfsmooth[laz]): header, VLRs, extra bytes and every other field
come along.
"""

import math
import os

import numpy as np

from . import _functions, _rfsmooth
from ._error import Error
from ._options import takes_options

_INT32 = 2**31 - 1


def _laspy(path):
    try:
        import laspy
    except ImportError as missing:
        raise Error(
            "not_installed", f"{path}: LAZ files need laspy and lazrs: pip install 'rfsmooth[laz]'"
        ) from missing
    return laspy


def _finer(scales, step):
    """The scales, each divided by the power of ten that makes it `step` or less."""
    fine = np.array(scales, float)
    powers = np.zeros(3, int)
    for axis in range(3):
        while fine[axis] > step and powers[axis] < 9:
            powers[axis] += 1
            fine[axis] = scales[axis] / 10.0 ** powers[axis]
    return fine, powers


def _rescale(las, step, keep):
    """Refines the scale of coordinates, unless it is to be kept: old whole numbers times a power of ten, so that what does not move stays exact.
    Returns what is to be said of it, or None. The finest that the range of whole numbers allows is taken.
    """
    header = las.header
    if keep:
        coarse = np.any(np.abs(header.scales) > step)
        old = header.scales.tolist()
        return f"scale {old} is coarser than half of the noise left: rounding takes back some of the smoothing" if coarse else None
    fine, powers = _finer(header.scales, step)
    for axis, name in enumerate("XYZ"):
        values = np.asarray(las.points.array[name], np.int64)
        largest = int(np.abs(values).max(initial=0))
        while powers[axis] > 0 and largest * 10 ** int(powers[axis]) > _INT32:
            powers[axis] -= 1
        fine[axis] = header.scales[axis] / 10.0 ** powers[axis]
        las.points.array[name] = (values * 10 ** int(powers[axis])).astype(np.int32)
    old = header.scales.copy()
    header.scales = fine
    las.points.scales = fine
    still = "; 32 bits hold no finer one of so large a cloud" if np.any(fine > step) else ""
    if powers.any():
        return f"scale {old.tolist()} -> {fine.tolist()}: the old one is coarser than half of the noise left{still}"
    return f"scale {old.tolist()} is coarser than half of the noise left{still}" if still else None


def _store(las, xyz, moved):
    """Writes the coordinates that moved back as whole numbers. Error if one does not fit."""
    for axis, name in enumerate("XYZ"):
        whole = np.rint((xyz[:, axis] - las.header.offsets[axis]) / las.header.scales[axis])
        if np.abs(whole[moved]).max(initial=0) > _INT32:
            raise Error("cannot_write", f"{name}: coordinates leave the range of the file's whole numbers")
        las.points.array[name][moved] = whole[moved].astype(np.int32)


def _check_target(target, force):
    """Refuses, before any work, a file that cannot be written."""
    if os.path.exists(target) and not force:
        raise Error("cannot_write", f"{target}: exists (--force replaces it)")
    folder = os.path.dirname(target) or "."
    if not os.path.isdir(folder):
        raise Error("cannot_write", f"{target}: cannot write: the folder '{folder}' is not there")
    if os.path.isdir(target):
        raise Error("cannot_write", f"{target}: cannot write: is a folder")
    if not os.access(folder, os.W_OK):
        raise Error("cannot_write", f"{target}: cannot write into the folder '{folder}'")


@takes_options("denoise")
def denoise_file(source, target, *, force=False, threads=0, progress=None, config=None, **options):
    """Reads a LAS or LAZ file, takes the noise out and writes another; returns the report, whose "scale" says whether the
    scale of coordinates was refined: it is, by a power of ten, where it is coarser than half of the noise left, since
    rounding to it would cost what smoothing gained (keep_scale: not). A COPC file is written as LAZ, without its index;
    "index" says so, or that a LAX index of other points lies beside the target.
    normals and write_displacement have no place in these files; outliers may be removed.
    """
    source, target = os.fspath(source), os.fspath(target)
    _check_target(target, force)
    laspy = _laspy(source)
    options = _functions._config(denoise_file.table, config, options)
    for name in ("normals", "write_displacement"):
        if options.get(name):
            raise Error("usage", f"{source}: LAS has no field for --{name.replace('_', '-')}")
    if options.get("outliers") == "mark":
        raise Error("usage", f"{source}: LAS has no field for --outliers mark")
    try:
        las = laspy.read(source)
    except FileNotFoundError as missing:
        raise Error("input_unreadable", f"{source}: {missing.strerror}") from missing
    except Exception as broken:  # laspy's, lazrs's and struct's own
        raise Error("input_unreadable", f"{source}: {broken}") from broken
    xyz = np.stack([np.asarray(las.x), np.asarray(las.y), np.asarray(las.z)], axis=1)
    strength = options.get("strength_field")
    if isinstance(strength, str):
        if strength not in las.point_format.dimension_names:
            raise Error("usage", f"{source}: the points have no field '{strength}'")
        options = {**options, "strength_field": np.asarray(las[strength], float)}
    clean, report, staying = _functions.denoise_every_row(xyz, options, threads, progress)
    step = _rfsmooth.finest_needed(report["noise"], report["noise_left"])
    rounded = step > 0 and report["counts"]["moved"] > 0
    report["scale"] = _rescale(las, step, options.get("keep_scale", False)) if rounded else None
    if rounded and report["noise_left"] is not None:
        report["noise_left"] = math.hypot(report["noise_left"], np.abs(las.header.scales).max() / math.sqrt(12))
    _store(las, clean, np.any(clean != xyz, axis=1))
    if staying is not None:
        las.points = las.points[staying]
    report["index"] = "the index of COPC is left out" if _forget_index(las) else None
    _write(las, target)
    beside = os.path.splitext(target)[0] + ".lax"
    if os.path.exists(beside):
        report["index"] = f"{beside} is an index of other points: make it anew"
    return report


def _forget_index(las):
    """That of a COPC file: it says where points are that have moved. Returns whether there was one."""
    had = False
    for records in (las.vlrs, las.evlrs or []):
        kept = [record for record in records if record.user_id != "copc"]
        had = had or len(kept) < len(records)
        records[:] = kept  # in place: laspy writes lists of its own kind only
    return had


def _write(las, target):
    """Complete or not at all."""
    partial = f"{target}.rfsmooth-{os.getpid()}{os.path.splitext(target)[1]}"
    try:
        las.write(partial)
        os.replace(partial, target)
    except Exception as failed:
        raise Error("cannot_write", f"{target}: {failed}") from failed
    finally:
        if os.path.exists(partial):
            os.remove(partial)
