// The block of xu_needleman_block.geo with squares of 5 micrometres.
W = 3;
H = 1.5;
h = 0.12;
s = 0.005; // edges of 5 and 3.5 micrometres
x0 = 0.28;
n_x = 44;
n_y = 20;
Include "crossed_band.geo";
