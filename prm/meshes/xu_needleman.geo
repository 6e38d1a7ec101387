// A strip of 0.9 x 0.8 around y = 0, in millimetres: a crack along y = 0, a band
// of small cells ahead of it. See prm/benchmarks/xu_needleman.prm.
fine = 0.005; // in the band
h = 0.1;      // far away
b = 0.03;     // half of the width of the band
Mesh.Algorithm = 5;
Point(1) = {0, -0.4, 0, h};
Point(2) = {0.9, -0.4, 0, h};
Point(3) = {0.9, 0, 0, h};
Point(4) = {0.9, 0.4, 0, h};
Point(5) = {0, 0.4, 0, h};
Point(6) = {0, 0, 0, h};
Point(7) = {0.28, 0, 0, fine};
Point(8) = {0.52, 0, 0, fine};
Point(9) = {0.28, -b, 0, fine};
Point(10) = {0.52, -b, 0, fine};
Point(11) = {0.52, b, 0, fine};
Point(12) = {0.28, b, 0, fine};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Line(7) = {6, 7};
Line(9) = {8, 3};
Line(10) = {7, 9};
Line(11) = {9, 10};
Line(12) = {10, 8};
Line(13) = {8, 11};
Line(14) = {11, 12};
Line(15) = {12, 7};
Curve Loop(1) = {10, 11, 12, 13, 14, 15};
Curve Loop(3) = {1, 2, -9, -12, -11, -10, -7, 6};
Curve Loop(4) = {9, 3, 4, 5, 7, -15, -14, -13};
Plane Surface(1) = {1};
If (Exists(line)) // the mesh goes along y = 0, see xu_needleman_line.geo
  Line(8) = {7, 8};
  Curve{8} In Surface{1};
EndIf
Plane Surface(3) = {3};
Plane Surface(4) = {4};
Physical Surface("band") = {1};
Physical Surface("around") = {3, 4};
Physical Curve("crack") = {7};
