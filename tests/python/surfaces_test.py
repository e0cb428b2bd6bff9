"""Meshes, comparisons and normals."""

import os
import shutil

import numpy as np
import pytest

import rfsmooth
from conftest import error_of, noisy_sphere


@pytest.mark.parametrize("stage, faces, edges", [("emst", 0, 3999), ("emst-points", 0, 3999), ("sdg", 0, None), ("rfs", None, None)])
def test_stages_of_the_rough_mesh(sphere, stage, faces, edges):
    made, report = rfsmooth.mesh(sphere, stage=stage)
    assert np.array_equal(made.vertices, sphere)
    assert faces is None and len(made.faces) > 4000 or len(made.faces) == faces
    assert edges is None or len(made.edges) == edges
    assert (made.kinds is not None) == (stage == "sdg")
    if stage == "sdg":
        assert len(made.kinds) == len(made.edges) and set(made.kinds) <= {0, 1, 2}
    for corners in (made.faces, made.edges):
        assert corners.dtype == np.uint32 and (corners.size == 0 or corners.max() < len(sphere))
    assert report["command"] == "mesh"


def test_the_mesh_is_the_commands(sphere, command, tmp_path):
    rfsmooth.write(tmp_path / "in.ply", sphere)
    command("mesh", "in.ply", "out.ply")
    file = rfsmooth.read(tmp_path / "out.ply")[1]
    assert np.array_equal(rfsmooth.mesh(sphere)[0].faces, file.faces())


def octahedron():
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    return corners, np.array(faces)


def test_smoothing_a_mesh_moves_vertices_and_keeps_faces():
    corners, faces = octahedron()
    made, report = rfsmooth.smooth_mesh(corners, faces, flow="laplacian", iterations=1)
    # Each corner's neighbours are the four corners around it, whose mean is the centre.
    assert np.allclose(made.vertices, 0, atol=1e-12) and np.array_equal(made.faces, faces)
    assert report["counts"]["steps"] == 1


def test_constraints_are_arrays():
    corners, faces = octahedron()
    fixed = np.arange(6) < 2
    made, _ = rfsmooth.smooth_mesh(corners, faces, flow="laplacian", iterations=1, fixed_field=fixed)
    assert np.array_equal(made.vertices[:2], corners[:2]) and np.allclose(made.vertices[2:], 0, atol=1e-12)


def test_refining_multiplies_the_faces_by_four():
    corners, faces = octahedron()
    made, report = rfsmooth.smooth_mesh(corners, faces, iterations=0, flow="laplacian", refine=1, ridges=True)
    assert len(made.faces) == 32 and len(made.vertices) == 18
    assert len(report["fields"]["ridge"]) == 18
    with pytest.raises(rfsmooth.Error, match="refine_chart has no effect without refine"):
        rfsmooth.smooth_mesh(corners, faces, refine_chart="tangent")


def test_faces_must_name_vertices():
    corners, faces = octahedron()
    with pytest.raises(ValueError, match="outside 0 to 5"):
        rfsmooth.smooth_mesh(corners, faces + 1)


def test_comparing_with_a_mesh_and_with_a_cloud():
    corners, faces = octahedron()
    inside = corners * 0.9
    distance, report = rfsmooth.compare(inside, corners, faces)
    # A corner at 0.9 is 0.1 along an axis from the plane x + y + z = 1 of unit normal 1/sqrt(3).
    assert np.allclose(distance, 0.1 / np.sqrt(3)) and report["truth_closed"]
    assert np.isclose(report["own_units"]["p2s_root"], 0.1 / np.sqrt(3))
    distance, report = rfsmooth.compare(inside, corners)
    assert np.allclose(distance, 0.1) and np.isclose(report["own_units"]["chamfer"], 2 * 0.01)


def test_errors_of_normals_are_compared():
    corners, _ = octahedron()
    _, right = rfsmooth.compare(noisy_sphere(500, 0), *sphere_mesh(), normals=noisy_sphere(500, 0))
    assert right["own_units"]["normal_error"] < 10


