"""LAS and LAZ files through laspy: python -m rfsmooth, and rfsmooth.las."""

import subprocess
import sys

import numpy as np
import pytest

import rfsmooth
from conftest import error_of

laspy = pytest.importorskip("laspy")
import rfsmooth.las  # noqa: E402


def scan(sphere, path, scale=1e-5, origin=(4e5, 5e6, 100), version="1.4", point_format=6):
    """A scan with everything beside the coordinates."""
    header = laspy.LasHeader(point_format=point_format, version=version)
    header.offsets, header.scales = np.array(origin), np.full(3, scale)
    header.add_extra_dim(laspy.ExtraBytesParams("amplitude", "f4", "of the echo"))
    header.vlrs.append(laspy.VLR("someone", 7, "theirs", b"kept"))
    las = laspy.LasData(header)
    las.xyz = sphere + origin
    las.intensity = np.arange(len(sphere)) % 65536
    las.classification = np.arange(len(sphere)) % 20
    las.gps_time = np.arange(len(sphere)) / 7
    las.amplitude = np.linspace(0, 1, len(sphere)).astype("f4")
    las.write(path)


def command(*arguments):
    return subprocess.run([sys.executable, "-m", "rfsmooth", *map(str, arguments)], capture_output=True, text=True)


@pytest.mark.parametrize("name", ["a.laz", "a.las"])
def test_everything_but_the_coordinates_is_kept(sphere, tmp_path, name):
    source, target = tmp_path / name, tmp_path / f"clean_{name}"
    scan(sphere, source)
    rfsmooth.las.denoise_file(source, target)
    before, after = laspy.read(source), laspy.read(target)
    assert error_of(after.xyz - [4e5, 5e6, 100]) < 0.5 * error_of(sphere)
    for dimension in before.point_format.dimension_names:
        if dimension not in ("X", "Y", "Z"):
            assert np.array_equal(before[dimension], after[dimension]), dimension
    records = [{(v.user_id, v.record_id, v.record_data_bytes()) for v in las.header.vlrs} for las in (before, after)]
    assert records[0] == records[1] and len(records[0]) == 2  # laspy puts extra bytes last
    for what in ("version", "point_format", "system_identifier", "creation_date"):
        assert getattr(before.header, what) == getattr(after.header, what)
    assert np.allclose(after.header.mins, after.xyz.min(axis=0)) and np.allclose(after.header.maxs, after.xyz.max(axis=0))


def test_a_coarse_scale_is_refined_and_what_stays_stays_exact(sphere, tmp_path):
    sphere = np.vstack([sphere, [[3, 3, 3]]])  # an outlier: it does not move
    scan(sphere, tmp_path / "a.laz", scale=0.02)
    report = rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "b.laz")
    before, after = laspy.read(tmp_path / "a.laz"), laspy.read(tmp_path / "b.laz")
    times = before.header.scales / after.header.scales
    assert np.allclose(times, 10) or np.allclose(times, 100)
    assert np.all(after.header.scales <= report["noise_left"] / 2) and "coarser" in report["scale"]
    assert after.X[-1] == before.X[-1] * round(times[0])
    kept = rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "c.laz", keep_scale=True)
    coarse = laspy.read(tmp_path / "c.laz")
    assert "takes back" in kept["scale"] and np.array_equal(coarse.header.scales, before.header.scales)
    assert kept["options"]["keep-scale"] and not report["options"]["keep-scale"]
    again = rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "d.laz", config=kept)
    assert again["scale"] == kept["scale"] and np.array_equal(laspy.read(tmp_path / "d.laz").X, coarse.X)
    rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "d.laz", config=kept, keep_scale=False, force=True)
    assert np.array_equal(laspy.read(tmp_path / "d.laz").X, after.X)
    moved = np.asarray(after.xyz)[:-1] - [4e5, 5e6, 100]
    assert kept["noise_left"] > report["noise_left"]
    assert error_of(moved) < error_of(np.asarray(coarse.xyz)[:-1] - [4e5, 5e6, 100])


def test_python_m_rfsmooth(sphere, tmp_path):
    scan(sphere, tmp_path / "a.laz", scale=0.02)
    ran = command("denoise", "--strength", "0.5", "--keep-scale", tmp_path / "a.laz", tmp_path / "b.laz")
    assert ran.returncode == 0 and ran.stdout == "" and "noise" in ran.stderr, ran.stderr
    rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "c.laz", strength=0.5, keep_scale=True)
    assert np.array_equal(laspy.read(tmp_path / "b.laz").xyz, laspy.read(tmp_path / "c.laz").xyz)
    again = command("denoise", tmp_path / "a.laz", tmp_path / "b.laz")
    assert again.returncode == 5 and "exists" in again.stderr
    assert command("denoise", "--force", "-q", tmp_path / "a.laz", tmp_path / "b.laz").stderr == ""
    assert command("denoise", tmp_path / "none.laz", tmp_path / "d.laz").returncode == 3
    (tmp_path / "broken.laz").write_bytes((tmp_path / "a.laz").read_bytes()[:300])
    assert command("denoise", tmp_path / "broken.laz", tmp_path / "d.laz").returncode == 3
    assert command("denoise", "--strenth", "1", tmp_path / "a.laz", tmp_path / "d.laz").returncode == 2
    assert not (tmp_path / "d.laz").exists()


