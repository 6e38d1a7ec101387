// A plate of 20 x 10, in millimetres, with a V-shaped notch in its lower side,
// a round inclusion and a slanted crack. See prm/benchmarks/notched_plate.prm.
h = 0.7;
fine = 0.35; // at the tip of the notch
Point(1) = {0, 0, 0, h};
Point(2) = {6.25, 0, 0, h};
Point(3) = {7, 2.5, 0, fine}; // the tip
Point(4) = {7.75, 0, 0, h};
Point(5) = {20, 0, 0, h};
Point(6) = {20, 10, 0, h};
Point(7) = {0, 10, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Line(7) = {7, 1};

// the inclusion: radius 1.25 around (8.5, 6)
Point(20) = {8.5, 6, 0, h};
Point(21) = {9.75, 6, 0, h};
Point(22) = {8.5, 7.25, 0, h};
Point(23) = {7.25, 6, 0, h};
Point(24) = {8.5, 4.75, 0, h};
Circle(21) = {21, 20, 22};
Circle(22) = {22, 20, 23};
Circle(23) = {23, 20, 24};
Circle(24) = {24, 20, 21};

// the crack, inside the plate
Point(30) = {14, 4, 0, fine};
Point(31) = {15.5, 6.5, 0, fine};
Line(30) = {30, 31};

Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7};
Curve Loop(2) = {21, 22, 23, 24};
Plane Surface(1) = {1, 2};
Curve{30} In Surface{1};
Plane Surface(2) = {2};

Physical Surface("matrix") = {1};
Physical Surface("inclusion") = {2};
Physical Curve("notch") = {2, 3};
Physical Curve("rim") = {21, 22, 23, 24};
Physical Curve("crack") = {30};
Physical Curve("left end") = {7};
Physical Curve("right end") = {5};
