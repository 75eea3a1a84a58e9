#!/usr/bin/env bash
# Dependencies between folders go one way:
#   rt -> alloc -> models -> {sampler, opt/qp -> opt, opt/verify} -> opt/planner -> tools -> tests
# in models: {plane, space} -> arm, what lies above the rooms is used by all;
# in opt: likewise, then {plane, arm} -> segmented_optimizer;
# and in tools: io -> {cli -> qp, scenes} -> bench -> {tables, peers} -> main and the commands.
# Every #include "..." names a file by its path from the project's root, and that file may be used
# from the including file's layer. Prints each violation; exit code 1 when there is one.
# usage: layers.sh [ROOT]
set -euo pipefail
root=${1:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)}
cd "$root"

layer_of() {
  case $1 in
    models/*/*) echo "$(cut -d/ -f1,2 <<<"$1")" ;;
    opt/qp/*) echo qp ;;
    opt/verify/*) echo verify ;;
    opt/plane/*|opt/arm/*) echo "$(cut -d/ -f1,2 <<<"$1")" ;;
    opt/segmented_optimizer.*) echo sweeps ;;
    opt/planner.*) echo planner ;;
    tools/*/*) echo "$(cut -d/ -f1,2 <<<"$1")" ;;
    *) echo "${1%%/*}" ;;
  esac
}

models="rt alloc models models/plane models/space models/arm"
windows="qp opt opt/plane opt/arm sweeps"
libraries="$models sampler $windows verify planner"
tool_rooms="tools/io tools/cli tools/qp tools/scenes tools/bench tools/tables tools/peers"
declare -A may_use=(
  [rt]="rt"
  [alloc]="rt alloc"
  [models]="rt alloc models"
  [models/plane]="rt alloc models models/plane"
  [models/space]="rt alloc models models/space"
  [models/arm]="rt alloc models models/space models/arm"
  [sampler]="$models sampler"
  [qp]="$models qp"
  [opt]="$models qp opt"
  [opt/plane]="$models qp opt opt/plane"
  [opt/arm]="$models qp opt opt/arm"
  [sweeps]="$models $windows"
  [verify]="$models verify"
  [planner]="$models sampler $windows verify planner"
  [tools/io]="$libraries tools/io"
  [tools/cli]="$libraries tools/io tools/cli"
  [tools/qp]="$libraries tools/io tools/cli tools/qp"
  [tools/scenes]="$libraries tools/io tools/scenes"
  [tools/bench]="$libraries tools/io tools/cli tools/qp tools/scenes tools/bench"
  [tools/tables]="$libraries tools/io tools/cli tools/qp tools/scenes tools/bench tools/tables"
  [tools/peers]="$libraries tools/io tools/cli tools/qp tools/scenes tools/bench tools/peers"
  [tools]="$libraries $tool_rooms tools"
  [tests]="$libraries $tool_rooms tools tests"
)

folders=()
for folder in rt alloc models sampler opt tools tests; do
  if [[ -d $folder ]]; then folders+=("$folder"); fi
done

num_violations=0
num_includes=0
violation() {
  echo "$1"
  num_violations=$((num_violations + 1))
}

# tests/install is a project of its own that includes the installed headers.
while IFS=: read -r file line text; do
  num_includes=$((num_includes + 1))
  header=$(sed -E 's/^[^"]*"([^"]*)".*/\1/' <<<"$text")
  from=$(layer_of "$file")
  to=$(layer_of "$header")
  if [[ ! -f $header ]]; then
    violation "$file:$line: \"$header\" is not a path from the project's root"
  elif [[ " ${may_use[$from]-} " != *" $to "* ]]; then
    violation "$file:$line: $from must not include \"$header\" ($to)"
  fi
done < <(grep -rnE --include='*.h' --include='*.cc' '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' \
  "${folders[@]}" | grep -v '^tests/install/')

# <rt/clock.h> would pass unseen above.
while IFS= read -r hit; do
  violation "$hit: a header of this project is included with \"\", not <>"
done < <(grep -rnE --include='*.h' --include='*.cc' \
  '^[[:space:]]*#[[:space:]]*include[[:space:]]*<(rt|alloc|models|sampler|opt|tools|tests)/' "${folders[@]}")

if ((num_includes == 0)); then
  violation "no include found under $root: nothing was checked"
fi
echo "$num_includes includes checked, $num_violations violations"
((num_violations == 0))
