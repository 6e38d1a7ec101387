// Halves of three discs of radius R in a row along y, a hair apart, fine where
// they meet: cells of size s as far as b from there, growing by a share g of the
// distance beyond. mm
If (!Exists(s)) s = 0.005; EndIf
If (!Exists(b)) b = 0.04; EndIf
If (!Exists(g)) g = 0.2; EndIf
R = 1;
gap = 1e-6;
For k In {0:2}
  y = k * (2 * R + gap); // of its lowest place
  p = 10 * k;
  Point(p + 1) = {0, y, 0};
  Point(p + 2) = {0, y + R, 0};
  Point(p + 3) = {R, y + R, 0};
  Point(p + 4) = {0, y + 2 * R, 0};
  Circle(p + 1) = {p + 1, p + 2, p + 3};
  Circle(p + 2) = {p + 3, p + 2, p + 4};
  Line(p + 3) = {p + 4, p + 2};
  Line(p + 4) = {p + 2, p + 1};
  Curve Loop(p + 1) = {p + 1, p + 2, p + 3, p + 4};
  Plane Surface(p + 1) = {p + 1};
EndFor
Physical Surface("lower") = {1};
Physical Surface("middle") = {11};
Physical Surface("upper") = {21};
Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * Max(0, Min(Sqrt(x*x + (y-%g)*(y-%g)), Sqrt(x*x + (y-%g)*(y-%g))) - %g)", s, g, 2 * R, 2 * R, 4 * R, 4 * R, b);
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
