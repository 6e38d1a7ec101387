#!/bin/sh
# What fragments.csv costs: CPU time per call, all fragments found, measured and
# written, on plates of 1600 and 25 600 cells, whole and in ever more pieces.
#
#     sh tests/benchmarks/fragments.sh [NSFD]
set -e
nsfd=${1:-./nsfd}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cat > "$folder/plate.prm" <<'END'
# plate.prm - a plate that flies, cut into pieces along lines of its mesh.
set dimension = 2
subsection Constants
  set n    = 40
  set side = 40
end
subsection Mesh
  set type         = rectangle
  set lower corner = 0, 0
  set upper corner = 1, 1
  set cells        = n, n
end
subsection Material: plate
  set Young modulus      = 1 GPa
  set Poisson ratio      = 0.3
  set density            = 1000 kg/m^3
  set initial velocity x = 1 - 2 * y
  set initial velocity y = 2 * x
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 1 GPa
  set toughness = 1000 J/m^2
  set broken    = cos(pi * x * n / side)^2 > 1 - 1e-9 || cos(pi * y * n / side)^2 > 1 - 1e-9
end
subsection Time
  set scheme   = symplectic
  set end      = 2 us
  set step     = 0.02 us
end
subsection Output
  set report             = false
  set fields             = false
  set fields every steps = 1
end
END
printf '| cells | fragments | ms per call | us per cell |\n|---|---|---|---|\n'
for n in 40 160; do
  for side in $((2 * n)) 20 4 1; do
    "$nsfd" "$folder/plate.prm" --quiet --force --output "$folder/out" \
      --set "Constants/n=$n" --set "Constants/side=$side"
    awk -v n="$n" -F ': *' '
      /"fragments":/ { fragments = $2 + 0 }
      /"motion of fragments"/ { found = 1 }
      found && /"seconds"/ { seconds = $2 + 0 }
      found && /"calls"/ {
        ms = 1e3 * seconds / ($2 + 0)
        printf "| %d | %d | %.2f | %.2f |\n", n * n, fragments, ms,
          1e3 * ms / (n * n)
        exit
      }' "$folder/out/summary.json"
  done
done
