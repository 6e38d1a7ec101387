// Polycrystal of 24 grains in a rectangle of 120 x 60, in micrometres: rows of
// hexagons, half of them at the sides, whose corners have been moved a little.
// Grains are named "grain 1" to "grain 22", row by row. See
// prm/benchmarks/grains.prm.
rows = 4;
n = 10;      // half grains along a row; even
// polycrystal_3d.geo sets these itself
If (!Exists(depth))
  depth = 0; // above 0: the grains are columns
  h = 4;     // size of the cells
EndIf
a = 120 / n;
b = 60 / rows;

// corners k = 0..n of the lines r = 0..rows between rows
For r In {0:rows}
  For k In {0:n}
    inside = (r > 0 && r < rows);
    up = ((k + r) % 2 == 0) ? 1 : -1;
    dx = (k > 0 && k < n) ? 0.18 * a * Sin(12.9 * k + 78.2 * r) : 0;
    dy = inside * (0.2 * b * up + 0.12 * b * Sin(39.3 * k + 11.1 * r));
    Point(1 + r * (n + 1) + k) = {k * a + dx, r * b + dy, 0, h};
  EndFor
EndFor

// along the lines, and across a row where the line below goes up
For r In {0:rows}
  For k In {0:n-1}
    Line(1000 + r * n + k) = {1 + r * (n + 1) + k, 2 + r * (n + 1) + k};
  EndFor
EndFor
For r In {0:rows-1}
  For k In {0:n}
    If ((k + r) % 2 == 0 || k == 0 || k == n)
      Line(2000 + r * (n + 1) + k) =
        {1 + r * (n + 1) + k, 1 + (r + 1) * (n + 1) + k};
    EndIf
  EndFor
EndFor

// the grains: from one crossing line to the next
grain = 0;
For r In {0:rows-1}
  first = 0;
  For k In {1:n}
    If ((k + r) % 2 == 0 || k == n)
      grain += 1;
      edges[] = {2000 + r * (n + 1) + k};
      For m In {0:k-first-1}
        edges[] += {-(1000 + (r + 1) * n + k - 1 - m)};
      EndFor
      edges[] += {-(2000 + r * (n + 1) + first)};
      For m In {first:k-1}
        edges[] += {1000 + r * n + m};
      EndFor
      Curve Loop(grain) = edges[];
      Plane Surface(grain) = {grain};
      first = k;
    EndIf
  EndFor
EndFor

left[] = {};
right[] = {};
For r In {0:rows-1}
  left[] += {2000 + r * (n + 1)};
  right[] += {2000 + r * (n + 1) + n};
EndFor
If (depth == 0)
  For g In {1:grain}
    Physical Surface(Sprintf("grain %g", g)) = {g};
  EndFor
  Physical Curve("left end") = left[];
  Physical Curve("right end") = right[];
EndIf
