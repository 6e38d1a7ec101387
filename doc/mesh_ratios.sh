#!/bin/sh
# Prints the tables of "Meshes without bias" of doc/meshes.md, by `nsfd mesh`.
# Run it after ./nsfd has been built; --fast leaves out the meshes in space:
#   sh doc/mesh_ratios.sh [--fast]
set -eu
cd "$(dirname -- "$0")/.."
[ -x ./nsfd ] || { echo "build ./nsfd first: sh start build" >&2; exit 1; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# scene DIMENSION: of the mesh on standard input
scene() {
  echo "# mesh - a mesh that is looked at."
  echo "set dimension = $1"
  echo "subsection Mesh"
  cat
  cat <<'END'
end
subsection Material: glass
  set Young modulus = 32 GPa
  set Poisson ratio = 0.2
  set density       = 2450 kg/m^3
end
subsection Interface: all
  set law       = camacho-ortiz
  set strength  = 6 MPa
  set toughness = 3 J/m^2
end
subsection Time
  set end    = 1 us
  set scheme = explicit
  set step   = auto
end
END
}

# row DIMENSION NAME: the same, as a row of a table
row() {
  scene "$1" >"$scratch/mesh.prm"
  ./nsfd mesh "$scratch/mesh.prm" --check 2>&1 | awk -v name="$2" -v dim="$1" '
    /^  mesh / { cells = $2; height = $(NF - 1) " " $NF }
    /^  angles / { angle = $2 }
    /path ratio/ { mean = $3; error = $5 }
    /by direction/ {
      low = $3
      for (i = 4; i <= NF; ++i) if ($i == "to") high = $(i + 1)
    }
    /cut ratio/ { mean = $3; box = $(NF - 3) }
    /by normal/ { low = $3; high = $5; sub(/:/, "", high) }
    /stable up to/ { step = $6 " " $7; sub(/,/, "", step) }
    END {
      if (dim == 2)
        printf "| %s | %s | %s +- %s | %s to %s | %s | %s |\n",
          name, cells, mean, error, low, high, angle, step
      else
        printf "| %s | %s | %s | %s | %s to %s | %s |\n",
          name, cells, mean, box, low, high, step
    }'
}

square="  set upper corner = 60 mm, 60 mm"
echo "| mesh of 60 mm x 60 mm | cells | path ratio | by direction | smallest angle | stable step |"
echo "|---|---|---|---|---|---|"
printf '%s\n' "$square" "  set cells = 60, 60" | row 2 "squares"
printf '%s\n' "$square" "  set cells = 60, 60" "  set type = crossed triangles" |
  row 2 "crossed triangles"
printf '%s\n' "$square" "  set cells = 60, 60" "  set type = crossed triangles" \
  "  set distortion = 0.3" | row 2 "the same, nodes moved by 0.3"
isotropic="$square
  set type = isotropic
  set size = 1 mm"
printf '%s\n' "$isotropic" "  set split = none" "  set relaxation = 0" |
  row 2 "Delaunay triangles, random nodes"
printf '%s\n' "$isotropic" "  set split = none" |
  row 2 "\`isotropic\`, \`split = none\`: Lloyd's nodes"
printf '%s\n' "$isotropic" "  set split simplices = true" |
  row 2 "\`isotropic\`, \`split simplices = true\`: three quads each"
for seed in 1 2 3 4 5; do
  printf '%s\n' "$isotropic" "  set seed = $seed" |
    row 2 "**\`isotropic\`, seed $seed**: cut in six"
done

[ "${1:-}" != --fast ] || exit 0

# as many cells before they are cut, and as many after
brick="  set upper corner = 12 mm, 12 mm, 12 mm"
echo
echo "| mesh of 12 mm x 12 mm x 12 mm | cells | cut ratio | in this box | by normal | stable step |"
echo "|---|---|---|---|---|---|"
printf '%s\n' "$brick" "  set cells = 30, 30, 30" | row 3 "cubes"
printf '%s\n' "$brick" "  set cells = 24, 24, 24" "  set type = tetrahedra" |
  row 3 "tetrahedra, six of each cube"
printf '%s\n' "$brick" "  set type = isotropic" "  set cells = 170000" \
  "  set split = none" | row 3 "\`isotropic\`, \`split = none\`"
for seed in 1 2; do
  printf '%s\n' "$brick" "  set type = isotropic" "  set cells = 170000" \
    "  set seed = $seed" | row 3 "**\`isotropic\`, seed $seed**: cut in twenty-four"
done
