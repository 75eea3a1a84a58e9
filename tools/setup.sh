# Sourced by run.sh and test.sh: installs what is missing and configures builds.
# shellcheck shell=bash disable=SC2034,SC2191  # arrays are for the sourcing script; = is literal
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# What is needed, as Debian package = command, or file below an include directory.
packages=(
  g++=g++
  cmake=cmake
  ninja-build=ninja
  pkg-config=pkg-config
  libeigen3-dev=eigen3/Eigen/Core
  libccd-dev=ccd/ccd.h
  liburdfdom-dev=urdf_parser/urdf_parser.h
  libcli11-dev=CLI/CLI.hpp
  nlohmann-json3-dev=nlohmann/json.hpp
  libgtest-dev=gtest/gtest.h
  libbenchmark-dev=benchmark/benchmark.h
)
full_test_packages=(
  clang=clang++
  clang-tidy=clang-tidy
  clang-format-14=clang-format-14
  chromium=chromium
)

say() { printf '== %s\n' "$*"; }
fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

is_present() {  # command or header
  command -v "$1" >/dev/null || [[ -e /usr/include/$1 || -e /usr/local/include/$1 ]]
}

install_missing() {  # package=probe...
  local item missing=() as_root=()
  for item in "$@"; do
    if ! is_present "${item#*=}"; then missing+=("${item%%=*}"); fi
  done
  if ((${#missing[@]} == 0)); then return; fi
  if ! command -v apt-get >/dev/null; then
    fail "missing: ${missing[*]} (Debian package names), and there is no apt-get to install them"
  fi
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      fail "run as root, or install sudo, then: apt-get install ${missing[*]}"
    fi
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  as_root+=(env DEBIAN_FRONTEND=noninteractive)
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" apt-get install -qq --no-install-recommends "${missing[@]}" >/dev/null
}

configure() {  # preset, options of cmake...
  say "configuring $1"
  cmake -S "$root" --preset "$1" "${@:2}" >"$root/build/configure_$1.log" 2>&1 || {
    cat "$root/build/configure_$1.log" >&2
    fail "configuring $1 failed"
  }
}

build() {  # preset, options of cmake --build...
  say "building $1"
  cmake --build "$root/build/$1" "${@:2}"
}

mkdir -p "$root/build"
