#!/bin/sh
# Tables of the results pages, as Markdown on standard output:
#   sh tests/benchmarks/tables.sh solver   work per step of the pulse scene
#   sh tests/benchmarks/tables.sh orders   L2 error of the standing mode
#   sh tests/benchmarks/tables.sh cost     fracture everywhere, cost of a step
#   sh tests/benchmarks/tables.sh paths    local against assembled path
#   sh tests/benchmarks/tables.sh crack    crack that runs and stops
#   sh tests/benchmarks/tables.sh procedures  three ways to update damage
#   sh tests/benchmarks/tables.sh auto     step = auto against fixed steps
#   sh tests/benchmarks/tables.sh lengths  points per cohesive length, as CSV
# Run from the top of a built checkout. Times depend on the machine, counts do
# not.
set -eu
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

run() { # run FILE [options]: leaves $out/run/summary.json
  ./nsfd "$@" --output "$out/run" --force --quiet
}
value() { # value KEY: a number from the summary
  sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" | head -n 1
}

error() { # error KEY: the same among the errors, which come after the energies
  sed -n "/\"errors\"/,/}/s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json"
}

case "${1:-}" in
solver)
  echo "| degree | C_N L/E | Courant number | Newton per step | CG per Newton | CG per step |"
  echo "|---|---|---|---|---|---|"
  for p in 1 2 3; do
    for ratio in 21 1e3 1e5 1e8; do
      for step in 0.1 0.25 0.5 1; do
        end=$(awk "BEGIN { print 20 * $step / 20 / 1.16 }")
        run prm/benchmarks/pulse.prm --set "Mesh/cells=20, 20" \
          --set "Constants/ratio=$ratio" \
          --set "Discretization/degree=$p" --set "Time/step=$step courant" \
          --set "Time/end=$end"
        awk -v p=$p -v c=$ratio -v h=$step -v n="$(value newton)" \
          -v k="$(value krylov)" -v s="$(value steps)" 'BEGIN {
          printf "| %s | %s | %s | %.2f | %.1f | %.1f |\n", p, c, h, n / s, k / n, k / s }'
      done
    done
  done ;;
orders)
  echo "| degree | cells | steps | L2 error of u | order |"
  echo "|---|---|---|---|---|"
  for setting in 1:400:4,8,16,32 2:2000:4,8,16,32 3:8000:4,8,16,32 4:20000:2,4,8,16; do
    p=${setting%%:*}
    steps=${setting#*:}
    steps=${steps%%:*}
    last=
    for n in $(echo "${setting##*:}" | tr ',' ' '); do
      run prm/verification/mode.prm --set "Discretization/degree=$p" \
        --set "Mesh/cells=$n, 1" --set "Time/end=1e-4 s" \
        --set "Time/step=$(awk "BEGIN { print 1e-4 / $steps }") s" \
        --set "Solver/tolerance=1e-11"
      error=$(value displacement_L2)
      awk -v p="$p" -v n="$n" -v s="$steps" -v e="$error" -v l="$last" 'BEGIN {
        order = l == "" ? "" : sprintf("%.2f", log(l / e) / log(2))
        printf "| %s | %s | %s | %.3e | %s |\n", p, n, s, e, order }'
      last=$error
    done
  done ;;
cost)
  echo "| run | ms of CPU per step | Newton | Krylov | rejected of all steps |"
  echo "|---|---|---|---|---|"
  row() { # row NAME [options]
    name=$1
    shift
    run prm/benchmarks/fracture_everywhere.prm --set Output/fields=false "$@"
    awk -v n="$name" -v s="$(value steps)" -v t="$(value loop_cpu_seconds)" \
      -v i="$(value newton)" -v k="$(value krylov)" \
      -v r="$(value rejected_steps)" 'BEGIN {
      printf "| %s | %.1f | %.1f | %.0f | %d of %d |\n",
        n, 1e3 * t / s, i / s, k / s, r, s }'
  }
  row "intact, waves (first 6 ns)" --set "Time/end=6 ns"
  row "to 45 ns, broken at 30 ns, no friction" --set "Interface: all/friction=0"
  row "the same with friction 0.3"
  row "the same, strengths scattered by 10 %" \
    --set "Interface: all/strength scatter=0.1" ;;
