#!/usr/bin/env bash
# Installs what is missing, builds the program, plans a scene and draws it.
# usage: tools/run.sh [SCENE.json] [options of `sopt plan`...]
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

scene=$root/tools/scenes/plane_long.json
if (($# > 0)) && [[ $1 != -* ]]; then
  scene=$1
  shift
fi
if (($# == 0)); then set -- --repeat 20; fi  # the first call of a process is cold
[[ -r $scene ]] || fail "cannot read the scene $scene"

install_missing "${packages[@]}"
configure release
build release --target sopt

mkdir -p "$root/build/run"
name=$(basename "$scene" .json)
plan=$root/build/run/$name.plan.json
picture=$root/build/run/$name.svg
say "planning $scene"
status=0
"$root/build/release/tools/sopt" plan "$scene" -o "$plan" --svg "$picture" "$@" || status=$?
if ((status <= 1)); then say "picture: $picture"; fi
exit "$status"
