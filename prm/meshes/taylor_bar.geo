// A quarter of a bar of radius 3.2 and length 32.4, in millimetres, its foot at
// z = 0. See prm/benchmarks/taylor_bar.prm.
If (!Exists(n))
  n = 2;  // cells along each half of the circle
EndIf
If (!Exists(m))
  m = 6 * n; // layers of the quarter at the foot; n more above
EndIf
r = 3.2;
l = 32.4;
s = 0.55; // sides of the square in the middle over the radius
c = Sqrt(0.5);

Point(1) = {0, 0, 0};
Point(2) = {s * r, 0, 0};
Point(3) = {0.85 * s * r, 0.85 * s * r, 0};
Point(4) = {0, s * r, 0};
Point(5) = {r, 0, 0};
Point(6) = {c * r, c * r, 0};
Point(7) = {0, r, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(5) = {2, 5};
Line(6) = {3, 6};
Line(7) = {4, 7};
Circle(8) = {5, 1, 6};
Circle(9) = {6, 1, 7};
Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {5, 8, -6, -2};
Curve Loop(3) = {6, 9, -7, -3};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Transfinite Curve {1, 2, 3, 4, 8, 9} = n + 1;
Transfinite Curve {5, 6, 7} = (n == 1 ? 2 : n);
Transfinite Surface {1, 2, 3};
Recombine Surface {1, 2, 3};
Extrude {0, 0, l} {
  Surface{1, 2, 3};
  Layers{{m, m + n}, {0.25, 1}};
  Recombine;
}