paths)
  echo "| Courant number | local: CG per step, ms per step | assembled: CG per step, ms per step |"
  echo "|---|---|---|"
  for step in 0.5 2 5 20 100; do
    end=$(awk "BEGIN { print 10 * $step / 20 / 1.16 }")
    row="| $step |"
    for path in local assembled; do
      run prm/benchmarks/pulse.prm --set "Mesh/cells=20, 20" \
        --set "Time/step=$step courant" --set "Time/end=$end" \
        --set "Solver/path=$path"
      row="$row $(awk -v k="$(value krylov)" -v s="$(value steps)" \
        -v t="$(value 'nonsmooth solve')" \
        'BEGIN { printf "%.1f, %.2f", k / s, 1e3 * t / s }') |"
    done
    echo "$row"
  done ;;
crack)
  echo "| process length | cells in it | speed | arrest length | tip path | kinetic left | CPU s |"
  echo "|---|---|---|---|---|---|---|"
  for length in 0.16 0.08 0.04 0.02; do
    for density in 2 4 8; do
      cells=$(awk "BEGIN { print int(2.5 * $density / $length) }")
      run prm/verification/dcb_dynamic.prm --set "Constants/ell=$length" \
        --set "Mesh/cells=$cells, 3" --set "Output/fields=false" \
        --set "Time/step=$(awk "BEGIN { print 1.25 / $cells }")" \
        --set "Output/report=false"
      echo "| $length | $density | $(error crack_speed) |" \
        "$(error arrest_length) | $(error tip_path) | $(error kinetic) |" \
        "$(value 'nonsmooth solve') |"
    done
  done ;;
procedures)
  echo "| scene | solver | Newton | Krylov | sweeps | ms | rejected | damage | friction |"
  echo "|---|---|---|---|---|---|---|---|---|"
  for scene in benchmarks/torn_plate verification/midplane verification/dcb_dynamic \
    verification/stop benchmarks/fracture_everywhere; do
    case $scene in
    */torn_plate) set -- --set "Time/end=80 us" ;;
    */midplane) set -- --set "Mesh/cells=10, 10" --set "Time/step=0.3 courant" ;;
    */fracture_everywhere)
      set -- --set "Mesh/cells=20, 20" --set "Time/step=0.1 courant" \
        --set "Time/end=38 ns" --set "Interface: all/stiffness=5.67e18 Pa/m" ;;
    *) set -- ;;
    esac
    for solver in "fixed point" anderson "dual newton" "gauss seidel"; do
      run "prm/$scene.prm" "$@" --set "Solver/method=$solver" \
        --set "Output/report=false"
      awk -v n="$scene" -v m="$solver" -v s="$(value steps)" \
        -v i="$(value newton)" -v k="$(value krylov)" \
        -v g="$(value gauss_seidel_sweeps)" -v r="$(value rejected_steps)" \
        -v t="$(value 'nonsmooth solve')" -v d="$(value damage)" \
        -v f="$(value friction)" 'BEGIN {
        printf "| %s | %s | %.1f | %.1f | %.1f | %.2f | %d | %.9g | %.9g |\n",
          n, m, i / s, k / s, g / s, 1e3 * t / s, r, d, f }'
    done
  done ;;
auto)
  echo "| scene | step | steps | rejected | redone | beyond uniqueness | CPU s |"
  echo "|---|---|---|---|---|---|---|"
  rows() { # rows NAME "STEPS" [options]
    name=$1
    steps=$2
    shift 2
    for step in auto $steps; do
      [ "$step" = auto ] || step="$step courant"
      run "prm/$name.prm" "$@" --set "Time/step=$step" \
        --set Output/fields=false --set Output/report=false
      awk -v f="$(basename "$name")" -v h="$step" -v n="$(value steps)" \
        -v r="$(value rejected_steps)" -v d="$(value redone_steps)" \
        -v b="$(value steps_beyond_uniqueness)" -v t="$(value cpu_seconds)" \
        'BEGIN { printf "| `%s` | %s | %d | %d | %d | %d | %.1f |\n", f, h, n, r, d, b, t }'
    done
  }
  rows benchmarks/torn_plate "0.5 0.25 0.16"
  rows benchmarks/fracture_everywhere "0.5 0.25 0.12" \
    --set "Mesh/cells=20, 20" --set "Interface: all/stiffness=5.67e18" ;;
