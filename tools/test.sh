#!/usr/bin/env bash
# Installs what is missing, builds everything and runs the tests.
# usage: tools/test.sh [--full]     --full: also sanitizers, clang-tidy, format and the long tests
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

full=false
case "$*" in
  "") ;;
  --full) full=true ;;
  *) fail "usage: tools/test.sh [--full]" ;;
esac

run_tests() {  # test preset
  say "testing $1"
  (cd "$root" && ctest --preset "$1" --parallel "$(nproc)")
}

install_missing "${packages[@]}"
if $full; then install_missing "${full_test_packages[@]}"; fi

configure release
build release
run_tests release

if $full; then
  for preset in asan tsan; do
    configure "$preset"
    build "$preset"
    run_tests "$preset"
  done
  configure tidy
  build tidy
  run_tests long
fi
