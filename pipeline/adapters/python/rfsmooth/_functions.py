"""The functions that users call. Each works on copies: what is given is never changed."""

import json
import operator
import os
from typing import NamedTuple, Optional

import numpy as np

from . import _arrays, _rfsmooth
from ._options import takes_options
from ._progress import listener
from ._reconstruct import run_reconstruct

_ROW = "row of the array"


class Mesh(NamedTuple):
    """Vertices with triangles, or with edges where there are no faces.

    vertices: n x 3. faces: m x 3 of uint32. edges: k x 2 of uint32, those that no face has. kinds: of edges of the graph, 0
    of the tree, 1 added, 2 a bridge; else None.
    """

    vertices: np.ndarray
    faces: np.ndarray
    edges: np.ndarray
    kinds: Optional[np.ndarray] = None


def _config(table, config, given):
    """The options in `config`, a report, an object of options or the path of either; those given win."""
    if config is None:
        return given
    if isinstance(config, (str, os.PathLike)):
        with open(config, encoding="utf-8") as file:
            config = json.load(file)
    return {**table.from_config(config), **given}


def _threads(threads):
    """A whole number, 0 or more."""
    if isinstance(threads, bool):
        raise TypeError("threads must be a whole number")
    threads = operator.index(threads)
    if threads < 0:
        raise ValueError("threads must be 0 (all cores) or more")
    return threads


def _fields_given(options, n):
    """Takes arrays out of the options that name fields: their names take their place."""
    fields = {}
    for name, value in options.items():
        if name.endswith("_field") and value is not None and not isinstance(value, str):
            fields[name] = _arrays.as_column(value, n, name)
    return {**options, **{name: name for name in fields}}, fields


def _run(function, options, cloud, threads, progress, name="points"):
    texts = function.table.texts(options)
    with listener(progress) as listening:
        report = _rfsmooth.run_on_cloud(function.table.command, texts, cloud, name, _threads(threads), listening)
    return json.loads(report)


def _added(table, known):
    """The fields behind the first `known` ones, normals as n x 3, marks as true and false."""
    added = {name: np.array(table[name]) for name in table.dtype.names[known:]}
    if {"nx", "ny", "nz"} <= set(added):
        added["normals"] = np.stack([added.pop(name) for name in ("nx", "ny", "nz")], axis=1)
    if "outlier" in added:
        added["outlier"] = added["outlier"].astype(bool)
    return added


@takes_options("denoise")
def denoise(points, *, threads=0, progress=None, config=None, **options):
    """Takes the noise out of n x 3 points (float32 or float64). Returns them, of the same type and in the same order, and
    the report: what the command writes with --report, and under "fields" the arrays that were asked for: "normals" (n x 3),
    "displacement", "outlier".

    Points with a NaN or infinite coordinate stay as they are. strength_field is an array of n values in [0, 1]. threads: 0
    is all cores; the result is the same. progress: True (a bar by tqdm) or a callable of the stage and the share done.
    config: an earlier report, or its path, to do the same again. Raises rfsmooth.Error.
    """
    given = _arrays.as_points(points)
    options, fields = _fields_given(_config(denoise.table, config, options), len(given))
    cloud = _arrays.cloud_of_points(given, fields)
    report = _run(denoise, options, cloud, threads, progress)
    table = _arrays.structured(cloud)
    out = table.view(given.dtype).reshape(-1, 3) if len(table.dtype) == 3 else _arrays.points_of(table, cloud)
    report["fields"] = _added(table, 3 + len(fields))
    return out, report


def denoise_every_row(points, options, threads, progress):
    """`denoise` for those who take outliers out themselves: every row comes back. Returns the points, the report, which is
    that of outliers="remove" where that was asked for, and which rows are to stay, or None for all.
    """
    if options.get("outliers") != "remove":
        return *denoise(points, threads=threads, progress=progress, **options), None
    clean, report = denoise(points, threads=threads, progress=progress, **{**options, "outliers": "mark"})
    report["options"]["outliers"] = "remove"
    report["counts"]["removed"] = report["counts"]["outliers"]
    return clean, report, ~report["fields"]["outlier"]


