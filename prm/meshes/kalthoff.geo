// Upper half of the plate of Kalthoff and Winkler, 100 x 100, in millimetres:
// the symmetry line is the lower side, the notch a line of 50 at the height 25.
// See prm/benchmarks/kalthoff.prm.
h = 4.5;
If (!Exists(fine))
  fine = 1.6; // where the crack may go
EndIf
Mesh.Algorithm = 5; // Delaunay: no rows of equal triangles, which lead a crack
Point(1) = {0, 0, 0, h};
Point(2) = {50, 0, 0, h};
Point(3) = {100, 0, 0, h};
Point(4) = {100, 100, 0, fine};
Point(5) = {40, 100, 0, fine};
Point(6) = {0, 100, 0, h};
Point(7) = {0, 25, 0, h};
Point(8) = {50, 25, 0, fine}; // the tip of the notch
Point(9) = {100, 25, 0, fine};
Point(10) = {43, 37, 0, fine};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 9};
Line(4) = {9, 4};
Line(5) = {4, 5};
Line(6) = {5, 6};
Line(8) = {7, 1};
Line(9) = {7, 8};
If (Exists(open)) // crack faces that nothing joins, see kalthoff_open.geo
  Point(17) = {0, 25, 0, h};
  Line(19) = {17, 8};
  lip = 19;
  Line(7) = {6, 17};
Else
  lip = 9;
  Line(7) = {6, 7};
EndIf
Line(10) = {8, 9};
Line(11) = {8, 10};
Line(12) = {10, 5};

Curve Loop(1) = {1, 2, 3, -10, -9, 8};
Curve Loop(2) = {10, 4, 5, -12, -11};
Curve Loop(3) = {lip, 11, 12, 6, 7};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};

If (Exists(projectile)) // a block that lies against the edge, see kalthoff_projectile.geo
  Point(21) = {-projectile, 0, 0, h};
  Point(22) = {-projectile, 25, 0, h};
  Line(21) = {21, 1};
  Line(22) = {7, 22};
  Line(23) = {22, 21};
  Curve Loop(4) = {21, -8, 22, 23};
  Plane Surface(4) = {4};
  Physical Surface("projectile") = {4};
EndIf

Physical Surface("below the notch") = {1};
Physical Surface("ahead of the notch") = {2};
Physical Surface("above the notch") = {3};
Physical Curve("notch") = {9};
If (Exists(projectile))
  Physical Curve("symmetry") = {1, 2, 21};
Else
  Physical Curve("symmetry") = {1, 2};
EndIf
Physical Curve("impacted edge") = {8};
