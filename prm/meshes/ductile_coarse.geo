// Fewer cells, see ductile.geo.
s = 0.16;
g = 0.5;
Include "ductile.geo";
