#!/bin/sh
# same.sh OLD NEW [SECONDS] [SCENE ...]: two programs on the same scenes
# (prm/verification and prm/stability), on 1 and 2 ranks. history.csv, tables,
# fields and pictures must be the same byte for byte, and summary.json up to its
# `cost`, but for times and memory; report pages and checkpoints are not looked
# at. Runs that take longer than SECONDS (60) are named and not compared.
set -eu
[ $# -ge 2 ] || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
old=$1 new=$2
shift 2
seconds=${1:-60}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- prm/verification/*.prm prm/stability/*.prm
export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 \
  OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
compared=0 different=0

# run PROGRAM FOLDER RANKS SCENE: exit code
run() {
  status=0
  command="$1 $4 --output $2 --quiet"
  [ "$3" -eq 1 ] || command="mpirun -n $3 $command"
  # words on purpose
  # shellcheck disable=SC2086
  timeout "$seconds" $command >"$2.log" 2>&1 || status=$?
  echo "$status"
}

# What must be equal, as one text.
contents() {
  (cd "$1" && find . -type f ! -name run.json ! -name parameters.prm ! -name '*.html' \
    ! -name 'checkpoint*' ! -name summary.json ! -name '.*' | sort |
    xargs cksum
    sed -E '/"([a-z_]*seconds|peak_memory_mb|bytes_per_second|host)/d; /"timings"/,/[}\]]/d; /"cost"/,$d' \
      summary.json)
}

for scene; do
  for ranks in 1 2; do
    name=$(basename "$scene" .prm)
    a=$scratch/a b=$scratch/b
    rm -rf "$a" "$b"
    first=$(run "$old" "$a" "$ranks" "$scene")
    [ "$first" -ne 124 ] || { echo "$name, $ranks ranks: too long"; continue; }
    second=$(run "$new" "$b" "$ranks" "$scene")
    compared=$((compared + 1))
    if [ "$first" -ne "$second" ]; then
      different=$((different + 1))
      echo "$name, $ranks ranks: exit code $first, then $second"
    elif [ -f "$a/summary.json" ] &&
      { contents "$a" >"$scratch/left"; contents "$b" >"$scratch/right"
        ! diff "$scratch/left" "$scratch/right" >"$scratch/diff"; }; then
      different=$((different + 1))
      echo "$name, $ranks ranks:"
      head -n 12 "$scratch/diff"
    fi
  done
done
echo "$compared pairs of runs compared, $different different"
[ "$different" -eq 0 ]
