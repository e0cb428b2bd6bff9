#!/usr/bin/env bash
# Builds the Debian packages and installs each in a clean system of its own, made by mmdebstrap from this machine's apt
# sources: does it pull in what it needs, does the command run, do examples build against the -dev packages?
# bash tests/packages_test.sh [PACKAGE...]   (all by default; takes minutes and the network, so ctest does not run it)
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/packages.sh
install_missing $core_packages libpcl-dev libcgal-dev libopen3d-dev dpkg-dev mmdebstrap python3-dev python3-venv
install_python

cmake --preset package > /dev/null
cmake --build --preset package
debs=build/package/packages
rm -rf "$debs"
(cd build/package && cpack > /dev/null)
if command -v lintian > /dev/null; then lintian --fail-on error,warning --allow-root "$debs"/*.deb; fi

# Debian's own sources as this machine has them, and the proxy it reaches them through.
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
sources=()
for list in /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources; do
  if [ -s "$list" ]; then sources+=("$list"); fi
done
apt=()
for scheme in http https; do
  proxy=$(apt-config dump --format '%v' "Acquire::$scheme::Proxy")
  if [ -n "$proxy" ]; then apt+=("--aptopt=Acquire::$scheme::Proxy \"$proxy\""); fi
done

# in_clean_system PACKAGE INCLUDED SCRIPT: installs PACKAGE and then what a person building with it brings along.
in_clean_system() {
  echo "== $1 in a clean system"
  local log=build/package/$1.log
  mmdebstrap --quiet --variant=apt --format=null "${apt[@]}" \
    --customize-hook="mkdir -p \"\$1/tmp/debs\" \"\$1/tmp/tests/consumer\" \"\$1/tmp/examples\"" \
    --customize-hook="copy-in clouds/sphere_scan.ply /tmp" \
    --customize-hook="sync-in $debs /tmp/debs" \
    --customize-hook="sync-in examples /tmp/examples" \
    --customize-hook="sync-in tests/consumer /tmp/tests/consumer" \
    --customize-hook="chroot \"\$1\" sh -ec 'cd /tmp/debs; apt-get install -y --no-install-recommends $2 > /dev/null'" \
    --customize-hook="chroot \"\$1\" bash -euc '$3'" \
    "$release" /dev/null "${sources[@]}" > "$log" 2>&1 || { tail -n 40 "$log"; echo "$1: failed ($log)"; exit 1; }
  grep '^said: ' "$log" || true
}

# deb NAME...: their files, as apt wants to see them.
deb() {
  for name in "$@"; do (cd "$debs" && printf '%s ' "./$name"_*.deb); done
}

# consumer WAY: what runs in the clean system to build and run the example.
consumer() {
  echo "apt-get install -y --no-install-recommends g++ cmake ninja-build pkg-config > /dev/null
        for way in $*; do echo \"said: \$way: \$(bash /tmp/tests/consumer/run.sh /tmp /tmp/work \$way)\"; done"
}

wanted() { [ ${#chosen[@]} -eq 0 ] || [[ " ${chosen[*]} " == *" $1 "* ]]; }
chosen=("$@")
if wanted rfsmooth; then
  in_clean_system rfsmooth "$(deb rfsmooth)" '
    echo "said: $(rfsmooth --version)"
    rfsmooth denoise --report /tmp/report.json /tmp/sphere_scan.ply /tmp/clean.ply
    test "$(head -c 3 /tmp/clean.ply)" = ply
    ! cmp -s /tmp/sphere_scan.ply /tmp/clean.ply
    bash -n /usr/share/bash-completion/completions/rfsmooth
    gzip -t /usr/share/man/man1/rfsmooth*.1.gz
    test -s /usr/share/zsh/vendor-completions/_rfsmooth'
fi
if wanted librfsmooth-dev; then in_clean_system librfsmooth-dev "$(deb librfsmooth-dev)" "$(consumer installed pkgconfig)"; fi
for part in pcl open3d cgal; do
  package=librfsmooth-$part-dev
  if wanted $package; then in_clean_system $package "$(deb librfsmooth-dev $package)" "$(consumer $part)"; fi
done
if wanted python3-rfsmooth; then
  in_clean_system python3-rfsmooth "$(deb python3-rfsmooth)" '
    cd /tmp
    python3 -c "
import numpy, rfsmooth
points, file = rfsmooth.read(\"sphere_scan.ply\")
clean, report = rfsmooth.denoise_structured(points)
rfsmooth.write(\"clean.ply\", clean, file)
print(\"said:\", rfsmooth.__version__, report[\"counts\"][\"moved\"], \"points moved\")"'
fi
if wanted rfsmooth-reconstruct; then
  in_clean_system rfsmooth-reconstruct "$(deb rfsmooth rfsmooth-reconstruct)" '
    rfsmooth reconstruct --method advancing-front --force /tmp/sphere_scan.ply /tmp/surface.ply
    echo "said: $(grep -a -m 1 "^element face" /tmp/surface.ply)"'
fi
echo "packages: clean"
