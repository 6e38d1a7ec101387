// A beam for three-point bending, 120 x 25 mm on a span of 100 mm, notched to 10 mm, in
// millimetres. See prm/benchmarks/beam.prm and beam_slowly.prm.
L = 120; S = 100; H = 25; a = 10; c = 1;
coarse = 3;
fine = 0.4; // along the ligament
Point(1) = {0, 0, 0, coarse};
Point(2) = {(L-S)/2-c, 0, 0, coarse};
Point(3) = {(L-S)/2+c, 0, 0, coarse};
Point(4) = {L/2, 0, 0, 1};
Point(5) = {(L+S)/2-c, 0, 0, coarse};
Point(6) = {(L+S)/2+c, 0, 0, coarse};
Point(7) = {L, 0, 0, coarse};
Point(8) = {L, H, 0, coarse};
Point(9) = {L/2+c, H, 0, fine};
Point(10) = {L/2, H, 0, fine};
Point(11) = {L/2-c, H, 0, fine};
Point(12) = {0, H, 0, coarse};
Point(13) = {L/2, a, 0, fine};
Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,4}; Line(4) = {4,5};
Line(5) = {5,6}; Line(6) = {6,7}; Line(7) = {7,8}; Line(8) = {8,9};
Line(9) = {9,10}; Line(10) = {10,11}; Line(11) = {11,12}; Line(12) = {12,1};
Line(13) = {4,13}; Line(14) = {13,10};
Curve Loop(1) = {1,2,3,13,14,10,11,12};
Curve Loop(2) = {4,5,6,7,8,9,-14,-13};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Physical Surface("PMMA") = {1,2};
Physical Curve("notch") = {13};
Physical Curve("ligament") = {14};
Physical Curve("left support") = {2};
Physical Curve("right support") = {5};
Physical Curve("load") = {9,10};
