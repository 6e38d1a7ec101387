#!/bin/sh
# Every shipped scene on several numbers of ranks, as Markdown on standard output:
#   [RANKS="2 3 4 8"] [LIMIT=8] sh tests/benchmarks/ranks.sh [scene.prm ...]
# Each run is stopped after LIMIT seconds, four times as many on several ranks that
# share two cores; energies of the steps that both have
# made are compared with those of one rank: the largest difference over the
# largest energy. An hour for all of them on two cores.
set -u
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 \
  OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_mpi_yield_when_idle=1
ranks=${RANKS:-2 3 4 8}
limit=${LIMIT:-8}

run() { # run SCENE RANKS
  if [ "$2" = 1 ]; then set -- "$1" "$2" "$limit" ""; else
    set -- "$1" "$2" $((4 * limit)) "mpirun -n $2"; fi
  timeout -k 60 -s TERM "$3" $4 ./nsfd "$1" --set Output/fields=false \
    --set Output/report=false --output "$out/$2" --force --quiet \
    >"$out/log" 2>&1
  code=$?
  case $code in
  0 | 4 | 124 | 143) ;;
  *) echo "$1 on $2 ranks: exit $code: $(tail -n 1 "$out/log")" >&2 ;;
  esac
}
difference() { # difference RANKS: "steps worst"
  awk -F, 'FNR == 1 { ++file; n = 0; for (i = 1; i <= NF; ++i) name[file, i] = $i
      columns = NF; next }
    file == 1 { for (i = 1; i <= NF; ++i) a[FNR, i] = $i; last = FNR; next }
    FNR <= last { ++n; for (i = 1; i <= columns; ++i)
        if (name[1, i] ~ /^(kinetic|elastic|cohesive|damage|friction|viscous|plastic|impact|work)$/) {
          d = a[FNR, i] - $i; if (d < 0) d = -d; if (d > worst) worst = d
          e = $i; if (e < 0) e = -e; if (e > most) most = e } }
    END { if (n < 2) print "0 -"
      else printf "%d %.1e", n - 1, (most > 0 ? worst / most : worst) }' \
    "$out/1/history.csv" "$out/$1/history.csv"
}
printf '| scene |'
for n in $ranks; do printf ' %s ranks |' "$n"; done
printf ' steps |\n|---|'
for n in $ranks; do printf -- '---|'; done
echo '---|'
for scene in ${*:-prm/*.prm prm/verification/*.prm prm/benchmarks/*.prm}; do
  rm -rf "$out"/[0-9]*
  run "$scene" 1
  [ -f "$out/1/history.csv" ] || continue
  line="| $(basename "$scene" .prm) |" least=
  for n in $ranks; do
    run "$scene" "$n"
    if [ -f "$out/$n/history.csv" ]; then
      set -- $(difference "$n")
    else set -- 0 failed; fi
    line="$line $2 |"
    if [ -z "$least" ] || [ "$1" -lt "$least" ]; then least=$1; fi
  done
  echo "$line $least |"
done
