// The discs of prm/benchmarks/elastic_cradle.prm with larger cells.
s = 0.008;
b = 0.03;
g = 0.3;
Include "cradle.geo";
