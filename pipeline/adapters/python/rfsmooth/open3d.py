"""Clouds of Open3D, legacy and tensor, cleaned through numpy. Open3D itself is used as it was imported by the caller."""

import numpy as np

from . import _functions
from ._options import takes_options


class _Legacy:
    """An open3d.geometry.PointCloud as arrays."""

    def __init__(self, cloud):
        self.cloud = cloud

    def points(self):
        return np.asarray(self.cloud.points)

    def normals(self):
        return np.asarray(self.cloud.normals) if self.cloud.has_normals() else None

    def moved(self, xyz, staying):
        """A copy with these points, without those that are not staying."""
        cloud = type(self.cloud)(self.cloud)
        cloud.points = type(cloud.points)(xyz)  # open3d.utility.Vector3dVector
        return _Legacy(cloud if staying is None else cloud.select_by_index(np.flatnonzero(staying).tolist()))

    def put_normals(self, normals):
        self.cloud.normals = type(self.cloud.points)(normals)

    def drop_covariances(self):
        self.cloud.covariances = type(self.cloud.covariances)()


class _Tensor:
    """An open3d.t.geometry.PointCloud as arrays."""

    def __init__(self, cloud):
        self.cloud = cloud

    def _tensor(self, array):
        positions = self.cloud.point.positions
        return type(positions)(np.ascontiguousarray(array), device=positions.device)

    def points(self):
        return self.cloud.point.positions.cpu().numpy()

    def normals(self):
        return self.cloud.point.normals.cpu().numpy() if "normals" in self.cloud.point else None

    def moved(self, xyz, staying):
        """A copy with these points, without those that are not staying."""
        out = _Tensor(self.cloud.clone())
        out.cloud.point.positions = self._tensor(xyz)
        return out if staying is None else _Tensor(out.cloud.select_by_mask(self._tensor(staying)))

    def put_normals(self, normals):
        self.cloud.point.normals = self._tensor(normals.astype(self.points().dtype))

    def drop_covariances(self):
        if "covariances" in self.cloud.point:
            del self.cloud.point["covariances"]


@takes_options("denoise")
def denoise(cloud, *, threads=0, progress=None, config=None, **options):
    """`rfsmooth.denoise` for an open3d.geometry.PointCloud or an open3d.t.geometry.PointCloud, on any device. Returns a new
    cloud, with all that the given one has, and the report. Normals, where it has some, are made anew for the points that
    have moved, on the side they were on; normals=True gives any cloud the smoothed surface's. Covariances describe the old
    positions and are dropped. outliers="remove" takes points out with all their attributes. A cloud that comes back as it
    was keeps all it has.
    """
    options = _functions._config(denoise.table, config, options)
    given = (_Legacy if hasattr(cloud, "points") else _Tensor)(cloud)
    xyz, report, staying = _functions.denoise_every_row(given.points(), options, threads, progress)
    out = given.moved(xyz, staying)
    same = report["counts"]["moved"] == 0 and report["counts"]["removed"] == 0
    if "normals" in report["fields"]:
        made = report["fields"]["normals"]
        out.put_normals(made if staying is None else made[staying])
    elif not same and out.normals() is not None:
        out.put_normals(_functions.normals_anew(out.points(), out.normals(), threads, progress))
    if not same:
        out.drop_covariances()
    return out.cloud, report
