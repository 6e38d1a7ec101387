// A unit square with edges from 1e-6 at one corner to 1 and, on top of it, a strip of
// triangles of aspect ratio 1e3, the smallest angle 0.06 degrees. See
// prm/stability/slivers.prm.
Point(1) = {0, 0, 0, 1e-6};
Point(2) = {1, 0, 0, 0.5};
Point(3) = {1, 1, 0, 0.5};
Point(4) = {0, 1, 0, 0.5};
Point(5) = {1, 1.001, 0, 1};
Point(6) = {0, 1.001, 0, 1};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Line(5) = {3, 5};
Line(6) = {6, 5};
Line(7) = {4, 6};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Curve Loop(2) = {3, 5, -6, -7};
Plane Surface(2) = {2};
Transfinite Curve {3, 5, 6, 7} = 2;
Transfinite Surface {2};
Physical Surface("plate") = {1, 2};
Physical Curve("bottom end") = {1};
Physical Curve("left end") = {4, 7};
Physical Curve("right end") = {2, 5};
