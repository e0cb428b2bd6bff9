"""rfsmooth.denoise as its users call it."""

import inspect
import json

import numpy as np
import pytest

import rfsmooth
from conftest import SOURCE, error_of, noisy_sphere


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_takes_the_noise_and_leaves_what_it_was_given(sphere, dtype):
    given = sphere.astype(dtype)
    kept = given.copy()
    clean, report = rfsmooth.denoise(given)
    assert clean.dtype == dtype and clean.shape == given.shape
    assert np.array_equal(given, kept)
    assert error_of(clean) < 0.5 * error_of(given)
    assert report["counts"]["points"] == len(given)
    assert report["rfsmooth"] == rfsmooth.__version__


@pytest.mark.parametrize(
    "awkward",
    [
        lambda a: np.asfortranarray(a),
        lambda a: np.concatenate([a, a], axis=1)[:, :3],
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: a[::-1][::-1],
        lambda a: a.astype(">f8"),
        lambda a: a.tolist(),
    ],
    ids=["fortran", "columns of a wider array", "every second row", "turned twice", "big-endian", "lists"],
)
def test_any_layout_gives_the_same(sphere, awkward):
    expected, _ = rfsmooth.denoise(sphere)
    assert np.array_equal(rfsmooth.denoise(awkward(sphere))[0], expected)


def test_read_only_arrays_are_taken(sphere):
    sphere.setflags(write=False)
    clean, _ = rfsmooth.denoise(sphere)
    assert clean.flags.writeable


def test_rows_that_are_not_finite_stay(sphere):
    sphere[7, 1], sphere[100] = np.nan, np.inf
    clean, report = rfsmooth.denoise(sphere)
    assert np.array_equal(clean[[7, 100]], sphere[[7, 100]], equal_nan=True)
    assert report["counts"]["finite"] == len(sphere) - 2


@pytest.mark.parametrize("name, options", [
    ("defaults", {}),
    ("options", {"flow": "taubin", "iterations": 3, "mu": 0.7, "swap": False}),
    ("lambda", {"flow": "laplacian", "lambda_": 0.25, "push_back": True}),
    ("noise", {"noise": "0.4x", "strength": 1.5, "outliers": "smooth"}),
    ("direction", {"flow": "directional", "direction": (1, 2, 0.5)}),
])  # fmt: skip
def test_coordinates_are_the_commands_bit_for_bit(sphere, command, tmp_path, name, options):
    rfsmooth.write(tmp_path / "in.ply", sphere)
    typed = []
    for key, value in options.items():
        key = key.rstrip("_").replace("_", "-")
        if isinstance(value, bool):
            typed.append(f"--{key}" if value else f"--no-{key}")
        elif isinstance(value, tuple):
            typed.append(f"--{key}=" + ",".join(map(str, value)))
        else:
            typed.append(f"--{key}={value}")
    command("denoise", *typed, "--report", "r.json", "in.ply", "out.ply")
    expected = rfsmooth.read(tmp_path / "out.ply")[1].positions()
    clean, report = rfsmooth.denoise(sphere, **options)
    assert np.array_equal(clean.view(np.uint64), expected.view(np.uint64)) and not np.array_equal(clean, sphere)
    # And the report says the same, but for times, files and what is of files only.
    theirs = json.loads((tmp_path / "r.json").read_text())
    for gone in ("input", "output", "seconds"):
        theirs.pop(gone)
    for option in ("format", "encoding", "drop-unsupported"):
        theirs["options"].pop(option)
        report["options"].pop(option)
    assert {key: report[key] for key in theirs} == theirs


def test_the_report_does_it_again(sphere):
    clean, report = rfsmooth.denoise(sphere, flow="hc", beta=0.55)
    assert np.array_equal(rfsmooth.denoise(sphere, config=report)[0], clean)
    other, _ = rfsmooth.denoise(sphere, config=report, beta=0.7)
    assert not np.array_equal(other, clean)


def test_a_report_of_the_command_does_it_again(sphere, command, tmp_path, monkeypatch):
    """Also where the whole cloud's statistics came from a file."""
    monkeypatch.chdir(tmp_path)
    rfsmooth.write("in.ply", sphere)
    command("tiles", "plan", "--tile-points", "1000", "in.ply", "job")
    tiles = json.loads(command("tiles", "status", "--json", "job").stdout)["tiles"]
    command("tiles", "measure", "job", *range(tiles))
    command("tiles", "settle", "job")
    command("denoise", "--statistics", "job/statistics.json", "--report", "r.json", "in.ply", "out.ply")
    clean, report = rfsmooth.denoise(sphere, config="r.json")
    assert report["options"]["statistics"] == "job/statistics.json"
    assert np.array_equal(clean, rfsmooth.read("out.ply")[1].positions())
    assert np.array_equal(rfsmooth.denoise(sphere, statistics=None)[0], rfsmooth.denoise(sphere)[0])


def test_one_thread_gives_the_same_bytes(sphere):
    assert np.array_equal(rfsmooth.denoise(sphere, threads=1)[0], rfsmooth.denoise(sphere, threads=2)[0])


