// Plate of 100 x 40 with a notch of 50 at mid height, in millimetres, Delaunay
// triangles: no rows that lead a crack. See prm/benchmarks/branching_delaunay.prm.
h = 3;
If (!Exists(fine))
  fine = 1.4; // where the crack may go
EndIf
Mesh.Algorithm = 5;
Point(1) = {0, 0, 0, h};
Point(2) = {42, 0, 0, fine};
Point(3) = {100, 0, 0, fine};
Point(4) = {100, 40, 0, fine};
Point(5) = {42, 40, 0, fine};
Point(6) = {0, 40, 0, h};
Point(7) = {0, 20, 0, h};
Point(8) = {50, 20, 0, fine}; // the tip of the notch
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 1};
Line(8) = {7, 8};
Line(9) = {8, 2};
Line(10) = {8, 5};
Curve Loop(1) = {1, -9, -8, 7};
Curve Loop(2) = {8, 10, 5, 6};
Curve Loop(3) = {2, 3, 4, -10, 9};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Physical Surface("below the notch") = {1};
Physical Surface("above the notch") = {2};
Physical Surface("ahead of the notch") = {3};
Physical Curve("notch") = {8};
