"""Clouds of Open3D, legacy and tensor, cleaned through numpy. Open3D itself is used as it was imported by the caller."""

import numpy as np

from . import _functions
from ._options import takes_options


def _legacy(cloud, xyz, report, staying):
    out = type(cloud)(cloud)
    vectors = type(cloud.points)  # open3d.utility.Vector3dVector
    out.points = vectors(xyz)
    if "normals" in report["fields"]:
        out.normals = vectors(report["fields"]["normals"])
    return out if staying is None else out.select_by_index(np.flatnonzero(staying).tolist())


def _tensor(cloud, xyz, report, staying):
    out = cloud.clone()
    positions = cloud.point.positions
    tensor = type(positions)
    out.point.positions = tensor(np.ascontiguousarray(xyz), device=positions.device)
    if "normals" in report["fields"]:
        normals = report["fields"]["normals"].astype(xyz.dtype)
        out.point.normals = tensor(np.ascontiguousarray(normals), device=positions.device)
    return out if staying is None else out.select_by_mask(tensor(staying, device=positions.device))


@takes_options("denoise")
def denoise(cloud, *, threads=0, progress=None, config=None, **options):
    """`rfsmooth.denoise` for an open3d.geometry.PointCloud or an open3d.t.geometry.PointCloud, on any device. Returns a new
    cloud, with all that the given one has, and the report. normals=True gives it the smoothed surface's normals; else those
    it has stay and describe the old positions. outliers="remove" takes points out with all their attributes.
    """
    options = _functions._config(denoise.table, config, options)
    legacy = hasattr(cloud, "points")
    points = np.asarray(cloud.points) if legacy else cloud.point.positions.cpu().numpy()
    xyz, report, staying = _functions.denoise_every_row(points, options, threads, progress)
    return (_legacy if legacy else _tensor)(cloud, xyz, report, staying), report
