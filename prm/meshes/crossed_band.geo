// A block of the half height H, from 0 to W along x, in millimetres, with a band
// of n_x by n_y squares of the length s around y = 0, from x0 on, each cut into four
// triangles by its diagonals; n_y is even. The mesh goes along y = 0 all the way.
// Cells grow to h away from the band. See xu_needleman_block.geo.
Mesh.Algorithm = 5;
Mesh.MeshSizeExtendFromBoundary = 0;
x1 = x0 + n_x * s;
b = n_y * s / 2;
Field[1] = Box; // cells grow away from the band
Field[1].VIn = s;
Field[1].VOut = h;
Field[1].Thickness = 4 * h;
Field[1].XMin = x0;
Field[1].XMax = x1;
Field[1].YMin = -b;
Field[1].YMax = b;
Background Field = 1;

points = 1000;
across = 100000; // lines along x
along = 200000;  // lines along y
For j In {0:n_y}
  For i In {0:n_x}
    Point(points + j * (n_x + 1) + i) = {x0 + i * s, -b + j * s, 0, s};
  EndFor
EndFor
For j In {0:n_y}
  For i In {0:n_x - 1}
    Line(across + j * n_x + i) = {points + j * (n_x + 1) + i, points + j * (n_x + 1) + i + 1};
  EndFor
EndFor
For j In {0:n_y - 1}
  For i In {0:n_x}
    Line(along + j * (n_x + 1) + i) = {points + j * (n_x + 1) + i, points + (j + 1) * (n_x + 1) + i};
  EndFor
EndFor
Transfinite Curve{across : across + (n_y + 1) * n_x - 1} = 2;
Transfinite Curve{along : along + n_y * (n_x + 1) - 1} = 2;
band() = {};
For j In {0:n_y - 1}
  For i In {0:n_x - 1}
    k = 1000 + j * n_x + i;
    Curve Loop(k) = {across + j * n_x + i, along + j * (n_x + 1) + i + 1, -(across + (j + 1) * n_x + i), -(along + j * (n_x + 1) + i)};
    Plane Surface(k) = {k};
    Point(500000 + k) = {x0 + (i + 0.5) * s, -b + (j + 0.5) * s, 0, s};
    Point{500000 + k} In Surface{k};
    band() += {k};
  EndFor
EndFor
below() = {}; above() = {}; right_below() = {}; right_above() = {}; left_below() = {}; left_above() = {};
For i In {0:n_x - 1}
  below() += {across + i};
  above() += {-(across + n_y * n_x + i)};
EndFor
For j In {0:n_y / 2 - 1}
  right_below() += {along + j * (n_x + 1) + n_x};
  left_below() += {along + j * (n_x + 1)};
EndFor
For j In {n_y / 2:n_y - 1}
  right_above() += {along + j * (n_x + 1) + n_x};
  left_above() += {along + j * (n_x + 1)};
EndFor
middle = points + n_y / 2 * (n_x + 1);
Point(1) = {0, -H, 0, h};
Point(2) = {W, -H, 0, h};
Point(3) = {W, 0, 0, h};
Point(4) = {W, H, 0, h};
Point(5) = {0, H, 0, h};
Point(6) = {0, 0, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Line(7) = {6, middle};
Line(8) = {middle + n_x, 3};
// around the band, below and above
Curve Loop(1) = {1, 2, -8, -right_below(), -below(), left_below(), -7, 6};
Plane Surface(1) = {1};
Curve Loop(2) = {8, 3, 4, 5, 7, left_above(), -above(), -right_above()};
Plane Surface(2) = {2};
Physical Surface("band") = {band()};
Physical Surface("around") = {1, 2};
Physical Curve("middle") = {5, 6};
Physical Curve("bottom") = {1};
Physical Curve("top") = {4};