def test_outliers_are_removed_with_their_record(sphere, tmp_path):
    scan(np.vstack([[[3, 3, 3]], sphere]), tmp_path / "a.laz")
    report = rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "b.laz", outliers="remove")
    after = laspy.read(tmp_path / "b.laz")
    assert len(after) == len(sphere) and np.array_equal(after.intensity, (np.arange(len(sphere)) + 1) % 65536)
    assert report["options"]["outliers"] == "remove"
    assert report["counts"]["removed"] == report["counts"]["outliers"] == 1
    rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "c.laz", config=report)
    assert np.array_equal(laspy.read(tmp_path / "c.laz").xyz, after.xyz)


@pytest.mark.parametrize("names", [("a.las", "b.laz"), ("a.laz", "b.las")])
def test_las_becomes_laz_and_back(sphere, tmp_path, names):
    source, target = (tmp_path / name for name in names)
    scan(sphere, source)
    ran = command("denoise", source, target)
    assert ran.returncode == 0, ran.stderr
    assert (target.read_bytes()[104] & 128 != 0) == (target.suffix == ".laz")  # LAZ marks the point format so
    after = laspy.read(target)
    assert error_of(after.xyz - [4e5, 5e6, 100]) < 0.5 * error_of(sphere)
    assert np.array_equal(after.intensity, laspy.read(source).intensity)
    assert command("denoise", tmp_path / "none.laz", tmp_path / "c.ply").returncode == 2


def test_indexes_that_no_longer_hold_are_said(sphere, tmp_path):
    scan(sphere, tmp_path / "a.laz")
    assert rfsmooth.las.denoise_file(tmp_path / "a.laz", tmp_path / "b.laz")["index"] is None
    las = laspy.read(tmp_path / "a.laz")
    las.vlrs.append(laspy.VLR("copc", 1, "info", bytes(160)))
    las.write(tmp_path / "copc.laz")
    ran = command("denoise", tmp_path / "copc.laz", tmp_path / "c.laz")
    assert ran.returncode == 0 and "COPC is left out" in ran.stderr, ran.stderr
    assert "copc" not in {record.user_id for record in laspy.read(tmp_path / "c.laz").vlrs}
    (tmp_path / "c.lax").write_bytes(b"LASX")
    ran = command("denoise", "--force", tmp_path / "a.laz", tmp_path / "c.laz")
    assert ran.returncode == 0 and "c.lax is an index of other points" in ran.stderr, ran.stderr


def test_records_behind_the_points_stay_but_those_of_copc(sphere, tmp_path):
    for name in ("a.las", "a.laz"):
        scan(sphere, tmp_path / name)
        las = laspy.read(tmp_path / name)
        las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("someone", 8, "theirs", b"behind"), laspy.VLR("copc", 1000, "", b"x")])
        las.write(tmp_path / name)
        assert len(laspy.read(tmp_path / name).evlrs) == 2
        report = rfsmooth.las.denoise_file(tmp_path / name, tmp_path / f"clean_{name}")
        assert "COPC" in report["index"]
        (left,) = laspy.read(tmp_path / f"clean_{name}").evlrs
        assert (left.user_id, left.record_id, left.record_data_bytes()) == ("someone", 8, b"behind")


def test_a_file_that_cannot_be_written_is_refused_before_the_work(sphere, tmp_path):
    (tmp_path / "broken.laz").write_bytes(b"no scan")
    (tmp_path / "folder.laz").mkdir()
    for target, says in (("none/b.laz", "none' is not there"), ("folder.laz", "is a folder")):
        ran = command("denoise", "--force", tmp_path / "broken.laz", tmp_path / target)
        assert ran.returncode == 5 and says in ran.stderr, ran.stderr


def test_without_laspy_it_says_what_to_install(sphere, tmp_path):
    scan(sphere, tmp_path / "a.laz")
    hidden = "import sys; sys.modules['laspy'] = None; sys.argv = ['rfsmooth', 'denoise', sys.argv[1], sys.argv[2]];"
    hidden += "from rfsmooth.__main__ import main; main()"
    ran = subprocess.run(
        [sys.executable, "-c", hidden, str(tmp_path / "a.laz"), str(tmp_path / "b.laz")], capture_output=True, text=True
    )
    assert ran.returncode == 127 and "pip install 'rfsmooth[laz]'" in ran.stderr


def test_other_files_go_to_the_command(sphere, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rfsmooth.write("a.ply", sphere)
    ran = command("denoise", "a.ply", "b.ply")
    assert ran.returncode == 0 and "noise" in ran.stderr
    assert np.array_equal(rfsmooth.read("b.ply")[1].positions(), rfsmooth.denoise(sphere)[0])
    assert command("--version").stdout == f"rfsmooth {rfsmooth.__version__}\n"
    assert command("denoise").returncode == 2


def test_coordinates_are_written_into_a_coarse_file_in_steps_as_fine_as_asked_for(sphere, tmp_path):
    scan(sphere, tmp_path / "a.las", scale=0.02)
    rows, file = rfsmooth.read(tmp_path / "a.las")
    clean, _ = rfsmooth.denoise(file.positions())
    for name, scale, steps in (("kept.las", None, 0.02), ("finer.las", 0.003, 0.002)):
        rfsmooth.write(tmp_path / name, clean, file, scale=scale)
        after = laspy.read(tmp_path / name)
        assert np.allclose(after.header.scales, steps) and np.array_equal(after.intensity, rows["intensity"])
        assert np.abs(after.xyz - clean).max() <= steps * 0.5001
