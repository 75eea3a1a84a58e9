#!/usr/bin/env bash
# Every .h and .cc file is as clang-format 14 would write it. Other versions break lines elsewhere,
# so without version 14 the check is skipped (exit code 77).
# usage: format.sh [--fix]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

for candidate in clang-format-14 clang-format; do
  if "$candidate" --version 2>/dev/null | grep -q 'version 14\.'; then
    clang_format=$candidate
    break
  fi
done
if [[ -z ${clang_format:-} ]]; then
  echo "skipped: clang-format 14 is not installed (Debian: apt-get install clang-format-14)"
  exit 77
fi

num_unformatted=0
while IFS= read -r -d '' file; do
  if [[ ${1:-} == --fix ]]; then
    "$clang_format" -i "$file"
  elif ! "$clang_format" --dry-run -Werror "$file" 2>/dev/null; then
    echo "$file is not formatted"
    num_unformatted=$((num_unformatted + 1))
  fi
done < <(find rt alloc models sampler opt tools tests -name '*.h' -print0 -o -name '*.cc' -print0)

if ((num_unformatted > 0)); then
  echo "$num_unformatted files; to repair: tools/checks/format.sh --fix"
  exit 1
fi
