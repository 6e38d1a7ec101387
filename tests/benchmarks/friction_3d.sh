#!/bin/sh
# Friction on broken faces in three dimensions, as a Markdown table:
#   sh tests/benchmarks/friction_3d.sh [cells ...] [-- more options]
# runs prm/benchmarks/broken_brick.prm on bricks of cells^3 (6 10): STEPS steps
# (1) of Courant number STEP (2), SHARE of the faces broken (0.3), at most LIMIT
# seconds each (600). More options go to every run.
#
#   matrices  made ready to solve with, median (worst) per step
#   solves    products with iterations; with factors one each, median (worst)
#   s         CPU of the contact solve per step, and of it set-up and solves
#   MB        largest memory of the program
# Run from the top of a built checkout. Times depend on the machine.
set -eu
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
sizes=
while [ $# -gt 0 ] && [ "$1" != -- ]; do sizes="$sizes $1" && shift; done
[ $# -eq 0 ] || shift

value() { sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" | head -n 1; }
part() { sed -n "/\"$1\": {/,/}/s/^ *\"seconds\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" | head -n 1; }
spread() {
  awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) c = i }
    NR > 2 { print $c }' "$out/run/history.csv" | sort -n |
    awk '{ x[NR] = $1 } END { printf "%g (%g)", x[int((NR + 1) / 2)], x[NR] }'
}

echo "| cells | unknowns | steps | cuts | matrices | solves | s | set-up | solves | MB |"
echo "|---|---|---|---|---|---|---|---|---|---|"
for n in ${sizes:-6 10}; do
  end=$(awk "BEGIN { c = sqrt(0.7 / (1.3 * 0.4)); print ${STEPS:-1} * ${STEP:-2} / $n / c * (1 - 1e-6) }")
  timeout "${LIMIT:-600}" ./nsfd prm/benchmarks/broken_brick.prm \
    --set "Constants/n=$n" --set "Mesh/cells=$n, $n, $n" \
    --set "Constants/share=${SHARE:-0.3}" --set "Time/end=$end" \
    --set "Time/step=${STEP:-2} courant" "$@" \
    --output "$out/run" --force --quiet || true
  awk -v n="$n" -v steps="$(value steps)" -v cuts="$(value rejected_steps)" \
    -v newton="$(spread newton)" -v krylov="$(spread krylov)" \
    -v s="$(value 'nonsmooth solve')" -v a="$(part 'preconditioner, set-up')" \
    -v b="$(part 'preconditioner, applied')" -v m="$(value peak_memory_mb)" \
    'BEGIN { k = steps ? steps : 1
      printf "| %d^3 | %d | %d | %d | %s | %s | %.1f | %.1f | %.1f | %.0f |\n",
        n, 24 * n * n * n, steps, cuts, newton, krylov, s / k, a / k, b / k, m }'
done
