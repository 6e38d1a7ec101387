#!/bin/sh
# Instructions per step with parts of the law switched off in the input, as
# Markdown on standard output (doc/performance.md):
#   sh tests/benchmarks/instructions.sh
# A pulse in a plate of 10 x 10 cells that nothing breaks, and the same plate
# broken from the start. Needs valgrind; counts are those of the steps 21 to 60,
# so that starting the program drops out. Run from the top of a built checkout.
set -eu
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

scene() { # scene STEPS "ENTRIES": the plate with these entries on all faces
  cat << END
# plate.prm - a plate of 10 x 10 cells with a pulse.
set dimension = 2
subsection Mesh
  set type         = rectangle
  set upper corner = 1, 1
  set cells        = 10, 10
end
subsection Material: bulk
  set model              = linear elastic
  set Young modulus      = 1
  set Poisson ratio      = 0.3
  set density            = 1
  set initial velocity x = if(x < 0.25, 1e-3 * sin(pi * x / 0.25)^2, 0)
end
subsection Interface: faces
  set where = all
$2
end
subsection Time
  set end  = $1 * 0.04
  set step = 0.04
end
subsection Output
  set fields = false
  set report = false
end
END
}

count() { # count STEPS ENTRIES: instructions of the whole run
  scene "$1" "$2" > "$out/plate.prm"
  valgrind --tool=callgrind --callgrind-out-file=/dev/null \
    ./nsfd "$out/plate.prm" --output "$out/run" --force --quiet 2>&1 |
    sed -n 's/.*Collected : *//p'
}
value() { # value KEY: a number from the summary
  sed -n "s/^ *\"$1\": *\([-0-9.e+]*\),*$/\1/p" "$out/run/summary.json" | head -n 1
}

row() { # row NAME ENTRIES
  first=$(count 20 "$2")
  newton=$(value newton) krylov=$(value krylov)
  last=$(count 60 "$2")
  awk "BEGIN { printf \"| $1 | %.3g | %.2f | %.1f |\\n\", \
       ($last - $first) / 40e6, ($(value newton) - $newton) / 40, \
       ($(value krylov) - $krylov) / 40 }"
}

echo "| faces | Minstructions per step | Newton per step | Krylov per step |"
echo "|---|---|---|---|"
row "rigid" "  set law = rigid"
row "springs" "  set law = elastic
  set normal stiffness = 210"
intact="  set law = michel-suquet
  set stiffness = 210
  set strength = 10"
row "springs that may break" "$intact"
row "the same with friction" "$intact
  set friction = 0.3"
row "the same with contact while intact" "$intact
  set friction = 0.3
  set intact faces = unilateral"
row "broken, contact" "  set law = contact"
row "broken, contact and friction" "  set law = contact
  set friction = 0.3"
