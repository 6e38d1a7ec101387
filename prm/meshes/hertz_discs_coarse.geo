// The discs of prm/benchmarks/hertz_discs.prm with cells twice as large.
s = 0.004;
b = 0.03;
g = 0.2;
Include "hertz_discs.geo";
