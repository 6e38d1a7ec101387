// 36 bricks of 200 x 100 x 60 mm, apart, each turned about an axis of its own.
// See prm/benchmarks/heap_of_bricks.prm.
SetFactory("OpenCASCADE");
For k In {0:35}
  i = k % 3; j = Floor(k / 3) % 2; level = Floor(k / 6);
  x = 240 * i + 20 * (level % 3); y = 240 * j + 30 * (level % 2);
  z = 150 + 240 * level;
  v = newv;
  Box(v) = {x - 100, y - 50, z - 30, 200, 100, 60};
  Rotate {{Sin(5 * k + 1), Sin(3 * k), Sin(7 * k + 2)}, {x, y, z}, 2.4 * k + 1} {
    Volume{v};
  }
EndFor
Transfinite Curve{:} = 2;
Transfinite Surface{:};
Recombine Surface{:};
Transfinite Volume{:};
Physical Volume("bricks") = Volume{:};
