#!/bin/sh
# The table of doc/stability.md, as Markdown on standard output:
#   sh tests/benchmarks/stability.sh
# First what the tests `Stability.*` measure and allow, then the scenes that are
# known to fail, with what they say. Run from the top of a built checkout with
# tests. Some minutes.
set -u
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

echo "| case | measured | value | allowed |"
echo "|---|---|---|---|"
build/tests/end_to_end/nsfd_end_to_end --gtest_filter='Stability.*' |
  awk '/^\[ RUN/ { split($4, name, "."); test = name[2] }
       /\(allowed/ {
         line = $0
         sub(/ *\(allowed.*/, "", line)
         value = line; sub(/.* /, "", value)
         sub(/ *[^ ]*$/, "", line); sub(/^ */, "", line)
         allowed = $0; sub(/.*\(allowed /, "", allowed); sub(/\)/, "", allowed)
         printf "| %s | %s | %s | %s |\n", test, line, value, allowed
       }
       /^\[  FAILED.*Stability/ { printf "| %s | FAILED | | |\n", test }'

echo
echo "| scene | options | steps | outcome | balance residual | penetration over its bound | created by friction, over the work |"
echo "|---|---|---|---|---|---|---|"
value() { # value KEY: a number from the summary
  sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" | head -n 1
}
try() { # try FILE [--set ...]
  scene=$1
  shift
  ./nsfd "prm/stability/$scene.prm" "$@" --set Output/report=false \
    --output "$out/run" --force --quiet 2> "$out/err"
  code=$?
  friction=$(value friction) work=$(value work)
  depth=$(value penetration_max) bound=$(value penetration_bound)
  echo "| $scene | $(echo "$*" | sed 's/--set //g') | $(value steps) |" \
    "exit $code $(sed -n 's/.*not solved: \(residual [^ ]*\).*/\1/p' "$out/err")" \
    "| $(awk "BEGIN { printf \"%.1e\", $(value ledger_defect_max) }")" \
    "| $(awk "BEGIN { b = ${bound:-0}; printf \"%.2g\", (b > 0 ? ${depth:-0} / b : 0) }")" \
    "| $(awk "BEGIN { f = ${friction:-0}; w = ${work:-0}; if (w < 0) w = -w; \
              printf \"%.2g\", (f < 0 && w > 0 ? -f / w : 0) }") |"
}
try heavy_on_light --set Solver/tolerance=1e-8
try heavy_on_light
try heavy_on_light --set Solver/tolerance=1e-13
try loose_cells --set Constants/mu=1
try loose_cells --set Constants/mu=10
try loose_cells --set Constants/mu=1e3
try mu_huge --set Constants/mu=10
try mu_huge --set Constants/mu=1e3
for steps in 10 100 1e3 1e4 1e5; do
  try large_step --set Constants/theta=0.5 --set "Time/cohesion rule=exact" \
    --set Constants/steps=$steps
done
