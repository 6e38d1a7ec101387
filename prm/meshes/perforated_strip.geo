// A strip of 80 x 16, in millimetres, with a hole out of its axis and the two
// ligaments beside it, along which it breaks. See
// prm/benchmarks/perforated_strip.prm.
h = 2;
f = 0.5;
Point(1) = {0, 0, 0, h};
Point(2) = {40, 0, 0, f};
Point(3) = {80, 0, 0, h};
Point(4) = {80, 16, 0, h};
Point(5) = {40, 16, 0, f};
Point(6) = {0, 16, 0, h};
Point(10) = {40, 9, 0, f};
Point(11) = {40, 6, 0, f};
Point(12) = {43, 9, 0, f};
Point(13) = {40, 12, 0, f};
Point(14) = {37, 9, 0, f};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Circle(11) = {11, 10, 12};
Circle(12) = {12, 10, 13};
Circle(13) = {13, 10, 14};
Circle(14) = {14, 10, 11};
Line(20) = {2, 11};
Line(21) = {13, 5};

Curve Loop(1) = {2, 3, 4, -21, -12, -11, -20};
Curve Loop(2) = {1, 20, -14, -13, 21, 5, 6};
Plane Surface(1) = {1};
Plane Surface(2) = {2};

Physical Surface("strip") = {1, 2};
Physical Curve("ligaments") = {20, 21};
Physical Curve("left end") = {6};
Physical Curve("right end") = {3};
