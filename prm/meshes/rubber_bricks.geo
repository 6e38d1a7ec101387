// 1000 bricks of 200 x 100 mm with 4 x 2 cells each, 40 layers of 25, apart,
// each turned a little. See prm/benchmarks/rubber_bricks.prm. mm
For k In {0:999}
  i = k % 25;
  j = Floor(k / 25);
  x = 230 * i + 60 * (j % 2);
  y = 70 + 135 * j;
  c = Cos(0.15 * Sin(7 * k));
  s = Sin(0.15 * Sin(7 * k));
  p = 4 * k;
  Point(p + 1) = {x - 100 * c + 50 * s, y - 100 * s - 50 * c, 0};
  Point(p + 2) = {x + 100 * c + 50 * s, y + 100 * s - 50 * c, 0};
  Point(p + 3) = {x + 100 * c - 50 * s, y + 100 * s + 50 * c, 0};
  Point(p + 4) = {x - 100 * c - 50 * s, y - 100 * s + 50 * c, 0};
  Line(p + 1) = {p + 1, p + 2};
  Line(p + 2) = {p + 2, p + 3};
  Line(p + 3) = {p + 3, p + 4};
  Line(p + 4) = {p + 4, p + 1};
  Curve Loop(k + 1) = {p + 1, p + 2, p + 3, p + 4};
  Plane Surface(k + 1) = {k + 1};
  Transfinite Curve{p + 1, p + 3} = 5;
  Transfinite Curve{p + 2, p + 4} = 3;
EndFor
Transfinite Surface{:};
Recombine Surface{:};
Physical Surface("bricks") = Surface{:};
