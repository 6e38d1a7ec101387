// The upper half of a plate of 40 x 60, in millimetres, with a rhombus as a hole:
// a quarter and its mirror image, joined along x = 0. gamma is the angle of its upper corner (degrees), and the sides are
// 7 mm long, so that half a diagonal is 4.95 mm with 90 degrees. Nodes are s apart
// in the first mm above the corner. See prm/reference/rhombus.prm.
If (!Exists(gamma))
  gamma = 90;
EndIf
If (!Exists(s))
  s = 0.002;
EndIf
Mesh.Algorithm = 5;
Geometry.CopyMeshingMethod = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
side = 7;
a = side * Sin(gamma / 2 * Pi / 180);
b = side * Cos(gamma / 2 * Pi / 180);
Point(1) = {a, 0, 0};
Point(2) = {20, 0, 0};
Point(3) = {20, 30, 0};
Point(4) = {0, 30, 0};
Point(5) = {0, b + 1, 0};
Point(6) = {0, b, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Transfinite Curve{5} = 1 / s + 1;
image() = Symmetry{1, 0, 0, 0}{ Duplicata{ Surface{1}; } };
Field[2] = MathEval; // by the distance to that millimetre
Field[2].F = Sprintf("%g + 0.2 * Sqrt(x^2 + ((Abs(y - %g) - 0.5 + Abs(Abs(y - %g) - 0.5)) / 2)^2)", s, b + 0.5, b + 0.5);
Field[3] = MathEval;
Field[3].F = "2";
Field[4] = Min;
Field[4].FieldsList = {2, 3};
Background Field = 4;
Physical Surface("right") = {1};
Physical Surface("left") = {image()};
Physical Curve("ligament") = {4, 5};
