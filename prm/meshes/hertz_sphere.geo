// A quarter of a sphere of radius R that rests on the origin, fine where it
// touches: cells of size s as far as b from there, growing by a share g of the
// distance beyond. mm
If (!Exists(s)) s = 0.003; EndIf
If (!Exists(b)) b = 0.045; EndIf
If (!Exists(g)) g = 0.25; EndIf
If (!Exists(c)) c = 0.1; EndIf
SetFactory("OpenCASCADE");
R = 1;
Sphere(1) = {0, 0, R, R};
Box(2) = {0, 0, 0, R, R, 2 * R};
BooleanIntersection{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Field[1] = MathEval;
Field[1].F = Sprintf("Min(%g, %g + %g * Max(0, Sqrt(x*x + y*y + z*z) - %g))", c, s, g, b);
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
