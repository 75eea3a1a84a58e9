#!/usr/bin/env bash
# Real-time libraries must not be able to reach the heap, exceptions, locks or stdio: fails when one
# of the given static libraries refers to such a symbol. For Release builds; with assertions on,
# Eigen and assert() refer to more.
# usage: symbols.sh LIBRARY.a...
set -euo pipefail

# Mangled: _Zn. and _Zd. are operator new and delete (nw, na, dl, da), _ZSt..__throw_ are the
# standard library's throw helpers.
forbidden='^(_Zn[wa].*|_Zd[la].*|_ZSt[0-9]+__throw_.*|__cxa_.*|_Unwind_.*|__gxx_personality_v0'
forbidden+='|malloc|calloc|realloc|reallocarray|free|memalign|aligned_alloc|posix_memalign|strdup'
forbidden+='|pthread_(mutex|cond|rwlock|spin|create|join).*|sem_.*'
forbidden+='|f?open(64|at)?|fopen64|fclose|fread|fwrite|fputs?|fputc|puts|putchar|read|write|close'
forbidden+='|(__)?v?(f|s|sn|d)?printf(_chk)?|perror|nanosleep|usleep|sleep|sched_yield'
forbidden+='|abort|exit|_exit|raise|_ZSt4cout|_ZSt4cerr|_ZNSo.*)$'

# "library symbol", each with its reason.
allowed=(
  # Deleting destructor in the vtable of an Executor; nothing here deletes one, and new is refused.
  "libsopt_planner _ZdlPvm"
)

num_violations=0
for library in "$@"; do
  symbols=$(nm --format=posix "$library")
  if [[ -z $symbols ]]; then
    echo "$library: no symbols, nothing was checked"
    exit 1
  fi
  name=$(basename "$library" .a)
  while read -r symbol; do
    if [[ " ${allowed[*]} " == *" $name $symbol "* ]]; then continue; fi
    echo "$name refers to $(c++filt "$symbol")"
    num_violations=$((num_violations + 1))
  done < <(awk '$2 == "U" || $2 == "w" {print $1}' <<<"$symbols" | sort -u |
    grep -E "$forbidden" || true)
done
echo "$# libraries checked, $num_violations forbidden symbols"
(($# > 0 && num_violations == 0))
