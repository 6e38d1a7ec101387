// A block of 1 x 1 x 2, in millimetres: two materials on each other.
h = 0.5;
Point(1) = {0, 0, 0, h};
Point(2) = {1, 0, 0, h};
Point(3) = {1, 1, 0, h};
Point(4) = {0, 1, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
If (!Exists(hexes))
  hexes = 1;
EndIf
If (hexes)
  Transfinite Surface{1};
  Recombine Surface{1};
  lower[] = Extrude{0, 0, 1}{Surface{1}; Layers{2}; Recombine;};
  upper[] = Extrude{0, 0, 1}{Surface{lower[0]}; Layers{2}; Recombine;};
Else
  lower[] = Extrude{0, 0, 1}{Surface{1};};
  upper[] = Extrude{0, 0, 1}{Surface{lower[0]};};
EndIf
Physical Volume("lower", 1) = {lower[1]};
Physical Volume("upper", 2) = {upper[1]};
Physical Surface("ground", 1) = {1};
Physical Surface("seam", 2) = {lower[0]};
Physical Surface("lid", 3) = {upper[0]};
