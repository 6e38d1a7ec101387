// Halves of two discs of radius R that touch in the origin, fine there: cells
// of size s as far as b from it, growing by a share g of the distance beyond.
// mm
If (!Exists(s)) s = 0.002; EndIf
If (!Exists(b)) b = 0.03; EndIf
If (!Exists(g)) g = 0.15; EndIf
R = 1;
For k In {0:1}
  c = 1 - 2 * k; // of the upper one and of the lower one
  p = 10 * k;
  Point(p + 1) = {0, 0, 0};
  Point(p + 2) = {0, c * R, 0};
  Point(p + 3) = {R, c * R, 0};
  Point(p + 4) = {0, 2 * c * R, 0};
  Circle(p + 1) = {p + 1, p + 2, p + 3};
  Circle(p + 2) = {p + 3, p + 2, p + 4};
  Line(p + 3) = {p + 4, p + 2};
  Line(p + 4) = {p + 2, p + 1};
  Curve Loop(p + 1) = {p + 1, p + 2, p + 3, p + 4};
  Plane Surface(p + 1) = {p + 1};
EndFor
Physical Surface("upper") = {1};
Physical Surface("lower") = {11};
Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g * Max(0, Sqrt(x*x + y*y) - %g)", s, g, b);
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
