// The strip of xu_needleman.geo with squares of four triangles in its band.
W = 0.9;
H = 0.4;
h = 0.1;
s = 0.01;
x0 = 0.26;
n_x = 36;
n_y = 24;
Include "crossed_band.geo";