@takes_options("denoise")
def denoise_structured(array, *, threads=0, progress=None, config=None, **options):
    """`denoise` for a structured array with fields X, Y, Z or x, y, z, as PDAL and laspy give them. Returns a new array and
    the report. All other fields stay, in their order; added ones (displacement, outlier, nx, ny, nz) come behind them, or
    take the place of those of that name. strength_field may name a field. Whole numbers, as laspy has them, are rounded to
    whole numbers; they must be of one scale on all three axes.
    """
    array = _arrays.as_array(array, "the array")
    if array.ndim != 1:
        raise ValueError("the array must have one dimension")
    xyz = _arrays.names_of_coordinates(array.dtype)
    options, fields = _fields_given(_config(denoise.table, config, options), len(array))
    plain = [name for name in array.dtype.names if _arrays.is_plain(array.dtype[name])]
    columns = {name: array[name] for name in plain}
    for axis in xyz:
        if axis not in columns:
            raise TypeError(f"field {axis} is of {array.dtype[axis]}, not a number")
    rows = {_ROW: np.arange(len(array))}  # which of them stay, where outliers are removed
    cloud = _arrays.cloud_of_columns({**columns, **fields, **rows}, xyz)
    report = _run(denoise_structured, options, cloud, threads, progress)
    table = _arrays.structured(cloud)
    kept = array if len(table) == len(array) else array[table[_ROW]]
    added = list(table.dtype.names[len(plain) + len(fields) + 1 :])
    dtype = [(name, array.dtype[name]) for name in array.dtype.names]
    out = np.empty(len(table), dtype + [(name, table.dtype[name]) for name in added])
    for name in array.dtype.names:
        out[name] = table[name] if name in columns else kept[name]
    for name in added:
        out[name] = table[name]
    return out, report


@takes_options("mesh")
def mesh(points, *, threads=0, progress=None, config=None, **options):
    """The rough mesh that `denoise` works on, or the graphs it is made from. Returns a Mesh, whose vertices are the distinct
    finite points in the order in which they first come, outliers among them, and the report.
    """
    given = _arrays.as_points(points)
    cloud = _arrays.cloud_of_points(given)
    report = _run(mesh, _config(mesh.table, config, options), cloud, threads, progress)
    made = Mesh(cloud.positions().astype(given.dtype, copy=False), cloud.faces(), cloud.edges(), cloud.edge_kinds())
    return made, report


@takes_options("smooth-mesh")
def smooth_mesh(vertices, faces, *, threads=0, progress=None, config=None, **options):
    """Moves the vertices (n x 3) of a triangle mesh (m x 3 indices) by a flow; may refine it and find its ridges. Returns a
    Mesh and the report, whose "fields" has "ridge" if that was asked for. strength_field, fixed_field, axis_field and
    plane_field are arrays of n values.
    """
    given = _arrays.as_points(vertices, "vertices")
    triangles = _arrays.as_faces(faces, len(given))
    options, fields = _fields_given(_config(smooth_mesh.table, config, options), len(given))
    cloud = _arrays.cloud_of_points(given, fields)
    cloud.put_faces(triangles)
    report = _run(smooth_mesh, options, cloud, threads, progress, "mesh")
    table = _arrays.structured(cloud)
    report["fields"] = {"ridge": np.array(table["ridge"])} if "ridge" in table.dtype.names else {}
    out = cloud.positions().astype(given.dtype, copy=False)
    return Mesh(out, cloud.faces(), cloud.edges()), report


@takes_options("reconstruct")
def reconstruct(points, *, threads=0, config=None, **options):
    """A surface through noisy points, as a Mesh, and the report. The work is done by the program rfsmooth-reconstruct, which
    links the libraries that make surfaces (Open3D, CGAL); rfsmooth.Error with code "not_installed" if it is not in PATH.
    """
    cloud = _arrays.cloud_of_points(_arrays.as_points(points))
    table = reconstruct.table
    earlier = {name: value for name, value in _config(table, config, {}).items() if name not in options}
    file, report = run_reconstruct(cloud, table.texts(options), table.texts(earlier), _threads(threads))
    return Mesh(file.positions(), file.faces(), file.edges()), report


def _normals_of(points, normals, name, whose):
    """One for each of the points, or None."""
    if normals is None:
        return None
    normals = _arrays.as_points(normals, name).astype(np.float64, copy=False)
    if len(normals) != len(points):
        raise ValueError(f"{name} must have one row for each {whose}")
    return normals


def compare(
    points, truth, faces=None, *, normals=None, truth_normals=None, signed_normals=False, threads=0, progress=None
):
    """Measures points against the truth: a mesh (its vertices and faces), or a clean cloud. Returns the distance of every
    point and the report. normals: n x 3, of the points, whose error is then measured too, against the faces or against
    truth_normals, one for each clean point; signed_normals: they claim a side.
    """
    given = _arrays.as_points(points).astype(np.float64, copy=False)
    true_points = _arrays.as_points(truth, "truth").astype(np.float64, copy=False)
    corners = None if faces is None else _arrays.as_faces(faces, len(true_points))
    normals = _normals_of(given, normals, "normals", "point")
    truth_normals = _normals_of(true_points, truth_normals, "truth_normals", "true point")
    if truth_normals is not None and corners is not None:
        raise ValueError("truth_normals are of a clean cloud; faces have their own")
    if normals is not None and truth_normals is None and corners is None:
        raise ValueError("normals need truth_normals, or faces, to be compared with")
    if normals is None and (truth_normals is not None or signed_normals):
        raise ValueError(f"{'signed_normals' if signed_normals else 'truth_normals'} needs normals")
    deviation = np.empty(len(given))
    with listener(progress) as listening:
        report = _rfsmooth.compare(
            given, normals, true_points, corners, truth_normals, signed_normals, _threads(threads), listening, deviation
        )
    return deviation, json.loads(report)


