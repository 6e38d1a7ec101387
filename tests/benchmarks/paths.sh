#!/bin/sh
# Where cracks go by mesh kind, seed and size, as Markdown on standard output:
#   sh tests/benchmarks/paths.sh [inclined] [kalthoff] [branching] [xu_needleman]
# The tables of "Paths" of doc/meshes.md. Sixteen minutes of CPU. NSFD names
# another program than ./nsfd, SEEDS other seeds than 1 to 5.
set -eu
cd "$(dirname "$0")/../.."
nsfd=${NSFD:-./nsfd}
seeds=${SEEDS:-1 2 3 4 5}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# run SCENE OPTIONS: leaves $out/run, false if the run failed
run() {
  scene=$1
  shift
  file=prm/benchmarks/$scene.prm
  [ -f "$file" ] || file=$out/$scene.prm
  rm -rf "$out/run"
  "$nsfd" "$file" "$@" --set Output/fields=false \
    --set Output/report=false --output "$out/run" --force --quiet \
    >"$out/log" 2>&1 || {
    echo "$scene $*: $(head -n 1 "$out/log")" >&2
    return 1
  }
}
# The same scene on crossed triangles, whose notch is where the condition NOTCH holds.
crossed_scene() { # crossed_scene SCENE WIDTH,HEIGHT NOTCH
  awk -v corner="$2" -v notch="$3" '
    /^subsection Mesh/ { skip = 1
      print "subsection Mesh\n  set type = crossed triangles"
      print "  set upper corner = " corner "\n  set cells = 1, 1\nend" }
    /= notch$/ { print "  set where = " notch; next }
    !skip
    /^end/ { skip = 0 }' "prm/benchmarks/$1.prm" >"$out/$1_crossed.prm"
}
value() { # value KEY: a number from the summary
  sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" |
    head -n 1
}
# names one kind of mesh: options of SCENE for about N cells, in rows of cells in
# a width that is RATIO times the height
options() { # options KIND N RATIO
  awk -v kind="$1" -v n="$2" -v ratio="$3" 'BEGIN {
    per_square = kind == "squares" ? 1 : 4
    y = 2 * int(sqrt(n / per_square / ratio) / 2 + 0.5) # a line along the middle
    x = int(ratio * y + 0.5)
    rows = "Mesh/cells=" x "," y
    if (kind == "squares")
      print "Mesh/type=rectangle " rows
    else if (kind ~ /^crossed/)
      print "Mesh/type=crossed_triangles " rows (kind ~ /moved/ ? " Mesh/distortion=0.3" : "")
    else
      print "Mesh/cells=" n (kind == "delaunay" ? " Mesh/split=none Mesh/relaxation=0" : "")
  }'
}
# the same as words of a command line, in "$@" of the caller by eval
sets() { # sets KIND N RATIO
  for word in $(options "$@"); do
    printf "%s '%s' " --set "$(echo "$word" | tr _ ' ')"
  done
}
seeds_of() { # rows of equal cells are one mesh
  case $1 in squares | crossed) echo 1 ;; *) echo "$seeds" ;; esac
}
name_of() {
  case $1 in
  crossed) echo "crossed triangles" ;;
  crossed-moved) echo "crossed triangles, nodes moved by 0.3" ;;
  delaunay) echo "Delaunay triangles, random nodes" ;;
  isotropic) echo "**\`isotropic\`**" ;;
  *) echo "$1" ;;
  esac
}

