// A plate of 20 x 10, in millimetres, with a hole, a short crack at its edge
// and a round inclusion. See prm/benchmarks/plate_with_hole.prm.
h = 0.5;
Point(1) = {0, 0, 0, h};
Point(2) = {20, 0, 0, h};
Point(3) = {20, 10, 0, h};
Point(4) = {0, 10, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};

// the hole: radius 1.5 around (6, 5)
Point(10) = {6, 5, 0, h};
Point(11) = {7.5, 5, 0, h};
Point(12) = {6, 6.5, 0, h};
Point(13) = {4.5, 5, 0, h};
Point(14) = {6, 3.5, 0, h};
Circle(11) = {11, 10, 12};
Circle(12) = {12, 10, 13};
Circle(13) = {13, 10, 14};
Circle(14) = {14, 10, 11};

// the inclusion: radius 1.5 around (13, 6)
Point(20) = {13, 6, 0, h};
Point(21) = {14.5, 6, 0, h};
Point(22) = {13, 7.5, 0, h};
Point(23) = {11.5, 6, 0, h};
Point(24) = {13, 4.5, 0, h};
Circle(21) = {21, 20, 22};
Circle(22) = {22, 20, 23};
Circle(23) = {23, 20, 24};
Circle(24) = {24, 20, 21};

// the crack: upwards from the edge of the hole
Point(30) = {6, 7.5, 0, h};
Line(30) = {12, 30};

Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {11, 12, 13, 14};
Curve Loop(3) = {21, 22, 23, 24};
Plane Surface(1) = {1, 2, 3};
Curve{30} In Surface{1};
Plane Surface(2) = {3};

Physical Surface("matrix") = {1};
Physical Surface("inclusion") = {2};
Physical Curve("hole") = {11, 12, 13, 14};
Physical Curve("rim") = {21, 22, 23, 24};
Physical Curve("crack") = {30};
Physical Curve("left end") = {4};
Physical Curve("right end") = {2};
