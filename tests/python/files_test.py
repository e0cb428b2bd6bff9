"""Files and structured arrays: everything but the coordinates comes back."""

import numpy as np
import pytest

import rfsmooth
from conftest import SOURCE, error_of

SAMPLES = sorted((SOURCE / "tests" / "pipeline" / "io" / "fixtures").glob("*_*.p[lc][yd]"))


@pytest.mark.parametrize("path", [p for p in SAMPLES if "compressed" not in p.name], ids=lambda path: path.name)
def test_files_of_real_tools_come_back_byte_for_byte(path, tmp_path):
    points, file = rfsmooth.read(path)
    assert len(points) == len(file) > 0
    rfsmooth.write(tmp_path / path.name, points, file)
    assert (tmp_path / path.name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("path", [p for p in SAMPLES if "compressed" in p.name], ids=lambda path: path.name)
def test_compressed_files_come_back_value_for_value(path, tmp_path):
    points, file = rfsmooth.read(path)
    rfsmooth.write(tmp_path / path.name, points, file)
    again, _ = rfsmooth.read(tmp_path / path.name)
    assert again.dtype == points.dtype and again.tobytes() == points.tobytes()


def test_there_are_samples():
    assert len(SAMPLES) > 5 and any("compressed" in path.name for path in SAMPLES)


def test_only_what_changed_changes(tmp_path):
    text = "ply\nformat ascii 1.0\ncomment kept\nelement vertex 3\n"
    text += "".join(f"property {t} {n}\n" for t, n in (("double", "x"), ("double", "y"), ("double", "z"), ("uchar", "red")))
    text += "property list uchar int seen\nend_header\n1.50 2 3 7 2 4 5\n4 5.0 6 8 0\n7 8 9 9 1 1\n"
    (tmp_path / "a.ply").write_text(text)
    points, file = rfsmooth.read(tmp_path / "a.ply")
    assert points.dtype.names == ("x", "y", "z", "red") and file.format == "ply" and file.encoding == "ascii"
    points["x"][1] = 4.25
    rfsmooth.write(tmp_path / "b.ply", points, file)
    assert (tmp_path / "b.ply").read_text() == text.replace("\n4 5.0", "\n4.25 5.0")


def test_coordinates_alone_are_written_into_the_file(tmp_path):
    path = SOURCE / "tests" / "pipeline" / "io" / "fixtures" / "pcl_ascii.pcd"
    points, file = rfsmooth.read(path)
    xyz = file.positions()
    assert np.isnan(xyz).any()
    rfsmooth.write(tmp_path / "same.pcd", xyz, file)
    assert (tmp_path / "same.pcd").read_bytes() == path.read_bytes()
    xyz[0] = [0.5, 0.25, 0.125]
    rfsmooth.write(tmp_path / "moved.pcd", xyz, file)
    moved, again = rfsmooth.read(tmp_path / "moved.pcd")
    assert np.array_equal(again.positions(), xyz, equal_nan=True) and moved.dtype == points.dtype
    with pytest.raises(ValueError, match="the file has"):
        rfsmooth.write(tmp_path / "few.pcd", xyz[1:], file)


def test_coordinates_alone_are_written_into_a_las_file(sphere, tmp_path):
    rfsmooth.write(tmp_path / "fine.las", sphere + [4e5, 5e6, 100])
    rows, file = rfsmooth.read(tmp_path / "fine.las")
    assert rows["x"].dtype.kind == "i" and np.allclose(file.positions(), sphere + [4e5, 5e6, 100], atol=1e-8, rtol=0)
    moved = file.positions() + [0.5, 0.25, -0.125]
    rfsmooth.write(tmp_path / "moved.las", moved, file)
    again, seen = rfsmooth.read(tmp_path / "moved.las")
    assert again.dtype == rows.dtype and np.allclose(seen.positions(), moved, atol=1e-8, rtol=0)
    assert np.array_equal(again["intensity"], rows["intensity"])
    with pytest.warns(UserWarning, match="beyond"):
        rfsmooth.write(tmp_path / "far.las", moved * 1000, file)


def test_a_field_that_is_added_comes_last(sphere, tmp_path):
    rfsmooth.write(tmp_path / "a.ply", sphere)
    points, file = rfsmooth.read(tmp_path / "a.ply")
    wide = np.empty(len(points), points.dtype.descr + [("seen", "u2")])
    for name in points.dtype.names:
        wide[name] = points[name]
    wide["seen"] = np.arange(len(wide))
    rfsmooth.write(tmp_path / "b.ply", wide, file)
    again, _ = rfsmooth.read(tmp_path / "b.ply")
    assert again.dtype == wide.dtype and np.array_equal(again, wide)


def with_column(points, name, values):
    wide = np.empty(len(points), points.dtype.descr + [(name, values.dtype, values.shape[1:])])
    for present in points.dtype.names:
        wide[present] = points[present]
    wide[name] = values
    return wide


def test_what_read_gave_is_written_without_the_file_too(sphere, tmp_path):
    rfsmooth.write(tmp_path / "a.ply", sphere)
    points, _ = rfsmooth.read(tmp_path / "a.ply")
    wide = with_column(points, "pair", np.arange(2 * len(points), dtype="f4").reshape(-1, 2))
    rfsmooth.write(tmp_path / "a.pcd", wide)
    again, _ = rfsmooth.read(tmp_path / "a.pcd")
    assert again.dtype == wide.dtype and np.array_equal(again, wide)
    rfsmooth.write(tmp_path / "b.pcd", again)
    assert np.array_equal(rfsmooth.read(tmp_path / "b.pcd")[0], wide)
    rfsmooth.write(tmp_path / "b.ply", again)
    assert b"property list uchar float pair" in (tmp_path / "b.ply").read_bytes()
    rfsmooth.write(tmp_path / "c.pcd", *rfsmooth.read(tmp_path / "b.ply"))  # lists stay in the file
    assert np.array_equal(rfsmooth.read(tmp_path / "c.pcd")[0], wide)


@pytest.mark.parametrize("kind", ["i8", "u8"])
def test_whole_numbers_of_64_bits_are_refused_in_ply(sphere, tmp_path, kind):
    rfsmooth.write(tmp_path / "a.ply", sphere)
    points, file = rfsmooth.read(tmp_path / "a.ply")
    wide = with_column(points, "stamp", np.arange(len(points)).astype(kind))
    for beside in (None, file):
        with pytest.raises(rfsmooth.Error, match="cannot carry field 'stamp'; drop_unsupported leaves") as caught:
            rfsmooth.write(tmp_path / "b.ply", wide, beside)
        assert caught.value.code == "usage" and not (tmp_path / "b.ply").exists()
        rfsmooth.write(tmp_path / "b.pcd", wide, beside, force=True)
        assert np.array_equal(rfsmooth.read(tmp_path / "b.pcd")[0]["stamp"], wide["stamp"])
    text = "ply\nformat ascii 1.0\nelement vertex 1\n"
    text += "".join(f"property {t} {n}\n" for t, n in (("double", "x"), ("double", "y"), ("double", "z"), ("int64", "stamp")))
    (tmp_path / "c.ply").write_text(text + "end_header\n1 2 3 4\n")
    rfsmooth.write(tmp_path / "d.ply", *rfsmooth.read(tmp_path / "c.ply"))
    assert (tmp_path / "d.ply").read_text() == (tmp_path / "c.ply").read_text()


def test_masked_values_are_refused(sphere, tmp_path):
    masked = np.ma.masked_array(sphere, mask=np.zeros(sphere.shape, bool))
    assert np.array_equal(rfsmooth.denoise(masked)[0], rfsmooth.denoise(sphere)[0])
    masked[3, 1] = np.ma.masked
    array = np.ma.masked_array(structured(sphere), mask=False)
    array["Intensity"][0] = np.ma.masked
    for call in (
        lambda: rfsmooth.denoise(masked),
        lambda: rfsmooth.write(tmp_path / "a.ply", masked),
        lambda: rfsmooth.denoise_structured(array),
        lambda: rfsmooth.denoise(sphere, strength_field=np.ma.masked_less(np.ones(len(sphere)), 2)),
    ):
        with pytest.raises(ValueError, match="masked values"):
            call()


@pytest.mark.parametrize("ending", [".ply", ".pcd", ".xyz", ".csv"])
def test_names_of_several_words_are_written_as_one(sphere, tmp_path, ending):
    """Numpy's names may be anything, as laspy's of extra dimensions are; those of headers may not."""
    wide = np.zeros(len(sphere), [("x", "f8"), ("y", "f8"), ("z", "f8"), ("dist to plane", "f8"), ("a\nb", "f8")])
    for axis, name in enumerate("xyz"):
        wide[name] = sphere[:, axis]
    wide["dist to plane"] = np.arange(len(wide))
    rfsmooth.write(tmp_path / ("a" + ending), wide)
    again, _ = rfsmooth.read(tmp_path / ("a" + ending))
    assert again.dtype.names == ("x", "y", "z", "dist_to_plane", "a_b")
    assert np.array_equal(again["dist_to_plane"], wide["dist to plane"])


def test_existing_files_stay_without_force(sphere, tmp_path):
    rfsmooth.write(tmp_path / "a.xyz", sphere)
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.write(tmp_path / "a.xyz", sphere)
    assert caught.value.code == "cannot_write"
    rfsmooth.write(tmp_path / "a.xyz", sphere[:10], force=True)
    assert len(rfsmooth.read(tmp_path / "a.xyz")[0]) == 10


def test_broken_files_say_where(tmp_path):
    (tmp_path / "a.xyz").write_text("1 2 3\n4 5 6\n7 eight 9\n")
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.read(tmp_path / "a.xyz")
    assert (caught.value.code, caught.value.place) == ("input_unreadable", "line 3")
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.read(tmp_path / "none.ply")
    assert caught.value.code == "input_unreadable" and caught.value.place is None


def structured(sphere, names="XYZ", kind="f8", scale=1):
    """As PDAL gives it: other fields between, behind and of types that no file has."""
    dtype = [(names[0], kind), ("Time", "S7"), (names[1], kind), (names[2], kind), ("Keypoint", "?"), ("Intensity", "u2")]
    array = np.zeros(len(sphere), dtype)
    for axis, name in enumerate(names):
        array[name] = sphere[:, axis] * scale
    array["Time"] = np.arange(len(array)).astype("S7")
    array["Keypoint"] = np.arange(len(array)) % 3 == 0
    array["Intensity"] = np.arange(len(array)) % 65536
    return array


@pytest.mark.parametrize("names", ["XYZ", "xyz"])
def test_structured_arrays_keep_all_other_fields(sphere, names):
    array = structured(sphere, names)
    kept = array.copy()
    out, report = rfsmooth.denoise_structured(array)
    assert np.array_equal(array, kept) and out.dtype == array.dtype
    expected, _ = rfsmooth.denoise(sphere)
    assert np.array_equal(np.stack([out[name] for name in names], axis=1), expected)
    for name in ("Time", "Keypoint", "Intensity"):
        assert np.array_equal(out[name], array[name])
    assert report["counts"]["moved"] > 0


def test_structured_arrays_of_whole_numbers_are_rounded(sphere):
    array = structured(sphere, kind="i4", scale=10000)
    with pytest.warns(UserWarning, match="whole numbers"):
        out, _ = rfsmooth.denoise_structured(array)
    assert out.dtype == array.dtype
    xyz = np.stack([out[name] for name in "XYZ"], axis=1)
    assert error_of(xyz / 10000) < 0.5 * error_of(sphere)


def test_structured_arrays_lose_outliers_and_gain_fields(sphere):
    array = structured(np.vstack([sphere[:9], [[3, 3, 3]], sphere[9:]]))
    out, _ = rfsmooth.denoise_structured(array, outliers="remove", normals=True, write_displacement=True)
    assert len(out) == len(sphere)
    for name in ("Time", "Keypoint", "Intensity"):
        assert np.array_equal(out[name], np.delete(array[name], 9))
    assert out.dtype.names == (*array.dtype.names, "displacement", "nx", "ny", "nz")


def test_structured_arrays_name_their_strengths(sphere):
    array = structured(sphere)
    array["Intensity"] = np.arange(len(array)) % 2
    out, _ = rfsmooth.denoise_structured(array, strength_field="Intensity")
    stayed = np.all([out[name] == array[name] for name in "XYZ"], axis=0)
    assert np.all(stayed[::2]) and np.mean(stayed[1::2]) < 0.1


def test_structured_arrays_need_coordinates():
    with pytest.raises(TypeError, match="no fields X, Y, Z"):
        rfsmooth.denoise_structured(np.zeros(3, [("X", "f8"), ("Y", "f8")]))


def test_info_of_arrays_and_files(sphere, tmp_path):
    rfsmooth.write(tmp_path / "a.ply", sphere)
    of_file, of_array = rfsmooth.info(tmp_path / "a.ply"), rfsmooth.info(sphere)
    assert of_file.pop("path") == str(tmp_path / "a.ply")
    assert of_file == of_array
    assert of_array["points"] == len(sphere) and 0 < of_array["noise"] < of_array["spacing"]
