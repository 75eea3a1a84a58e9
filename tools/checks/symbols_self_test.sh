#!/usr/bin/env bash
# Proves that symbols.sh accepts harmless code and refuses each kind of forbidden symbol.
# usage: symbols_self_test.sh CXX
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cxx=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

build_library() {  # source text
  rm -f "$scratch/libplanted.a"
  printf '%s\n' "$1" >"$scratch/planted.cc"
  "$cxx" -std=c++20 -O2 -c "$scratch/planted.cc" -o "$scratch/planted.o"
  ar rc "$scratch/libplanted.a" "$scratch/planted.o"
}

build_library '#include <cmath>
double f(double x) { return std::sin(x); }'
if ! "$here/symbols.sh" "$scratch/libplanted.a" >"$scratch/log"; then
  echo "FAILED: harmless code is refused"
  cat "$scratch/log"
  exit 1
fi

expect_refused() {  # source text
  build_library "$1"
  if "$here/symbols.sh" "$scratch/libplanted.a" >"$scratch/log"; then
    echo "FAILED: accepted $1"
    exit 1
  fi
}

expect_refused 'int* f() { return new int[7]; }'
expect_refused 'void f(int* p) { delete p; }'
expect_refused '#include <cstdlib>
void* f(int n) { return std::malloc(n); }'
expect_refused 'void f() { throw 1; }'
expect_refused '#include <vector>
void f(std::vector<int>& v) { v.push_back(1); }'
expect_refused '#include <mutex>
void f(std::mutex& m) { m.lock(); }'
expect_refused '#include <cstdio>
void f(int i) { std::printf("%d", i); }'
expect_refused 'int g(); int f() { static const int value = g(); return value; }'
echo "symbols.sh catches planted violations"
