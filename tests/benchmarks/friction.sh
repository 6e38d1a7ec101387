#!/bin/sh
# Friction on broken faces, as Markdown tables on standard output:
#   sh tests/benchmarks/friction.sh [cells] [steps] [intact faces] [more options]
# runs prm/benchmarks/broken_faces.prm on cells x cells quads (20) for the given
# number of steps (20) per case: degree 1 and 2; 10, 30 and 100 % of the faces
# broken; Courant numbers 0.5, 2 and 20; intact faces spring or unilateral.
# More options go to every run, for example --set Solver/method='gauss seidel'.
# DEGREES, SHARES, STEPS and LIMIT (seconds per case) narrow it down.
#
#   steps     accepted; "!" if the case did not reach its end
#   whole     of the wanted steps, solved without cutting
#   cuts      rejected attempts
#   Newton..  per accepted step: median (largest)
#   factors   factorisations of the assembled matrix per accepted step
#   ms        CPU of the contact solve per wanted step, rejected attempts included
#   ratio     the same over a frictionless step of the intact square with
#             unilateral faces, solved by factorisation right before
# Run from the top of a built checkout. Times depend on the machine.
set -eu
cd "$(dirname "$0")/../.."
cells=${1:-20}
steps=${2:-20}
intact=${3:-spring}
shift $(($# < 3 ? $# : 3))
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

run() { # run DEGREE STEP SHARE INTACT STEPS [options]
  degree=$1 step=$2 share=$3 faces=$4 count=$5
  shift 5
  theta=$(awk "BEGIN { print ($step > 2 ? 1 : 0.5) }")
  # steps times the crossing time L / c_p
  end=$(awk "BEGIN { c = sqrt(0.7 / (1.3 * 0.4)); print $count * $step / $cells / c * (1 - 1e-6) }")
  rm -rf "$out/run"
  timeout "${LIMIT:-300}" ./nsfd prm/benchmarks/broken_faces.prm \
    --set "Constants/n=$cells" --set "Mesh/cells=$cells, $cells" \
    --set "Constants/C=$((21 * degree * degree))" \
    --set "Discretization/degree=$degree" --set "Constants/share=$share" \
    --set "Interface: faces/intact faces=$faces" \
    --set "Time/step=$step courant" --set "Time/end=$end" \
    --set "Time/theta=$theta" "$@" --output "$out/run" --force --quiet \
    2>"$out/errors" || [ -s "$out/run/summary.json" ] || cat "$out/errors" >&2
}
value() { # value KEY: a number from the summary
  sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" |
    head -n 1
}
spread() { # spread COLUMN: median (largest) over the accepted steps
  awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) c = i }
    NR > 2 { print $c }' "$out/run/history.csv" | sort -n |
    awk '{ x[NR] = $1 } END { printf "%g (%g)", x[int((NR + 1) / 2)], x[NR] }'
}
whole() { # whole STEP: steps that were not cut
  awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "time_step") c = i }
    NR > 2 { if ($c > big) big = $c; h[NR] = $c }
    END { for (i in h) n += h[i] > 0.99 * big; print n + 0 }' \
    "$out/run/history.csv"
}

echo "| p | broken | step | steps | whole | cuts | Newton | Krylov | factors | ms | ratio | worst residual | hand-overs |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
for p in ${DEGREES:-1 2}; do
  for step in ${STEPS:-0.5 2 20}; do
    run "$p" "$step" 0 unilateral 3 --set Constants/mu=0 \
      --set Solver/path=assembled --set "Solver/linear solver=direct"
    intact_ms=$(awk "BEGIN { print 1e3 * $(value 'nonsmooth solve') / $(value steps) }")
    for share in ${SHARES:-0.1 0.3 1}; do
      run "$p" "$step" "$share" "$intact" "$steps" "$@"
      done_steps=$(value steps)
      mark=
      grep -q '"completed": true' "$out/run/summary.json" || mark=!
      hand_overs=$(sed -n 's/^ *"switches_to_\([^"]*\)": *\([0-9]*\).*/\1 \2/p' \
        "$out/run/summary.json" | tr '\n' ';')
      awk -v p="$p" -v share="$share" -v step="$step" -v n="$done_steps$mark" \
        -v w="$(whole "$step")" -v wanted="$steps" \
        -v cuts="$(value rejected_steps)" -v newton="$(spread newton)" \
        -v krylov="$(spread krylov)" \
        -v factors="$(value global_factorisations)" -v m="$done_steps" \
        -v s="$(value 'nonsmooth solve')" -v base="$intact_ms" \
        -v residual="$(value residual_max)" -v hand="$hand_overs" 'BEGIN {
        printf "| %s | %s | %s | %s | %s/%s | %s | %s | %s | %.1f | %.0f | %.1f | %.1e | %s |\n",
          p, share, step, n, w, wanted, cuts, newton, krylov, factors / (m ? m : 1),
          1e3 * s / wanted, 1e3 * s / wanted / base, residual, hand }'
    done
  done
done
