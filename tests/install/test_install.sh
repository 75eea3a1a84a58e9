#!/usr/bin/env bash
# Installs a build into a scratch prefix and uses it from there, as a stranger would: through
# find_package, through pkg-config, and by running the program.
# usage: test_install.sh BUILD_DIR SCRATCH_DIR CXX CMAKE_GENERATOR
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build_dir=$1
scratch=$2
cxx=$3
generator=$4
prefix=$scratch/prefix

rm -rf "$scratch"
mkdir -p "$scratch"
cmake --install "$build_dir" --prefix "$prefix" >"$scratch/install.log"

echo "--- find_package"
cmake -G "$generator" -S "$here" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_COMPILER="$cxx" >"$scratch/configure.log"
cmake --build "$scratch/build"
"$scratch/build/downstream"

echo "--- pkg-config"
pc_file=$(find "$prefix" -name sopt.pc)
flags=$(PKG_CONFIG_PATH=$(dirname "$pc_file") pkg-config --cflags --libs sopt)
# Word splitting is what flags are for.
# shellcheck disable=SC2086
"$cxx" -std=c++20 "$here/main.cc" $flags -o "$scratch/downstream_pkg_config"
"$scratch/downstream_pkg_config"

echo "--- README example"
awk '/^```cpp$/ {inside = 1; next} /^```$/ {inside = 0} inside' "$here/../../README.md" \
  >"$scratch/readme_example.cc"
# shellcheck disable=SC2086
"$cxx" -std=c++20 "$scratch/readme_example.cc" $flags -o "$scratch/readme_example"
[[ $("$scratch/readme_example" | tail -n 1) == "19 1" ]]

echo "--- program"
"$prefix/bin/sopt" --help >/dev/null
echo "installed tree is usable"
