#!/bin/sh
# steps.sh [SECONDS] [FOLDER ...]: every scene of the folders (prm/verification,
# prm/stability, prm/benchmarks) at half, once, twice and five times its step,
# each run stopped after SECONDS (3). What must hold: no exit code but 0 (done),
# 1 (refused), 3 (a step that could not be solved) and 4 (stopped), and no
# certificate that is ok where friction, damage, impact, viscous or plastic fall
# by more than 1e-9 of the largest energy in history.csv (the sum of the sizes of
# its lines), which is asked here again without the program. Stacks that rest are
# left out: their energies are round-off of the weight that their contacts carry.
set -eu
seconds=${1:-3}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- prm/verification prm/stability prm/benchmarks
export OMP_NUM_THREADS=1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
runs=0 bad=0

# The step of scene $1 times $2, or nothing where it is no number.
scaled() {
  ./nsfd "$1" --print-parameters 2>/dev/null | awk -v f="$2" '
    /^subsection / { inside = $0 == "subsection Time" }
    inside && $2 == "step" {
      value = $0
      sub(/^[^=]*= */, "", value); sub(/ *#.*/, "", value)
      if (match(value, /^[0-9.]+([eE][-+]?[0-9]+)?/))
        printf "%.12g%s\n", f * substr(value, 1, RLENGTH),
               substr(value, RLENGTH + 1)
      exit
    }'
}

# Lines that fall in $1/history.csv: name and share of the largest energy.
fallen() {
  awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    {
      all = 0
      for (k in column) if (k ~ /^(kinetic|elastic|cohesive|damage|friction|viscous|plastic|impact|work)$/) {
        x = $column[k]; if (x < 0) x = -x
        all += x
      }
      if (all > largest) largest = all
      n = split("damage friction viscous plastic impact", line, " ")
      for (j = 1; j <= n; ++j) {
        x = $column[line[j]]
        if (!(line[j] in highest) || x > highest[line[j]]) highest[line[j]] = x
        fall = highest[line[j]] - x
        if (fall > most[line[j]]) most[line[j]] = fall
      }
    }
    END {
      for (k in most) if (largest > 0 && most[k] > 1e-9 * largest)
        printf " %s %.1e", k, most[k] / largest
    }' "$1/history.csv"
}

for folder; do
  for scene in "$folder"/*.prm; do
    for factor in 0.5 1 2 5; do
      step=$(scaled "$scene" "$factor")
      [ -n "$step" ] || continue
      out=$scratch/run
      rm -rf "$out"
      status=0
      timeout --preserve-status -s TERM -k 30 "$seconds" ./nsfd "$scene" \
        --set "Time/step=$step" --output "$out" --quiet >"$scratch/log" 2>&1 ||
        status=$?
      runs=$((runs + 1))
      case $status in
        0 | 1 | 3 | 4) ;;
        143) # the signal came before the first step
          grep -q "nothing had been computed" "$scratch/log" ||
            { bad=$((bad + 1)); echo "$scene, step $step: ended by TERM"; } ;;
        *) bad=$((bad + 1)); echo "$scene, step $step: exit code $status" ;;
      esac
      if [ -f "$out/summary.json" ] &&
        grep -A1 '"certificate"' "$out/summary.json" | grep -q '"ok": true'; then
        case ${scene##*/} in
          heavy_on_light.prm | tower.prm | wall.prm) lines= ;;
          *) lines=$(fallen "$out") ;;
        esac
        if [ -n "$lines" ]; then
          bad=$((bad + 1))
          echo "$scene, step $step: certified, and falls:$lines"
        fi
      fi
    done
  done
done
echo "$runs runs, $bad of them wrong"
[ "$bad" -eq 0 ]
