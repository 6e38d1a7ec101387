// The bar of prm/benchmarks/taylor_bar.prm with a ninth of its cells across.
n = 1;
m = 4;
Include "taylor_bar.geo";