# Deviations from the expected angle, of runs whose crack is a third of the side.
inclined() { # inclined KIND CELLS
  : >"$out/rows"
  for seed in $(seeds_of "$1"); do
    for alpha in ${ANGLES:-0 15 30 45}; do
      eval "run inclined_isotropic $(sets "$1" "$2" 1)" \
        --set "Mesh/seed=$seed" --set "Constants/alpha=$alpha" ||
        { echo failed >>"$out/rows"; continue; }
      echo "$(value cells) $(value crack_deviation) $(value crack_extent)" \
        "$(value cpu_seconds)" >>"$out/rows"
    done
  done
  awk -v name="$(name_of "$1")" '$1 == "failed" { ++failed; next }
    { ++runs; cells = $1; cpu += $4; if ($3 < 0.0033) next
      d = $2 < 0 ? -$2 : $2; ++n; sum += d; squares += d * d
      if (d > worst) worst = d }
    END { printf "| %s | %d | %d of %d | %.1f | %.1f | %.1f | %.1f |\n", name,
      cells, n, runs + failed, n ? sum / n : 0,
      n ? sqrt(squares / n) : 0, worst, runs ? cpu / runs : 0 }' "$out/rows"
}
kalthoff() { # kalthoff KIND SIZE [OPTIONS]
  kind=$1 size=$2 scene=kalthoff_isotropic
  [ "$kind" != crossed ] || scene=${scene}_crossed
  shift 2
  : >"$out/rows"
  for seed in $(seeds_of "$kind"); do
    run $scene "$@" --set "Mesh/seed=$seed" ||
      { echo failed >>"$out/rows"; continue; }
    echo "$(value cells) $(value crack_angle) $(value crack_extent)" \
      "$(value crack_start) $(value cpu_seconds)" >>"$out/rows"
  done
  awk -v name="$(name_of "$kind")" -v size="$size" '
    $1 == "failed" { angles = angles " failed"; next }
    { cells = $1; angles = angles sprintf(" %.1f", $2); ++n; sum += $2
      squares += $2 * $2; extent += $3; start += $4; cpu += $5 }
    END { if (n) { mean = sum / n; s = squares / n - mean * mean }
      printf "| %s, %s | %d |%s | %.1f +- %.1f | %.0f mm | %.1f us | %.1f |\n",
        name, size, cells, angles, mean, (s > 0 ? sqrt(s) : 0),
        n ? 1e3 * extent / n : 0, n ? 1e6 * start / n : 0, n ? cpu / n : 0 }' \
    "$out/rows"
}
# Per seed where and when a section first has two pieces of crack, and the angle
# of what broke on the upper side; `-` where the crack stays one.
branches() { # branches SCENE KIND SECTIONS [OPTIONS]; sections in mm
  scene=$1 kind=$2 sections=$3
  shift 3
  : >"$out/rows"
  for seed in $(seeds_of "$kind"); do
    run "$scene" "$@" --set "Mesh/seed=$seed" ||
      { echo failed >>"$out/rows"; continue; }
    first=$(awk -F, -v sections="$sections" 'BEGIN { split(sections, x, " ") }
      NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^crossings_/) {
          split($i, word, "_"); section[i] = word[2] }; next }
      { for (i in section) if ($i >= 2 && !(i in seen)) seen[i] = $2 }
      END { # two sections in a row, so that a side crack is none
        best = 0
        for (i in seen)
          if (((i + 1) in seen) && (!best || section[i] < section[best])) best = i
        if (best) printf "%s %.4g", x[section[best]], 1e6 * seen[best]; else printf "- -" }' \
      "$out/run/observables/crack.csv")
    echo "$(value cells) $first $(value crack_angle) $(value cpu_seconds)" \
      >>"$out/rows"
  done
  awk -v name="$(name_of "$kind")" '$1 == "failed" { row = row " failed;"; ++all; next }
    { cells = $1; ++all; cpu += $5; ++n
      if ($2 == "-") { row = row " -;"; next }
      ++branched; row = row sprintf(" %s mm, %s us, %.0f;", $2, $3, $4) }
    END { sub(/;$/, "", row)
      printf "| %s | %d | %d of %d |%s | %.1f |\n", name, cells, branched, all,
        row, n ? cpu / n : 0 }' "$out/rows"
}

plate() { # plate KIND CELLS
  scene=branching_isotropic
  [ "$1" != crossed ] || scene=${scene}_crossed
  eval "branches $scene $1 '55 60 65 70 75 80 85 90 95'" \
    "$(sets "$1" "$2" 2.5)" \
    --set "'Observable: crack/type=crack'" \
    --set "'Observable: crack/direction=1, 0'" \
    --set "'Observable: crack/every steps=20'" \
    --set "'Observable: crack/sections=55 mm, 60 mm, 65 mm, 70 mm, 75 mm, 80 mm, 85 mm, 90 mm, 95 mm'" \
    --set "'Verification/case=crack path'" \
    --set "'Verification/region=y > 21 mm && x > 50 mm'"
}

for scene in ${*:-inclined kalthoff branching xu_needleman}; do
  case $scene in
  inclined)
    echo "| square under inclined tension | cells | cracked | mean error, degrees | rms | worst | CPU, s |"
    echo "|---|---|---|---|---|---|---|"
    for kind in squares crossed crossed-moved delaunay isotropic; do
      inclined $kind 4000
    done
    inclined squares 16000
    inclined crossed 16000
    inclined isotropic 16000
    ;;
  kalthoff)
    echo "| Kalthoff and Winkler | cells | angle by seed, degrees | mean | length | first break | CPU, s |"
    echo "|---|---|---|---|---|---|---|"
    crossed_scene kalthoff_isotropic "100 mm, 100 mm" \
      "abs(y - 25 mm) < 1 um && x < 50 mm"
    for cells in 48 72; do
      kalthoff crossed "$(awk "BEGIN { printf \"%.1f mm\", 100 / $cells }")" \
        --set "Mesh/cells=$cells, $cells"
    done
    for size in 2 1.5; do
      kalthoff delaunay "$size mm" --set "Mesh/size=$size mm" \
        --set Mesh/split=none --set Mesh/relaxation=0
    done
    for size in 3 2; do
      kalthoff isotropic "$size mm" --set "Mesh/size=$size mm"
    done
    ;;
  branching)
    echo "| branching plate | cells | branch | by seed: where, when, axis of all that broke above the middle in degrees | CPU, s |"
    echo "|---|---|---|---|---|"
    crossed_scene branching_isotropic "100 mm, 40 mm" \
      "abs(y - 20 mm) < 1 um && x < 50 mm"
    plate crossed 55000
    plate delaunay 25000
    plate isotropic 25000
    plate isotropic 55000
    ;;
  xu_needleman)
    echo "| block of Xu and Needleman | cells | branch | by seed: where, when, axis of all that broke above the middle in degrees | CPU, s |"
    echo "|---|---|---|---|---|"
    branches xu_needleman_isotropic delaunay "0.34 0.38 0.42 0.46 0.5" \
      --set "Constants/edge=4.1 um" --set Mesh/split=none --set Mesh/relaxation=0
    branches xu_needleman_isotropic isotropic "0.34 0.38 0.42 0.46 0.5"
    ;;
  *)
    echo "no table is called $scene" >&2
    exit 1
    ;;
  esac
  echo
done
