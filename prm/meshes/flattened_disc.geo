// A disc with two flats, in millimetres, diameter 50 around 0: the flats face
// up and down and are seen from the centre under 20 degrees. See
// prm/benchmarks/brazilian.prm.
h = 2.5;
R = 25;
a = 10 * Pi / 180;
Mesh.Algorithm = 5;
Point(1) = {0, 0, 0, h};
Point(2) = {R * Sin(a), R * Cos(a), 0, h};
Point(3) = {-R * Sin(a), R * Cos(a), 0, h};
Point(4) = {-R * Sin(a), -R * Cos(a), 0, h};
Point(5) = {R * Sin(a), -R * Cos(a), 0, h};
Point(6) = {R, 0, 0, h};
Point(7) = {-R, 0, 0, h};
Line(1) = {2, 3};
Circle(2) = {3, 1, 7};
Circle(3) = {7, 1, 4};
Line(4) = {4, 5};
Circle(5) = {5, 1, 6};
Circle(6) = {6, 1, 2};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Physical Surface("disc") = {1};
Physical Curve("upper flat") = {1};
Physical Curve("lower flat") = {4};
