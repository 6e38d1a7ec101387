// A block of 150 x 100, in millimetres, with cells of the size s along the middle
// 5 mm of its lower side. They grow to `base` along the rest of it, and to 8 upwards.
// See prm/reference/sliding_block.prm.
If (!Exists(s))
  s = 0.04;
EndIf
If (!Exists(base))
  base = 0.5;
EndIf
Mesh.Algorithm = 5;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Point(1) = {0, 0, 0};
Point(2) = {72.5, 0, 0};
Point(3) = {77.5, 0, 0};
Point(4) = {150, 0, 0};
Point(5) = {150, 100, 0};
Point(6) = {0, 100, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6};
Plane Surface(1) = {1};
Transfinite Curve{2} = 5 / s + 1;
Field[2] = MathEval; // by the distance to the middle
Field[2].F = Sprintf("%g + 0.1 * Sqrt(y^2 + ((Abs(x - 75) - 2.5 + Abs(Abs(x - 75) - 2.5)) / 2)^2)", s);
Field[3] = MathEval;
Field[3].F = Sprintf("%g + 0.1 * y", base);
Field[4] = MathEval;
Field[4].F = "8";
Field[5] = Min;
Field[5].FieldsList = {2, 3, 4};
Background Field = 5;
If (Exists(layers)) // 5.5 thick, see sliding_block_3d.geo
  out() = Extrude{0, 0, 5.5}{ Surface{1}; Layers{layers}; };
  Physical Volume("block") = {out(1)};
Else
  Physical Surface("block") = {1};
EndIf
