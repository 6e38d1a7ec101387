// The grains of polycrystal.geo as columns, 12 um deep, in tetrahedra. See
// prm/benchmarks/grains_3d.prm.
depth = 12;
h = 14;
Include "polycrystal.geo";
For g In {1:grain}
  column[] = Extrude {0, 0, depth} { Surface{g}; };
  Physical Volume(Sprintf("grain %g", g)) = {column[1]};
EndFor
e = 0.01;
Physical Surface("left end") = {Surface In BoundingBox{-e, -e, -e, e, 60 + e, depth + e}};
Physical Surface("right end") = {Surface In BoundingBox{120 - e, -e, -e, 120 + e, 60 + e, depth + e}};
