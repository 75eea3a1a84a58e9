#!/usr/bin/env bash
# Proves that layers.sh accepts a clean tree and refuses each kind of violation.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT

mkdir -p "$tree"/{rt,models/{plane,arm},sampler,opt/{plane,arm,verify},tests} "$tree"/tools/{io,scenes,bench,attic}
touch "$tree"/{rt/clock,models/plane/world2,models/arm/arm,sampler/sampler,tools/scene_file}.h
touch "$tree"/opt/{splits,segmented_optimizer,planner,verify/verify,arm/arm_window}.h
touch "$tree"/tools/{io/text,bench/report}.h
touch "$tree/tests/guard.h"
cat >"$tree/opt/planner.cc" <<'CC'
#include "opt/planner.h"

#include "opt/splits.h"
#include "opt/verify/verify.h"
#include "sampler/sampler.h"
CC
echo '#include "models/plane/world2.h"' >"$tree/opt/splits.cc"
printf '#include "tools/scene_file.h"\n#include "tests/guard.h"\n' >"$tree/tests/all_test.cc"

if ! "$here/layers.sh" "$tree" >"$tree/log"; then
  echo "FAILED: a clean tree is refused"
  cat "$tree/log"
  exit 1
fi

expect_refused() {  # file, include line
  printf '%s\n' "$2" >"$tree/$1"
  if "$here/layers.sh" "$tree" >"$tree/log"; then
    echo "FAILED: accepted $2 in $1"
    exit 1
  fi
  rm "$tree/$1"
}

expect_refused rt/up.h '#include "models/plane/world2.h"'
expect_refused models/room.h '#include "models/arm/arm.h"'
expect_refused models/plane/across.h '#include "models/arm/arm.h"'
expect_refused models/up.h '#  include "sampler/sampler.h"'
expect_refused sampler/across.cc '#include "opt/splits.h"'
expect_refused opt/across.cc '#include "sampler/sampler.h"'
expect_refused opt/room.cc '#include "opt/arm/arm_window.h"'
expect_refused opt/plane/across.cc '#include "opt/arm/arm_window.h"'
expect_refused opt/arm/up.cc '#include "opt/segmented_optimizer.h"'
expect_refused opt/to_verify.cc '#include "opt/verify/verify.h"'
expect_refused opt/verify/to_splits.cc '#include "opt/splits.h"'
expect_refused opt/to_planner.cc '#include "opt/planner.h"'
expect_refused opt/to_tools.cc '#include "tools/scene_file.h"'
expect_refused tools/io/up.cc '#include "tools/bench/report.h"'
expect_refused tools/scenes/across.cc '#include "tools/bench/report.h"'
expect_refused tools/attic/unknown.cc '#include "tools/io/text.h"'
expect_refused tools/to_tests.cc '#include "tests/guard.h"'
expect_refused models/angle.h '#include <sampler/sampler.h>'
expect_refused models/relative.h '#include "../rt/clock.h"'
expect_refused models/short.h '#include "world2.h"'
echo "layers.sh catches planted violations"