lengths)
  # The steps are the same for all degrees and shrink with the cells.
  parts= # of an edge between points, if not the degree
  row() { # row SERIES LENGTH DEGREE CELLS STEPS [options]
    series=$1
    length=$2
    degree=$3
    cells=$4
    steps=$5
    shift 5
    run prm/benchmarks/lengths.prm --set "Constants/ell=$length" \
      --set "Discretization/degree=$degree" --set "Mesh/cells=$cells" \
      --set "Time/step=4 / $steps" "$@"
    [ "$series" = reference ] && cp "$out/run/history.csv" "$out/reference.csv"
    errors=$(awk -v toughness=1e-4 -v from=2 -f tests/benchmarks/tip_path.awk \
      "$out/reference.csv" "$out/run/history.csv")
    awk -v s="$series" -v l="$length" -v p="$degree" -v n="$(value dofs)" \
      -v k="${parts:-$degree}" -v L="$(edge "$cells")" -v e="$errors" \
      -v r="$(value rejected_steps)" -v t="$(value cpu_seconds)" 'BEGIN {
      printf "%s,%.4f,%s,%d,%.4f,%.3f,%.3f,%s,%d,%.1f\n",
        s, l, p, n, L, l / L, l * k / L, e, r, t }'
  }
  edge() { # edge CELLS: the longest one
    echo "$1" | awk -F, '{ x = 5 / $1; y = 2 / $2; print (x > y ? x : y) }'
  }
  springs() { # springs SERIES C LENGTH DEGREE CELLS STEPS
    joint=$1
    C=$2
    shift 2
    set -- "$@" --set "Interface: plane/law=geubelle-baylor" \
      --set "Interface: plane/stiffness=$C"
    row "$joint on the plane" "$@"
    row "$joint on all faces" "$@" \
      --set "Interface: elsewhere/law=elastic" \
      --set "Interface: elsewhere/normal stiffness=$C"
  }
  echo "series,L_czm,degree,unknowns,L_mesh,L_czm_over_L_mesh,L_czm_over_L_int,tip,work,kinetic,speed,D_over_Ga,rejected,cpu"
  for length in 0.66667 0.33333 0.23570 0.16667; do
    row reference $length 2 "120, 48" 336
    row "degree 1" $length 1 "60, 24" 112
    row "degree 2" $length 2 "40, 16" 112
    row "degree 4" $length 4 "24, 10" 112
    row "degree 1; coarse" $length 1 "30, 12" 56
    row "degree 2; coarse" $length 2 "20, 8" 56
    row "degree 4; coarse" $length 4 "12, 4" 56
    case $length in
    0.66667) row "degree 1; fine" $length 1 "120, 48" 224 ;;
    0.16667)
      row "reference; degree 4" $length 4 "60, 24" 336
      set -- --set "Discretization/interface quadrature=gauss"
      parts=2
      row "Gauss points" $length 1 "60, 24" 112 "$@"
      row "Gauss points; coarse" $length 1 "30, 12" 56 "$@"
      for points in 2 3 5; do # the jump stays linear, the law is intrinsic
        set -- --set "Interface: plane/law=geubelle-baylor" \
          --set "Interface: plane/stiffness=252" \
          --set "Discretization/interface points=$points"
        parts=$((points - 1))
        row "more points" $length 1 "60, 24" 112 "$@"
        row "more points; coarse" $length 1 "30, 12" 56 "$@"
      done
      parts= ;;
    esac
    [ $length = 0.33333 ] || continue
    for mesh in "1:60, 24" "2:40, 16" "4:24, 10"; do
      p=${mesh%%:*}
      L=$(edge "${mesh#*:}")
      springs "C L/E = 21" "$(awk "BEGIN { print 21 / $L }")" \
        $length "$p" "${mesh#*:}" 112
      springs "C L/E = 21 (0.5/L)^p" \
        "$(awk "BEGIN { print 21 / $L * (0.5 / $L)^$p }")" \
        $length "$p" "${mesh#*:}" 112
    done
  done ;;
*)
  echo "usage: sh $0 solver | orders | cost | paths | crack | procedures | auto | lengths" >&2
  exit 2 ;;
esac
