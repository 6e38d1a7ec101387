# Compares the history.csv of a crack with that of its reference, given first:
#   awk -v toughness=G -v from=T -f tip_path.awk REFERENCE RUN
# prints L1 errors over time of the tip and of the work of fracture D / G, the
# error of the kinetic energy at the end, the error (root mean square over the
# steps after `from`) of the speed dD/dt / G, and of the run alone D / (G a).
#
# The broken length a is a staircase: when a point breaks the tip is there, in
# the middle of its weight. Between two such times the tip moves evenly. The
# first to break is the point at the old tip, which has lost no length yet.
# The function (x, y) of file f at t.
function value_at(f, t, x, y, n, k, part) {
  while (at[f] < n - 1 && x[f, at[f] + 1] < t)
    ++at[f]
  k = at[f]
  if (t >= x[f, n])
    return y[f, n]
  part = (t - x[f, k]) / (x[f, k + 1] - x[f, k])
  return y[f, k] + part * (y[f, k + 1] - y[f, k])
}
# L1 difference up to `end`, over the norm of the reference.
function error_of(x, y, n1, n2, end, parts, i, t, a, b, difference, sum) {
  parts = 1000
  at[1] = at[2] = 1
  for (i = 0; i < parts; ++i) {
    t = (i + 0.5) * end / parts
    a = value_at(1, t, x, y, n1)
    b = value_at(2, t, x, y, n2)
    difference += a > b ? a - b : b - a
    sum += a
  }
  return difference / sum
}
BEGIN { FS = "," }
FNR == 1 {
  ++f
  for (i = 1; i <= NF; ++i)
    column[$i] = i
  time[f, 1] = event[f, 1] = work[f, 1] = tip[f, 1] = 0
  n[f] = events[f] = 1
  broken = 0
  next
}
$column["step"] == 0 { next } # as above
{
  k = ++n[f]
  time[f, k] = $column["time"]
  work[f, k] = $column["damage"] / toughness
  kinetic[f] = $column["kinetic"]
  a = $column["broken_area"]
  if (a > broken) {
    k = ++events[f]
    event[f, k] = $column["time"]
    tip[f, k] = k == 2 ? 0 : (a + broken) / 2
    broken = a
  }
}
END {
  # after the last point that broke nothing is known; a tip that has not moved
  # is wrong all the time
  end = event[1, events[1]]
  if (tip[2, events[2]] > 0 && event[2, events[2]] < end)
    end = event[2, events[2]]
  at[1] = 1
  for (k = 2; k <= n[2]; ++k) {
    reference = value_at(1, time[2, k], time, work, n[1])
    if (time[2, k - 1] > from) {
      step = work[2, k] - work[2, k - 1]
      h = time[2, k] - time[2, k - 1]
      squares += (step - (reference - last)) ^ 2 / h
      window += h
      length_in += reference - last
    }
    last = reference
  }
  printf "%.2e,%.2e,%.2e,%.2e,%.4f\n",
         error_of(event, tip, events[1], events[2], end),
         error_of(time, work, n[1], n[2], time[2, n[2]]),
         kinetic[2] / kinetic[1] - 1,
         sqrt(squares / window) / (length_in / window),
         (broken > 0 ? work[2, n[2]] / broken : 0)
}
