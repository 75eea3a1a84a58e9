#!/usr/bin/env bash
# Installs OMPL and what else is missing, builds sopt_peers and runs it.
# usage: tools/peers.sh [SCENE...] [options of sopt_peers, see --help]
# Without arguments: the shipped scenes of the plane; of arms: tools/peers.sh tools/scenes/arm/arm_8_*
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_missing "${packages[@]}" libompl-dev=ompl-1.5/ompl/config.h
configure release
build release --target sopt_peers
if (($# == 0)); then set -- "$root/tools/scenes/plane"; fi
exec "$root/build/release/tools/peers/sopt_peers" "$@"
