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


def test_normals_are_made_anew_on_their_side_and_covariances_dropped(sphere):
    """As the C++ adapter does: those that came describe a surface that has moved."""
    inward = -sphere / np.linalg.norm(sphere, axis=1, keepdims=True)
    tilted = inward + 0.3 * np.random.default_rng(3).standard_normal(sphere.shape)
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    legacy = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(sphere))
    legacy.normals = o3d.utility.Vector3dVector(tilted)
    legacy.estimate_covariances()
    tensor = o3d.t.geometry.PointCloud(o3d.core.Tensor(sphere.astype(np.float32)))
    tensor.point.normals = o3d.core.Tensor(tilted.astype(np.float32))
    tensor.point.covariances = o3d.core.Tensor(np.asarray(legacy.covariances).astype(np.float32))
    of_legacy, _ = rfsmooth.open3d.denoise(legacy)
    of_tensor, _ = rfsmooth.open3d.denoise(tensor)
    for points, normals in (
        (np.asarray(of_legacy.points), np.asarray(of_legacy.normals)),
        (of_tensor.point.positions.numpy(), of_tensor.point.normals.numpy()),
    ):
        cosine = -np.sum(normals * points, axis=1) / np.linalg.norm(points, axis=1)
        assert np.mean(cosine > 0.9) > 0.99
    assert of_tensor.point.normals.numpy().dtype == np.float32
    assert not of_legacy.has_covariances() and "covariances" not in of_tensor.point
    assert legacy.has_covariances() and np.array_equal(np.asarray(legacy.normals), tilted)
    still, report = rfsmooth.open3d.denoise(legacy, strength=0)
    assert report["counts"]["moved"] == 0 and still.has_covariances()
    assert np.array_equal(np.asarray(still.normals), tilted)


def test_normals_that_were_asked_for_leave_with_outliers(sphere):
    legacy = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.vstack([[[3, 3, 3]], sphere])))
    out, report = rfsmooth.open3d.denoise(legacy, outliers="remove", normals=True)
    points, normals = np.asarray(out.points), np.asarray(out.normals)
    assert report["counts"]["removed"] == 1 and len(points) == len(normals) == len(sphere)
    assert np.mean(np.sum(normals * points, axis=1) > 0.9) > 0.99


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
