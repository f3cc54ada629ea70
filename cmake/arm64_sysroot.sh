#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What Firn needs of Debian 12 for 64-bit Arm, unpacked into one folder for the preset `arm64`.
# Needs no root; the host's own packages are neither asked nor touched.
#   cmake/arm64_sysroot.sh [FOLDER]     build/arm64-sysroot by default
set -euo pipefail
root=$(realpath -m "${1:-$(dirname "$0")/../build/arm64-sysroot}")
mirror=${FIRN_DEBIAN_MIRROR:-http://deb.debian.org/debian}
keys=/usr/share/keyrings/debian-archive-keyring.gpg
packages=(libc6-dev libstdc++-12-dev libeigen3-dev libgsl-dev libhdf5-dev libhwy-dev libtomlplusplus-dev libcli11-dev
  libfmt-dev libspdlog-dev nlohmann-json3-dev libgtest-dev libgmock-dev libbenchmark-dev)

# An apt of its own: own lists, own cache, nothing installed so far.
apt=$root.apt
mkdir -p "$root" "$apt"/{state/lists/partial,cache/archives/partial}
: >"$apt/status"
echo "deb [arch=arm64 signed-by=$keys] $mirror bookworm main" >"$apt/sources.list"
private_apt() {
  apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Install-Recommends=false \
    -o APT::Sandbox::User=root -o Debug::NoLocking=1 \
    -o Dir::State="$apt/state" -o Dir::State::status="$apt/status" -o Dir::Cache="$apt/cache" \
    -o Dir::Etc::SourceList="$apt/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::Etc::PreferencesParts=/dev/null "$@"
}
private_apt update
private_apt install --yes --download-only -o Dir::Cache::archives="$apt/cache/archives" "${packages[@]}"

# Debian 12 keeps everything below /usr; packages still write to /lib, through this link.
mkdir -p "$root/usr/lib"
[ -e "$root/lib" ] || ln -s usr/lib "$root/lib"
for package in "$apt"/cache/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" |
    tar --extract --directory "$root" --keep-directory-symlink --exclude=./usr/share/doc --exclude=./usr/share/man
done
# Links to /lib/… would leave the folder.
find "$root" -type l -lname '/*' | while read -r link; do
  ln -sfn "$(realpath -m --relative-to "$(dirname "$link")" "$root$(readlink "$link")")" "$link"
done
echo "$root"
