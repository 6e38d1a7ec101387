# resistance.awk - the resistance curve of prm/reference/ductile.prm.
#
#   awk -F, -f tests/benchmarks/resistance.awk [-v top=1.42] [-v rise=1] \
#     output/ductile/history.csv
#
# Columns: broken length over R_0, what damage took over the toughness (the advance a
# of the crack), release rate over toughness. The outer side, of the radius R, holds
# the field of a tip at X; a tip at a gets 1 - (a - X) / R of its release rate. In
# antiplane shear that is exact to first order: on |z| = R the real multiple
# (1 - (a - X) / (2 R)) of Im (z - a)^(1/2) has the values of Im (z - X)^(1/2).
BEGIN {
  if (!top) top = 1.42
  if (!rise) rise = 1
  if (!V) V = 0.015
  if (!t1) t1 = 120
  if (!R) R = 50
  half = 1.5 * atan2(0, -1) * (1 - 0.09) * 0.003 # of the toughness: y > 0 alone
}
$2 + 0 > t1 {
  X = V * ($2 - t1)
  a = $7 / half
  G = (1 + (top - 1) * (1 - exp(-X / rise))) * (1 - (a - X) / R)
  if ($15 != last) printf "%.4f %.4f %.4f\n", $15, a, G
  last = $15
}
