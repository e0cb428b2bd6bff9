"""Clouds of Open3D, as the package index has it and as Debian has it."""

import numpy as np
import pytest

import rfsmooth

o3d = pytest.importorskip("open3d")
import rfsmooth.open3d  # noqa: E402


@pytest.fixture
def colours(sphere):
    return np.abs(sphere) / np.abs(sphere).max()


def test_legacy_clouds_keep_their_colours(sphere, colours):
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(sphere))
    cloud.colors = o3d.utility.Vector3dVector(colours)
    out, report = rfsmooth.open3d.denoise(cloud)
    assert np.array_equal(np.asarray(cloud.points), sphere)
    assert np.array_equal(np.asarray(out.points), rfsmooth.denoise(sphere)[0])
    assert np.array_equal(np.asarray(out.colors), colours)
    assert not out.has_normals() and report["noise"] > 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_tensor_clouds_keep_their_attributes(sphere, dtype):
    given = sphere.astype(dtype)
    cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(given))
    cloud.point.intensity = o3d.core.Tensor(np.arange(len(given), dtype=np.int32).reshape(-1, 1))
    out, _ = rfsmooth.open3d.denoise(cloud, normals=True)
    assert np.array_equal(cloud.point.positions.numpy(), given)
    assert np.array_equal(out.point.positions.numpy(), rfsmooth.denoise(given)[0])
    assert np.array_equal(out.point.intensity.numpy(), cloud.point.intensity.numpy())
    assert out.point.normals.numpy().dtype == dtype and "normals" not in cloud.point


def test_outliers_leave_with_their_attributes(sphere, colours):
    points = np.vstack([[[3, 3, 3]], sphere])
    legacy = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    legacy.colors = o3d.utility.Vector3dVector(np.vstack([[[1, 0, 0]], colours]))
    out, report = rfsmooth.open3d.denoise(legacy, outliers="remove")
    assert np.array_equal(np.asarray(out.colors), colours)
    assert report["options"]["outliers"] == "remove"
    assert report["counts"]["removed"] == report["counts"]["outliers"] == 1
    again, _ = rfsmooth.open3d.denoise(legacy, config=report)
    assert np.array_equal(np.asarray(again.points), np.asarray(out.points))
    tensor = o3d.t.geometry.PointCloud.from_legacy(legacy, o3d.core.float64)
    out, _ = rfsmooth.open3d.denoise(tensor, outliers="remove")
    assert len(out.point.positions) == len(out.point.colors) == len(sphere)
