"""Arrays of points as clouds in memory, and back."""

import math

import numpy as np

from . import _rfsmooth

_TYPES = {np.dtype(t) for t in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8")}
_XYZ = (("x", "y", "z"), ("X", "Y", "Z"))


def as_array(values, name):
    """An array of the values. ValueError if some are masked: what stands there is no value."""
    if isinstance(values, np.ma.MaskedArray) and b"\1" in np.ma.getmaskarray(values).tobytes():
        raise ValueError(f"{name} has masked values: fill them (coordinates with NaN, say), or take their rows out")
    return np.asarray(values)


def as_points(points, name="points"):
    """n x 3 of float32 or float64, in C order and the machine's byte order; a copy only where it must be."""
    array = as_array(points, name)
    if array.dtype.kind in "iub":
        array = array.astype(np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must be n x 3, not {' x '.join(map(str, array.shape)) or 'a number'}")
    native = array.dtype.newbyteorder("=")
    if native not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise TypeError(f"{name} must be of float32 or float64, not {array.dtype}")
    return np.ascontiguousarray(array, native)


def as_faces(faces, vertices):
    """m x 3 of uint32, each naming one of that many vertices."""
    array = as_array(faces, "faces")
    if array.size == 0:
        return np.empty((0, 3), np.uint32)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise ValueError("faces must be m x 3 whole numbers")
    if array.min() < 0 or array.max() >= vertices:
        raise ValueError(f"faces name vertices outside 0 to {vertices - 1}")
    return np.ascontiguousarray(array, np.uint32)


def as_column(values, n, name):
    """One number of a plain type for each of n points."""
    array = as_array(values, name)
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    if array.shape != (n,):
        raise ValueError(f"{name} must have one value for each of the {n} points")
    return array.astype(array.dtype.newbyteorder("="), copy=False)


def cloud_of_points(points, fields=None):
    """Of an array as `as_points` gives it, with more fields by name."""
    n = len(points)
    if not fields:
        rows = points.reshape(-1).view(np.uint8)
        return _rfsmooth.Cloud([(axis, points.dtype.name, 1) for axis in "xyz"], rows, n, (0, 1, 2))
    columns = dict(zip("xyz", points.T))
    columns.update(fields)
    return cloud_of_columns(columns, ("x", "y", "z"))


def field_of(name, dtype):
    """A field as clouds have it: its name, its type and how many values a row has."""
    return name, dtype.base.name, math.prod(dtype.shape)


def cloud_of_columns(columns, xyz):
    """Of columns by name, three of which are the coordinates."""
    n = len(columns[xyz[0]])
    packed = np.empty(n, [(name, column.dtype.newbyteorder("="), column.shape[1:]) for name, column in columns.items()])
    for name, column in columns.items():
        packed[name] = column
    fields = [field_of(name, packed.dtype[name]) for name in columns]
    names = list(columns)
    return _rfsmooth.Cloud(fields, packed.view(np.uint8), n, tuple(names.index(axis) for axis in xyz))


def structured(cloud):
    """The points' fields as one array; of fields that share a name the later ones are called name_1, ..."""
    taken, dtype = set(), []
    for name, kind, count in cloud.fields:
        unique, k = name, 0
        while unique in taken:
            k += 1
            unique = f"{name}_{k}"
        taken.add(unique)
        dtype.append((unique, kind) if count == 1 else (unique, kind, (count,)))
    return cloud.rows().view(dtype)


def points_of(table, cloud):
    """The columns of the coordinates as n x 3, of their common type."""
    return np.stack([table[table.dtype.names[f]] for f in cloud.xyz], axis=1)


def names_of_coordinates(dtype):
    """("X", "Y", "Z") or ("x", "y", "z"), whichever a structured type has."""
    for names in _XYZ:
        if dtype.names is not None and set(names) <= set(dtype.names):
            return names
    raise TypeError("the array has no fields X, Y, Z (or x, y, z)")


def is_plain(dtype):
    """Whether a field holds one number that files have."""
    return dtype.newbyteorder("=") in _TYPES
