// Half of a block of 6 x 3 millimetres, see prm/benchmarks/xu_needleman_block.prm.
W = 3;
H = 1.5;
h = 0.12;
s = 0.01; // edges of 10 and 7 micrometres
x0 = 0.26;
n_x = 40;
n_y = 24;
Include "crossed_band.geo";