def normals(points, *, viewpoint=None, threads=0, progress=None):
    """Unit normals of smooth points, n x 3 float64, outward or towards `viewpoint` (x, y, z), and the report. Points that are
    not finite get NaN.
    """
    given = _arrays.as_points(points).astype(np.float64, copy=False)
    made = np.empty_like(given)
    if viewpoint is not None:
        viewpoint = [float(v) for v in viewpoint]
    with listener(progress) as listening:
        report = _rfsmooth.normals(given, made, viewpoint, None, _threads(threads), listening)
    return made, json.loads(report)


def normals_anew(points, before, threads, progress):
    """Unit normals of points that have moved, on the side that those before were on; points that are not finite keep
    theirs.
    """
    given, old = (_arrays.as_points(array).astype(np.float64, copy=False) for array in (points, before))
    made = np.empty_like(given)
    with listener(progress) as listening:
        _rfsmooth.normals(given, made, None, old, _threads(threads), listening)
    return np.where(np.isfinite(given).all(axis=1, keepdims=True), made, old)


def info(points):
    """What an array of points, or a file, holds: fields, extent, spacing, noise."""
    if isinstance(points, (str, os.PathLike)):
        path = os.fspath(points)
        return {"path": path, **json.loads(_rfsmooth.info(_rfsmooth.read_file(path)))}
    return json.loads(_rfsmooth.info(_arrays.cloud_of_points(_arrays.as_points(points))))


def read(path):
    """Reads a file (PLY, PCD, XYZ, LAS, OFF; known by its content). Returns its points as a structured array, and a Cloud: the file
    with all that stands beside them, for `write`. Fields that are lists stay in the file.
    """
    file = _rfsmooth.read_file(os.fspath(path))
    return _arrays.structured(file), file


def write(path, points, file=None, *, format=None, encoding=None, force=False, drop_unsupported=False, scale=None):
    """Writes points, a structured array or n x 3, by the path's extension; complete or not at all. With the `file` that they
    were read from, everything else in it comes along, and what did not change keeps its bytes or its text. format,
    encoding, force, drop_unsupported: as of the command. scale: of n x 3 into a LAS file, the largest step that coordinates
    may be rounded to; a coarser one is refined by a power of ten.
    """
    array = _arrays.as_array(points, "points")
    if array.dtype.names is None:
        xyz = _arrays.as_points(array)
        if file is None:
            cloud = _arrays.cloud_of_points(xyz)
        else:
            _check_rows(xyz, file)
            cloud = file.__copy__()
            cloud.put_positions(xyz.astype(np.float64, copy=False), scale)
    elif file is not None:
        cloud = _with_rows(file, array)
    else:
        xyz = _arrays.names_of_coordinates(array.dtype)
        lower = dict(zip(xyz, "xyz"))
        cloud = _arrays.cloud_of_columns({lower.get(n, n): array[n] for n in array.dtype.names}, ("x", "y", "z"))
    _rfsmooth.write_file(cloud, os.fspath(path), format, encoding, force, drop_unsupported)


def _check_rows(array, file):
    if len(array) != len(file):
        raise ValueError(f"the file has {len(file)} points, the array {len(array)}")


def _with_rows(file, array):
    """A copy of `file` with the rows of `array`: its fields in place, others behind them."""
    _check_rows(array, file)
    table = _arrays.structured(file)
    names = table.dtype.names
    if not set(names) <= set(array.dtype.names):
        raise ValueError(f"fields are missing: {', '.join(set(names) - set(array.dtype.names))}")
    added = [name for name in array.dtype.names if name not in names]
    packed = np.empty(len(array), table.dtype.descr + [(name, array.dtype[name]) for name in added])
    for name in packed.dtype.names:
        packed[name] = array[name]
    fields = file.fields + [_arrays.field_of(name, packed.dtype[name]) for name in added]
    cloud = file.__copy__()
    cloud.put_rows(fields, packed.view(np.uint8).reshape(-1), len(names))
    return cloud
