// Cells of half the size, see ductile.geo.
s = 0.04;
Include "ductile.geo";