def test_fields_that_were_asked_for(sphere):
    sphere = np.vstack([sphere, [[3, 3, 3]]])
    clean, report = rfsmooth.denoise(sphere, normals=True, write_displacement=True, outliers="mark")
    fields = report["fields"]
    assert set(fields) == {"normals", "displacement", "outlier"}
    assert np.allclose(fields["displacement"], np.linalg.norm(clean - sphere, axis=1), atol=1e-6)
    assert fields["outlier"].dtype == bool and fields["outlier"].nonzero()[0].tolist() == [len(sphere) - 1]
    inside = ~fields["outlier"]
    assert np.mean(np.sum(fields["normals"] * clean, axis=1)[inside] > 0.9) > 0.99


def test_outliers_are_removed(sphere):
    with_stray = np.vstack([sphere[:50], [[3, 3, 3]], sphere[50:]])
    clean, report = rfsmooth.denoise(with_stray, outliers="remove")
    marked, _ = rfsmooth.denoise(with_stray)
    assert report["counts"]["removed"] == 1
    assert np.array_equal(clean, np.delete(marked, 50, axis=0))


def test_strengths_by_array(sphere):
    strength = (sphere[:, 2] > 0).astype(float)
    clean, _ = rfsmooth.denoise(sphere, strength_field=strength)
    stayed = np.all(clean == sphere, axis=1)
    assert np.all(stayed[strength == 0]) and np.mean(stayed[strength == 1]) < 0.1
    with pytest.raises(ValueError, match="one value for each"):
        rfsmooth.denoise(sphere, strength_field=strength[1:])


def test_large_coordinates_in_float32_are_warned_of(sphere):
    with pytest.warns(UserWarning, match="float32"):
        rfsmooth.denoise((sphere + [4e5, 5e6, 100]).astype(np.float32))


def test_mistakes_are_errors_that_say_what(sphere):
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.denoise(sphere, strength=20)
    assert caught.value.code == "usage" and str(caught.value) == "strength is 20; it must be between 0 and 10"
    with pytest.raises(rfsmooth.Error, match="lambda has no meaning for the flow 'auto'"):
        rfsmooth.denoise(sphere, lambda_=0.5)
    with pytest.raises(rfsmooth.Error, match="did you mean 'taubin'"):
        rfsmooth.denoise(sphere, flow="taubn")
    with pytest.raises(TypeError, match="did you mean 'strength'"):
        rfsmooth.denoise(sphere, strenght=1)
    with pytest.raises(ValueError, match="n x 3"):
        rfsmooth.denoise(sphere[:, :2])
    with pytest.raises(TypeError, match="complex"):
        rfsmooth.denoise(sphere.astype(complex))
    with pytest.raises(rfsmooth.Error) as caught:
        rfsmooth.denoise(np.full((5, 3), np.nan))
    assert caught.value.code == "no_usable_points"


def test_signature_and_help_name_every_option_of_the_command(command):
    shown = command("denoise", "--help-all").stdout
    parameters = inspect.signature(rfsmooth.denoise).parameters
    for name, parameter in parameters.items():
        if name in ("points", "threads", "progress", "config"):
            continue
        assert "--" + name.rstrip("_").replace("_", "-") in shown
        assert f"    {name}: " in rfsmooth.denoise.__doc__
        assert parameter.kind == inspect.Parameter.KEYWORD_ONLY
    first = {"noise": None, "strength": 1.0, "flow": "auto", "outliers": "keep", "normals": False, "threads": 0}
    assert {name: parameters[name].default for name in first} == first
    names_there = {line.split()[0].rstrip(",") for line in shown.splitlines() if line.strip().startswith("--")}
    of_files = {"output", "format", "encoding", "force", "drop-unsupported", "report", "html", "trace", "quiet", "verbose", "help", "help-all"}
    for name in names_there:
        plain = name[2:].removeprefix("no-").split("=")[0].split("[")[0]
        if plain not in of_files:
            assert {plain.replace("-", "_"), plain.replace("-", "_") + "_"} & set(parameters), name


def test_the_default_of_every_option_can_be_given(sphere):
    """Of the options of the automatic flow, at least: what the signature shows is what is meant."""
    expected, _ = rfsmooth.denoise(sphere)
    assert np.array_equal(rfsmooth.denoise(sphere, strength=1.0, noise=None, equalize=True, flow="auto")[0], expected)


def test_real_scan():
    table, _ = rfsmooth.read(SOURCE / "clouds" / "scans" / "rgbd_box.pcd")
    points = np.stack([table["x"], table["y"], table["z"]], axis=1)
    clean, report = rfsmooth.denoise(points)
    assert report["counts"]["moved"] > 0.5 * np.isfinite(points).all(axis=1).sum()
    assert clean.dtype == np.float32


def test_true_is_no_number(sphere):
    with pytest.raises(rfsmooth.Error, match="iterations") as caught:
        rfsmooth.denoise(sphere, flow="hc", iterations=True)
    assert caught.value.code == "usage"
    with pytest.raises(TypeError, match="threads"):
        rfsmooth.denoise(sphere, threads=True)