def test_errors_of_normals_against_a_clean_cloud():
    clean = noisy_sphere(500, 0)
    turned = np.stack([clean[:, 1], -clean[:, 0], clean[:, 2]], axis=1)  # by 90 degrees around z
    _, same = rfsmooth.compare(clean, clean, normals=clean, truth_normals=clean)
    assert same["own_units"]["normal_error"] < 1e-6
    _, flipped = rfsmooth.compare(clean, clean, normals=-clean, truth_normals=clean, signed_normals=True)
    assert np.isclose(flipped["own_units"]["normal_error"], 180)
    expected = np.degrees(np.arccos(np.clip(np.abs(np.sum(turned * clean, axis=1)), 0, 1))).mean()
    _, quarter = rfsmooth.compare(clean, clean, normals=turned, truth_normals=clean)
    assert np.isclose(quarter["own_units"]["normal_error"], expected)


def test_normals_that_nothing_is_compared_with_are_refused():
    clean = noisy_sphere(500, 0)
    with pytest.raises(ValueError, match="normals need truth_normals, or faces"):
        rfsmooth.compare(clean, clean, normals=clean)
    with pytest.raises(ValueError, match="signed_normals needs normals"):
        rfsmooth.compare(clean, clean, signed_normals=True)
    with pytest.raises(ValueError, match="truth_normals needs normals"):
        rfsmooth.compare(clean, clean, truth_normals=clean)
    with pytest.raises(ValueError, match="one row for each true point"):
        rfsmooth.compare(clean, clean, normals=clean, truth_normals=clean[1:])
    with pytest.raises(ValueError, match="faces have their own"):
        rfsmooth.compare(clean, *sphere_mesh(), normals=clean, truth_normals=sphere_mesh()[0])


def sphere_mesh():
    made, _ = rfsmooth.mesh(noisy_sphere(2000, 0))
    return made.vertices, made.faces


def test_normals_face_outward_or_the_viewpoint():
    points = noisy_sphere(noise=0)
    made, report = rfsmooth.normals(points)
    assert np.allclose(np.linalg.norm(made, axis=1), 1) and np.mean(np.sum(made * points, axis=1)) > 0.99
    assert report["finite"] == len(points)
    half = points[points[:, 2] > 0.2]
    towards, _ = rfsmooth.normals(half, viewpoint=(0, 0, -5))
    assert np.all(towards[half[:, 2] > 0.9, 2] < 0)


def test_reconstruction_by_the_program(sphere):
    if shutil.which("rfsmooth-reconstruct") is None:
        with pytest.raises(rfsmooth.Error) as caught:
            rfsmooth.reconstruct(sphere)
        assert caught.value.code == "not_installed"
        return
    try:
        made, report = rfsmooth.reconstruct(sphere, method="advancing-front")
    except rfsmooth.Error as error:
        assert error.code == "not_installed" and "built without CGAL" in str(error)
        pytest.skip("built without CGAL")
    assert report["closed_manifold"] and report["genus"] == 0
    assert error_of(made.vertices) < 0.5 * error_of(sphere)
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.reconstruct(sphere, strength=11)
    assert caught.value.code == "usage"
    with pytest.raises(rfsmooth.Error, match="trim has no effect with .*method advancing-front"):
        rfsmooth.reconstruct(sphere, method="advancing-front", trim="3x")
    assert report["options"]["outliers"] == "remove" and "trim" not in report["options"]
    again, _ = rfsmooth.reconstruct(sphere, config=report)
    assert np.array_equal(again.vertices, made.vertices) and np.array_equal(again.faces, made.faces)
    raw, _ = rfsmooth.reconstruct(sphere, config=report, denoise=False)
    assert error_of(raw.vertices) > error_of(made.vertices)


def test_without_the_program_it_says_so(sphere, monkeypatch):
    monkeypatch.setenv("PATH", os.devnull)
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.reconstruct(sphere)
    assert caught.value.code == "not_installed" and "rfsmooth-reconstruct" in str(caught.value)
