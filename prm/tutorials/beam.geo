// A beam for three-point bending, 100 x 20 mm on a span of 80 mm, with a notch of 12 mm
// from below, in millimetres. See notched_beam.prm.
L = 100; S = 80; W = 20; a = 12;
coarse = 4;
fine = 0.25; // along the ligament: a fifth of the cohesive zone
foot = 0.5;  // half of the width of the supports and of the load
Point(1) = {0, 0, 0, coarse};
Point(2) = {(L-S)/2-foot, 0, 0, foot};
Point(3) = {(L-S)/2+foot, 0, 0, foot};
Point(4) = {L/2, 0, 0, coarse};
Point(5) = {(L+S)/2-foot, 0, 0, foot};
Point(6) = {(L+S)/2+foot, 0, 0, foot};
Point(7) = {L, 0, 0, coarse};
Point(8) = {L, W, 0, coarse};
Point(9) = {L/2+foot, W, 0, foot};
Point(10) = {L/2, W, 0, foot};
Point(11) = {L/2-foot, W, 0, foot};
Point(12) = {0, W, 0, coarse};
Point(13) = {L/2, a, 0, fine};
Point(14) = {L/2, (a+W)/2, 0, fine};
Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,4}; Line(4) = {4,5};
Line(5) = {5,6}; Line(6) = {6,7}; Line(7) = {7,8}; Line(8) = {8,9};
Line(9) = {9,10}; Line(10) = {10,11}; Line(11) = {11,12}; Line(12) = {12,1};
Line(13) = {4,13}; Line(14) = {13,14}; Line(15) = {14,10};
Curve Loop(1) = {1,2,3,13,14,15,10,11,12};
Curve Loop(2) = {4,5,6,7,8,9,-15,-14,-13};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Physical Surface("beam") = {1,2};
Physical Curve("notch") = {13};
Physical Curve("ligament") = {14,15};
Physical Curve("left support") = {2};
Physical Curve("right support") = {5};
Physical Curve("load") = {9,10};
