#!/bin/sh
# Writes doc/parameters.md from the program itself. Run it after ./nsfd has
# been built:
#   sh doc/generate_parameters.sh
set -eu
cd "$(dirname -- "$0")/.."
[ -x ./nsfd ] || { echo "build ./nsfd first: sh start build" >&2; exit 1; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Every interface law, every kind of load and an obstacle. Cohesive laws are
# those of --list, with the entries of their example.
cat >"$scratch/parts.prm" <<'END'
# parts - one block of every kind.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 8, 1
  set cells        = 8, 1
end
subsection Material: block
  set where   = x < 4
  set model   = rigid
  set density = 1
end
subsection Material: fibres
  set model                    = transversely isotropic
  set axial Young modulus      = 14
  set transverse Young modulus = 1
  set axial Poisson ratio      = 0.3
  set transverse Poisson ratio = 0.4
  set axial shear modulus      = 0.5
  set density                  = 1
end
subsection Material: crystals
  set model       = cubic
  set C11         = 168.4
  set C12         = 121.4
  set C44         = 75.4
  set density     = 1
  set orientation = random
end
subsection Material: wood
  set model       = orthotropic
  set E1          = 12
  set E2          = 0.8
  set E3          = 0.5
  set nu12        = 0.4
  set nu13        = 0.3
  set nu23        = 0.5
  set G12         = 0.7
  set G13         = 0.6
  set G23         = 0.05
  set density     = 1
end
END
./nsfd --list | awk '
  /^[^ ]/ { kind = $0 }
  kind != "cohesive law" { next }
  /^ *for example: / {
    sub(/^ *for example: /, "")
    n = split($0, entries, /; */)
    print "subsection Interface: " name
    print "  set where = x < 4"
    print "  set law = " name
    for (i = 1; i <= n; ++i) print "  set " entries[i]
    print "end"
    next
  }
  /^  / { name = substr($0, 3); sub(/  .*/, "", name) }' >>"$scratch/parts.prm"
cat >>"$scratch/parts.prm" <<'END'
subsection Interface: elastic
  set where            = x < 5.5
  set law              = elastic
  set normal stiffness = 1
end
subsection Interface: contact
  set where = x < 6.5
  set law   = contact
end
subsection Interface: rigid
  set where = all
  set law   = rigid
end
subsection Obstacle: floor
  set where  = bottom
  set point  = 0, 0
  set normal = 0, 1
end
subsection Time
  set end  = 1
  set step = 1 s
end
END

# Several bodies in three dimensions.
cat >"$scratch/bodies.prm" <<'END'
# bodies - two bricks of their own meshes.
set dimension = 3
subsection Mesh
  set type = bodies
end
subsection Body: lower
  set type         = brick
  set lower corner = 0, 0, 0
  set upper corner = 1, 1, 1
  set cells        = 1, 1, 1
end
subsection Body: upper
  set type         = brick
  set lower corner = 0, 0, 1
  set upper corner = 1, 1, 2
  set cells        = 1, 1, 1
end
subsection Material: rock
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end = 1
end
END

# A mesh of deal.II's generators.
cat >"$scratch/generator.prm" <<'END'
# generator - a disc.
set dimension = 2
subsection Mesh
  set type      = hyper_ball
  set arguments = 0, 0 : 1
end
subsection Material: rock
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set end = 1
end
END

# Rotations and strains of any size: every kind of body, obstacle and contact.
cat >"$scratch/large.prm" <<'END'
# large - a ball of several cells on a soft block in a drum.
set dimension = 3
set motion    = large
subsection Mesh
  set type         = brick
  set upper corner = 3, 1, 1
  set cells        = 3, 1, 1
end
subsection Material: ball
  set where   = x < 1
  set model   = rigid
  set density = 1
  set bodies  = connected
  set surface = ball
end
subsection Material: block
  set model         = neo-hookean
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: joint
  set where     = x < 1.5
  set law       = camacho-ortiz
  set strength  = 1
  set toughness = 1
end
subsection Interface: others
  set law = rigid
end
subsection Boundary: right
  set pressure = 1
end
subsection Obstacle: floor
  set point  = 0, 0, -1
  set normal = 0, 0, 1
end
subsection Obstacle: hammer
  set shape      = sphere
  set point      = 9, 0, 0
  set radius     = 1
  set velocity x = -1
end
subsection Obstacle: drum
  set shape  = cylinder
  set point  = 0, 0, 0
  set axis   = 0, 1, 0
  set radius = 5
  set hollow = true
end
subsection Contact: of the ball
  set between  = [ball, block]
  set friction = 0.5
end
subsection Contact: others
end
subsection Pin: hinge
  set material = ball
  set at       = 0, 0, 0
end
subsection Time
  set end  = 1
  set step = 1 ms
end
END

# One observable of every kind.
cat >"$scratch/observed.prm" <<'END'
# observed - what a block that may break shows.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 2, 2
  set cells        = 2, 2
end
subsection Material: rock
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: plane
  set where     = abs(y - 1) < 0.1
  set law       = camacho-ortiz
  set strength  = 1
  set toughness = 1
end
subsection Interface: others
  set where = all
  set law   = rigid
end
subsection Observable: crack
  set type = crack
end
subsection Observable: release
  set type = energy release rate
end
subsection Observable: probe
  set type = probe
  set at   = 0.5, 0.5
end
subsection Observable: support
  set type = reaction
  set on   = left
end
subsection Observable: pressure
  set type = contact pressure
  set on   = plane
end
subsection Boundary: left
  set velocity x = 0
end
subsection Time
  set end  = 1
  set step = 1 s
end
END

# Equilibria: every entry of their section Time.
cat >"$scratch/static.prm" <<'END'
# static - a bar pulled from equilibrium to equilibrium.
set dimension = 2
subsection Mesh
  set lower corner = 0, 0
  set upper corner = 1, 1
  set cells        = 1, 1
end
subsection Material: rock
  set Young modulus = 1
  set Poisson ratio = 0
  set density       = 1
end
subsection Interface: all
  set law = rigid
end
subsection Time
  set scheme             = quasi-static
  set end                = 1
  set step               = 10 ms
  set quasi-static until = 500 ms
end
END

# Section Path of `nsfd law`, with options.
path_of() {
  law_section Path "$@"
}

# Section $1 of `nsfd law` with the other arguments.
law_section() {
  section=$1
  shift
  printf '```\n'
  ./nsfd law tvergaard "$@" --print-parameters |
    awk -v first="subsection $section" '$0 == first { inside = 1 }
         inside { print }
         /^end/ { inside = 0 }'
  printf '```\n'
}

# The sections of scene $1 whose first line matches $2.
sections() {
  ./nsfd "$1" --print-parameters >"$scratch/all"
  printf '```\n'
  awk -v pattern="^subsection ($2)\$" '
    $0 ~ pattern { if (n++) print ""; inside = 1 }
    inside { print }
    /^end/ { inside = 0 }' "$scratch/all"
  printf '```\n'
}

# An entry that several blocks of a kind have is printed in the first of them
# only; within a block x, y, z and so on share one text. What selects a part is
# printed always, and so are the entries of a law that not all laws have. In the
# whole scene every entry that is set stays, and repeated texts go.
once() {
  awk '
    function entry(line) {
      sub(/^ *(# )?set /, "", line)
      sub(/ *=.*/, "", line)
      return line
    }
    # the entry without its direction, and its text
    function key(line,    name, text) {
      name = entry(line)
      sub(/ [xyz]+$/, "", name)
      text = line
      if (!sub(/^.*[^ ].* # /, "", text)) text = ""
      return kind "/" name "/" text
    }
    function is_dropped(line,    name) {
      name = entry(line)
      if (whole) return line ~ /^  # set /
      if (name ~ /^(model|type|law|shape|scheme|mode)$/) return 0
      if (kind == "Interface") return name in common
      return first[key(line)] != block
    }
    /^## / { whole = /A whole scene/ }
    /^subsection / {
      kind = $2
      sub(/:$/, "", kind)
      if (kind == "Body") kind = "Mesh"
      ++block
      is_common = $0 ~ /Interface: notch/
      # a block from which all is dropped is none
      if (!whole) { opening = $0; next }
    }
    /^  (# )?set / && kind != "Vary" {
      if (entry($0) == "strength factor") is_common = 1
      if (whole && kind == "Interface" && is_common) common[entry($0)] = 1
      its = key($0)
      if (its in first) {
        if (is_dropped($0)) next
        sub(/ +# [^#]*$/, "")
      }
      else first[its] = block
    }
    opening != "" && /^end/ { opening = ""; is_empty = 1; next }
    opening != "" { print opening; opening = "" }
    is_empty && /^$/ { is_empty = 0; next }
    { is_empty = 0; print }'
}

{
  cat <<'END'
# Parameters

Every entry of a scene, with its default and its text: a whole scene, then the
blocks that it does not use. An entry that several blocks of a kind have is in
the first of them only, and an optional one that ends with `x` or `xx` stands for
the other directions as well. For your own scene,

    ./nsfd FILE.prm --print-parameters

prints the entries that its parts have; one that no part reads is an error. This
page is written by `sh doc/generate_parameters.sh`; do not edit it.

## How values are written

- Bare numbers are SI, or any consistent set of units. With a suffix they are
  checked: `135 GPa`, `0.2 um`, `0.5 J/m^2`, `-9.81 m/s^2`, `480 J/(kg K)`. Units:
  `m s g Pa N J W Hz K` with the prefixes `f p n u m c k M G T`, and `min`, `h`;
  products with `*`, quotients with `/`, powers with `^`.
- Wherever a number stands, a formula may stand: `+ - * / ^`, comparisons,
  `&&`, `||`, `pi`, `true`, `false`, the names of section `Constants`, and
  `sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp ln log
  log2 log10 sqrt pow abs min max sum avg mod floor ceil rint sign erf erfc
  heaviside if(condition, a, b)`. Entries that say so also take `x`, `y`, `z`
  and `t`.
- `where` is `all`, a side of the bounding box (`left right bottom top front
  back`, boundary faces only), `between materials [a, b]` or `between groups [a,
  b]` (interior faces), a [group of the mesh](meshes.md#groups), the name of a
  body, a material or boundary id of a generator's mesh, or a condition on the
  centre of the cell or face. A Boundary block that does not say it is on the
  side, the group or the body of its name. The first Material block that holds
  owns a cell, the first Interface block an interior face; Boundary and Obstacle
  blocks add up.
- A line ends with `\` if the next one continues it; `#` starts a comment;
  `include FILE` reads another file.
- Files are UTF-8 text of at most 4 MiB, 20 000 statements and 20 000 bytes a
  line; names have at most 80 bytes, formulas 10 000 bytes and 200 brackets in
  brackets. Lengths lie between 1e-20 and 1e20, other numbers between 1e-45 and
  1e45. Pipes and devices are not read. A mesh that the free memory of the
  machine (or of its control group) cannot hold is refused, and so are more than
  1e9 steps.
- `--set 'Section/name=value'` changes an entry from the command line; a block
  is named in full: `--set 'Interface: all/toughness=2 J/m^2'`.
- Former words of entries and values (`maximum halvings`, `leapfrog`, `global`,
  `element-wise`, `chain`, `contacts alone`, `crossings`) are read as well.

## A whole scene: `prm/quickstart.prm`

```
END
  ./nsfd prm/quickstart.prm --print-parameters
  cat <<'END'
```

## Interfaces: entries of each law

What cohesive laws have in common is in `Interface: all` above; `unloading` belongs to
extrinsic ones. Of these entries `elastic` has `where`, the initial stress and those from
`friction` to `crack pressure`; `contact` has them as `Interface: notch` does; `rigid` and
`bonded` have `where` alone.

END
  sections "$scratch/parts.prm" 'Interface: .*'
  cat <<'END'

## Obstacles, rigid and anisotropic materials

Rigid materials have no viscosity and no initial stress. An obstacle with a cohesive
`law` has the entries of an Interface block of this law from `strength` to `broken`, but
for `opening viscosity` and `unloading`.

END
  sections "$scratch/parts.prm" '(Obstacle|Material): .*'
  cat <<'END'

## Large motions: rotations and strains of any size

`set motion = large` at the top; [large_motion.md](large_motion.md) says what
materials, contacts and schemes there are. `mass` and `principal inertia` stand in
place of those of the cells: in the plane they are per thickness, and the inertia
is one number, about z.

END
  sections "$scratch/large.prm" \
    '(Material|Interface: joint|Boundary|Obstacle|Contact|Pin)(: .*)?'
  cat <<'END'

## Time, with quasi-static steps

END
  sections "$scratch/static.prm" 'Time'
  cat <<'END'

## Observables

What they measure: [observables.md](observables.md).

END
  sections "$scratch/observed.prm" 'Observable: .*'
  cat <<'END'

## Several bodies, three dimensions

END
  sections "$scratch/bodies.prm" '(Mesh|Body: lower)'
  cat <<'END'

## A mesh of deal.II's generators

END
  sections "$scratch/generator.prm" 'Mesh'
  cat <<'END'

## One point: `nsfd law FILE.prm`

A file for `nsfd law` has Interface blocks (law, its entries, `friction`,
`friction exponent`), a section `Path` or `Bar`, and may have Constants and
`Output` (`directory`). Every block is driven along the same path; a named path
is in units of the final opening and slip of each law (in an endless tail, where
99 % of the toughness is gone). `nsfd law NAME --print-parameters` prints such a
file and `prm/paper` has some. On the command line `--path`, `--opening`, `--slip`,
`--reaction`, `--steps` and `--rule` stand for entries of `Path`, and `--set
name=value` for one of the law.

`curve.csv` has a row per step, in SI: `path` (number of the mark and fraction,
or `t`), `opening`, `slip`, `beta`, tractions `cohesive_normal`,
`cohesive_tangential`, `contact` (pressure), `friction`, energies per area
`stored`, `damage`, `friction_work` and the `work` of all tractions as the
cohesion rule counts it. Where a traction turns without motion, a place has two
rows.

A named path, with contact:

END
  path_of --path shear
  cat <<'END'

A list of marks, straight lines in between:

END
  path_of --opening '0, 1 um, 0, 0, 0, 3 um' \
    --reaction '0, 0, 0, 1 MPa, 0, 0'
  cat <<'END'

Formulas of `t`, which goes from 0 to 1:

END
  path_of --path formula --opening '1 um * sin(pi * t)'
  cat <<'END'

Marks from the rows of a CSV file (`--path FILE.csv`): `set type = file` and
`set file = FILE.csv`, with a header naming some of the columns `opening`,
`slip`, `reaction`, and numbers in SI.

### A bar in place of a path

With a section `Bar` the point is pulled open by an elastic bar of stiffness
`k = E/L` whose grip moves: the uniaxial example of [AM06] (section 10 of
[theory.md](theory.md)). `curve.csv` then has `time`, `grip` (U), `opening` (u),
`velocity`, the `pull` k (U - u) of the bar, the traction `cohesion` of the law,
`beta`, and energies per area: in the `bar`, `kinetic`, `stored` in the point,
`damage`, `viscous`, `left_over` (released by static jumps), and the `work` of the grip.
`bar.svg` shows the pull over u, `grip.svg` over U, `energies.svg` where the
work went. In equilibrium, with its jumps:

END
  law_section Bar --set 'Bar/stiffness=500 GPa/m'
  cat <<'END'

With a viscous point (`floor.svg`, `speeds.svg`: what viscosity takes):

END
  law_section Bar --set 'Bar/stiffness=500 GPa/m' --set Bar/mode=viscous \
    --set 'Bar/viscosity=10 MPa*s/m'
  cat <<'END'

With a mass (`slopes.svg`: when a step has one solution):

END
  law_section Bar --set 'Bar/stiffness=500 GPa/m' --set Bar/mode=dynamic \
    --set 'Bar/mass=1.25 kg/m^2' --set 'Bar/speed=1 cm/s' --set 'Bar/step=1 us'
  cat <<'END'

## A study, exact values

Sections `Study` and `Vary: name`: [studies.md](studies.md#section-study). A section
`Verification` names the `case` that a run is compared with
([adding.md](adding.md#a-verification-case)); `--print-parameters` of a scene of
`prm/verification` shows its entries.

## Meshes that change: `prm/benchmarks/branching.prm`

[adaptivity.md](adaptivity.md) says what the entries of an indicator mean.

END
  sections prm/benchmarks/branching.prm 'Adaptivity|Indicator: front'
  cat <<'END'

## Heat: `prm/benchmarks/brake_block.prm`

[materials.md](materials.md#heat) says what they mean.

END
  sections prm/benchmarks/brake_block.prm 'Interface: lining|Boundary: top'
  cat <<'END'

## Laws, meshes, schemes and solvers

`./nsfd --list` prints these and all other names: of [materials](materials.md),
[indicators](adaptivity.md#a-step), [observables](observables.md), shapes of
[obstacles](large_motion.md#entries) and [verification cases](adding.md#a-verification-case).

```
END
  # what the examples of laws say is above
  ./nsfd --list | awk '
    /^[^ ]/ { kind = $0 }
    kind !~ /^(interface law|cohesive law|mesh|time scheme|solver)$/ { next }
    /for example:/ { next }
    sub(/ +generator of deal\.II.*/, "") {
      generators = generators (generators == "" ? "" : ",") $0
      next
    }
    generators != "" {
      print "  of the generators of deal.II:"
      print generators
      generators = ""
    }
    { print }' | sed '${/^$/d}'
  printf '```\n'
} | once >"$scratch/parameters.md"
mv "$scratch/parameters.md" doc/parameters.md
echo "doc/parameters.md: $(wc -l <doc/parameters.md) lines"
