#!/bin/sh
# What a mesh that follows the crack saves, as Markdown on standard output:
#   sh tests/benchmarks/adaptive_gain.sh [dcb] [branching]
# Each scene on its coarse mesh, adaptive, and on the finest mesh everywhere, one
# after the other; damage and broken length against the last. Half an hour.
set -eu
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

value() { # value RUN KEY: a number from the summary
  sed -n "s/^ *\"$2\": *\([-0-9.e+]*\),*$/\1/p" "$out/$1/summary.json" | head -n 1
}
run() { # run NAME SCENE [options]
  name=$1 scene=$2
  shift 2
  ./nsfd "prm/benchmarks/$scene.prm" "$@" --set Output/fields=false \
    --set Output/report=false --output "$out/$name" --force --quiet ||
    echo "$scene $name: exit $?" >&2
}
# largest difference of the broken length at the same time, over its last value
curve() { # curve RUN REFERENCE
  awk -F, 'FNR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; ++file; n = 0; next }
    file == 1 { t[++m] = $column["time"]; a[m] = $column["broken_area"]; next }
    { while (k < m && t[k + 1] <= $column["time"]) ++k
      if (k < 1) next
      d = a[k] - $column["broken_area"]; if (d < 0) d = -d
      if (d > worst) worst = d; last = $column["broken_area"] }
    END { printf "%.2f", (last > 0 ? 100 * worst / last : 0) }' \
    "$out/$1/history.csv" "$out/$2/history.csv"
}
table() { # table SCENE COARSE FINE
  run coarse "$1" --set "Mesh/cells=$2" --set Adaptivity/levels=0
  run adaptive "$1"
  run fine "$1" --set "Mesh/cells=$3" --set Adaptivity/levels=0 $4
  for name in coarse adaptive fine; do
    cells=$(value $name mean_cells)
    awk -v scene="$1" -v name=$name -v cells="${cells:-$(value $name cells)}" \
      -v cpu="$(value $name cpu_seconds)" -v fine="$(value fine cpu_seconds)" \
      -v d="$(value $name damage)" -v reference="$(value fine damage)" \
      -v curve="$(curve $name fine)" \
      -v changes="$(value $name mesh_changes)" \
      -v worst="$(value $name mesh_change_energy_worst)" 'BEGIN {
        printf "| %s | %s | %d | %.1f | %.2f | %.5g | %+.2f | %s | %d | %.1e |\n",
          scene, name, cells, cpu, cpu / fine, d,
          100 * (d - reference) / reference, curve, changes, worst }'
  done
}
echo "| scene | mesh | cells, mean | CPU, s | share of the finest | damage, J/m | difference, % | broken length, worst difference, % | changes | energy of the worst |"
echo "|---|---|---|---|---|---|---|---|---|---|"
for scene in ${*:-dcb branching}; do
  case $scene in
  dcb) table dcb "40, 8" "160, 32" "" ;;
  branching) table branching "40, 16" "160, 64" "" ;;
  esac
done
