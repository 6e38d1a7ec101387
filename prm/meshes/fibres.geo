// Three glass fibres in a square of epoxy, in micrometres. See
// prm/benchmarks/composite.prm.
SetFactory("OpenCASCADE");
W = 100; h = 3;
Rectangle(1) = {0, 0, 0, W, W};
Disk(2) = {30, 50, 0, 15}; Disk(3) = {70, 60, 0, 15}; Disk(4) = {50, 20, 0, 12};
BooleanFragments{ Surface{1}; Delete; }{ Surface{2,3,4}; Delete; }
Physical Surface("fibre") = {2,3,4};
matrix() = Surface In BoundingBox{-1,-1,-1,W+1,W+1,1};
matrix() -= {2,3,4};
Physical Surface("matrix") = {matrix()};
Mesh.MeshSizeMax = h; Mesh.MeshSizeMin = h;
