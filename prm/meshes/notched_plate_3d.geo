// A plate of 20 x 10 x 4, in millimetres, with a V-shaped notch across its lower
// side, a ball inside it and a slanted crack in the shape of a disc. See
// prm/benchmarks/notched_plate_3d.prm.
SetFactory("OpenCASCADE");
h = 1.5;
fine = 0.9; // along the tip of the notch

// the notch, cut out of the plate
Point(1) = {6, 0, 0};
Point(2) = {7, 2.5, 0};
Point(3) = {8, 0, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};
wedge[] = Extrude {0, 0, 4} { Surface{1}; };
Box(10) = {0, 0, 0, 20, 10, 4};
BooleanDifference(11) = { Volume{10}; Delete; }{ Volume{wedge[1]}; Delete; };

// the ball and the crack
Sphere(12) = {8.5, 6, 2, 1.5};
Disk(100) = {14.5, 5, 2, 1.5};
Rotate {{0, 1, 0}, {14.5, 5, 2}, Pi/2} { Surface{100}; }
Rotate {{0, 0, 1}, {14.5, 5, 2}, -Pi/6} { Surface{100}; }
BooleanFragments{ Volume{11}; Delete; }{ Volume{12}; Surface{100}; Delete; }

e = 0.01;
ball[] = Volume In BoundingBox{7 - e, 4.5 - e, 0.5 - e, 10 + e, 7.5 + e, 3.5 + e};
plate[] = Volume{:};
plate[] -= ball[];
rim[] = Surface In BoundingBox{7 - e, 4.5 - e, 0.5 - e, 10 + e, 7.5 + e, 3.5 + e};
crack[] = Surface In BoundingBox{13 - e, 3.5 - e, 0.5 - e, 16 + e, 6.5 + e, 3.5 + e};
left[] = Surface In BoundingBox{-e, -e, -e, e, 10 + e, 4 + e};
right[] = Surface In BoundingBox{20 - e, -e, -e, 20 + e, 10 + e, 4 + e};
Physical Volume("matrix") = plate[];
Physical Volume("inclusion") = ball[];
Physical Surface("rim") = rim[];
Physical Surface("crack") = crack[];
Physical Surface("left end") = left[];
Physical Surface("right end") = right[];

MeshSize{:} = h;
tip[] = Point In BoundingBox{7 - e, 2.5 - e, -e, 7 + e, 2.5 + e, 4 + e};
MeshSize{tip[]} = fine;
