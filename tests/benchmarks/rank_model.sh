#!/bin/sh
# Strong and weak scaling to 1e5 ranks from what was measured on one and two:
#   sh tests/benchmarks/rank_model.sh strong|weak > TABLE.csv
# Machine: latency, bandwidth and the time of a reduction over a doubling of ranks
# are assumed, those of a cluster; the rest is measured (doc/performance.md says how).
set -eu
what=${1:-strong}
# seconds of work per point and step, exchanges and reductions per step, bytes per
# shared point and exchange
WORK=${WORK:-2.4e-6} EXCHANGES=${EXCHANGES:-68} REDUCTIONS=${REDUCTIONS:-189}
BYTES=${BYTES:-16}
LATENCY=${LATENCY:-1.5e-6} BANDWIDTH=${BANDWIDTH:-5e8} TREE=${TREE:-2e-6}
awk -v what="$what" -v work="$WORK" -v exchanges="$EXCHANGES" \
  -v reductions="$REDUCTIONS" -v bytes="$BYTES" -v latency="$LATENCY" \
  -v bandwidth="$BANDWIDTH" -v tree="$TREE" '
  function log2(x) { return log(x) / log(2) }
  # points of a square of quadrilaterals, two per face: 4 per cell; its rim 8 a cell side
  function step(points, ranks,   own, rim, each, sent, hidden, wait) {
    own = points / ranks
    rim = ranks > 1 ? 4 * sqrt(own) : 0
    each = ranks > 1 ? 4 * latency + rim * bytes / bandwidth : 0
    hidden = work * own / exchanges * 0.25 # what bodies take behind it
    sent = exchanges * (each > hidden ? each - hidden : 0)
    wait = reductions * tree * log2(ranks)
    return work * own + sent + wait
  }
  BEGIN {
    print "points,ranks,seconds,efficiency"
    for (size = 1e6; size <= 1.1e9; size *= 10)
      for (k = 0; k <= 17; ++k) {
        ranks = 2 ^ k
        points = what == "weak" ? size / 1e3 * ranks : size
        if (what == "weak" && size / 1e3 > 2e5) continue
        if (points / ranks < 16) continue
        t = step(points, ranks)
        best = what == "weak" ? step(points / ranks, 1) : step(points, 1) / ranks
        label = what == "weak" ? points / ranks " points per rank" \
          : sprintf("%.0e points", points)
        printf "%s,%d,%.4g,%.4f\n", label, ranks, t, best / t
      }
  }'
