#!/bin/sh
# Work of long steps as a table (CSV on standard output):
#   sh tests/benchmarks/scaling.sh stiffness [direct|cg]  C L/E and step, p = 1
#   sh tests/benchmarks/scaling.sh degree                 p = 1 to 4
#   sh tests/benchmarks/scaling.sh meshes                 20^2 to 160^2, 8^3 to 32^3
#   sh tests/benchmarks/scaling.sh contact                faces in contact
#   sh tests/benchmarks/scaling.sh cost                   time and memory by size
#   sh tests/benchmarks/scaling.sh paths                  which path is faster
# Run from the top of a built checkout. Applications of W and of A inside the
# solver are counted; times depend on the machine. Columns: see the first line.
set -eu
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

value() { # value KEY: a number from the summary
  sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" | head -n 1
}

echo "series,dimension,degree,cells,ratio,step,path,unknowns,steps,rejected,newton,applications,seconds,megabytes"
row() { # row SERIES DIMENSION DEGREE CELLS RATIO STEP STEPS PATH [options]
  series=$1 dimension=$2 degree=$3 cells=$4 ratio=$5 step=$6 steps=$7 path=$8
  shift 8
  all="$cells, $cells"
  lower="0, 0" upper="1, 1" type=rectangle
  scene=prm/benchmarks/pulse.prm
  if [ "$dimension" = 3 ]; then
    all="$all, $cells" lower="0, 0, 0" upper="1, 1, 1" type=brick
    scene="$out/pulse.prm"
    sed '/^set plane/d' prm/benchmarks/pulse.prm >"$scene"
  fi
  # the shortest crossing of a cell lasts 1 / cells / 1.16
  end=$(awk "BEGIN { print ($steps - 0.5) * $step / $cells / 1.16 }")
  theta=$(awk "BEGIN { print $step < 2 ? 0.5 : 1 }")
  status=0
  timeout "${LIMIT:-300}" ./nsfd "$scene" \
    --set "dimension=$dimension" \
    --set "Mesh/type=$type" --set "Mesh/cells=$all" \
    --set "Mesh/lower corner=$lower" --set "Mesh/upper corner=$upper" \
    --set "Interface: faces/stiffness=$cells * $ratio" \
    --set "Discretization/degree=$degree" --set "Time/theta=$theta" \
    --set "Time/step=$step courant" --set "Time/end=$end" \
    --set "Solver/path=$path" --set "Output/fields=false" "$@" \
    --output "$out/run" --force --quiet 2>"$out/errors" || status=$?
  if [ ! -s "$out/run/summary.json" ]; then
    echo "$series,$dimension,$degree,$cells,$ratio,$step,$path,,0,,,,,"
    rm -rf "$out/run"
    return 0
  fi
  awk -v head="$series,$dimension,$degree,$cells,$ratio,$step,$path" \
    -v n="$(value dofs)" -v s="$(value steps)" -v r="$(value rejected_steps)" \
    -v i="$(value newton)" -v a="$(value operator_applications)" \
    -v t="$(value 'nonsmooth solve')" -v m="$(value peak_memory_mb)" 'BEGIN {
    printf "%s,%d,%d,%d,%.1f,%.1f,%.4f,%d\n", head, n, s, r, i / s, a / s, t / s, m }'
  rm -rf "$out/run"
}

all_ratios="21 1e3 1e5 1e8"
all_steps="0.1 1 10 100 1e4"
case "${1:-}" in
stiffness)
  for ratio in $all_ratios; do
    for step in $all_steps; do
      row "C L/E = $ratio" 2 1 40 "$ratio" "$step" 5 assembled \
        --set "Solver/linear solver=${2:-cg}"
    done
  done ;;
degree)
  for degree in 1 2 3 4; do
    for ratio in 21 1e5; do
      for step in $all_steps; do
        row "p = $degree; C L/E = $ratio" 2 $degree 20 "$ratio" "$step" 5 \
          assembled --set "Solver/linear solver=cg"
      done
    done
  done
  for degree in 1 2; do
    for step in $all_steps; do
      row "p = $degree; 3D" 3 $degree 6 21 "$step" 5 assembled \
        --set "Solver/linear solver=cg"
    done
  done ;;
meshes)
  for step in 1 100; do
    for cells in 20 40 80 160; do
      row "2D; step $step" 2 1 $cells 21 $step 3 assembled \
        --set "Solver/linear solver=cg"
    done
    for cells in 8 16 32; do
      row "3D; step $step" 3 1 $cells 21 $step 3 assembled \
        --set "Solver/linear solver=cg"
    done
  done ;;
contact)
  for ratio in $all_ratios; do
    for step in $all_steps; do
      row "contact; C L/E = $ratio" 2 1 20 "$ratio" "$step" 5 assembled \
        --set "Solver/linear solver=cg" \
        --set "Interface: faces/intact faces=unilateral"
    done
  done ;;
cost)
  for solver in direct cg; do
    for cells in 40 80 160 350; do
      row "2D $solver" 2 1 $cells 21 10 3 assembled \
        --set "Solver/linear solver=$solver"
    done
  done ;;
paths)
  for degree in 1 2; do
    for step in 0.25 0.5 1 2 5 10; do
      for path in local assembled; do
        row "2D; p = $degree; $path" 2 $degree 40 21 $step 10 $path
      done
    done
  done
  for step in 0.25 0.5 1 2 5 10; do
    for path in local assembled; do
      row "3D; $path" 3 1 10 21 $step 10 $path
    done
  done ;;
*)
  sed -n '2,10s/^# *//p' "$0" >&2
  exit 2 ;;
esac
