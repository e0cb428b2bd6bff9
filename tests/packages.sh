# Sourced by tests/run.sh and clouds/demo.sh: what is needed from Debian's packages, and how to get what is missing.
core_packages="g++ cmake ninja-build ccache libeigen3-dev libtbb-dev libfmt-dev nlohmann-json3-dev libcli11-dev zlib1g-dev libpng-dev"
test_packages="libgtest-dev libgmock-dev libbenchmark-dev clang-14 clang-format-14 clang-tidy-14 libclang-rt-14-dev libpcl-dev libcgal-dev libopen3d-dev libcgal-demo pkg-config doxygen libflann-dev liblz4-dev libnanoflann-dev zsh groff-base python3 python3-dev python3-venv python3-numpy python3-open3d python3-pytest chromium chromium-driver python3-distributed slurm-wlm munge"

# install_missing PACKAGE...: installs those that are not there; says so and fails where that is not allowed.
install_missing() {
  local missing=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "installing: ${missing[*]}"
  local sudo=""
  [ "$(id -u)" -eq 0 ] || sudo="sudo"
  $sudo apt-get update -qq
  DEBIAN_FRONTEND=noninteractive $sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
}

# install_python: the virtual environment build/venv, with what the Python module is built with and tested beside.
install_python() {
  local list=tests/python/requirements.txt
  cmp -s "$list" build/venv/made_for && return 0
  echo "making build/venv"
  rm -rf build/venv
  /usr/bin/python3 -m venv build/venv
  build/venv/bin/pip install -q --disable-pip-version-check -r "$list"
  cp "$list" build/venv/made_for
}
