#include "gmsh_words.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace nsfd
{
  namespace
  {
    using Words = std::set<std::string>;

    /**
     * Of Gmsh 4.8.4: every word that its lexer knows (Parser/Gmsh.l) and every
     * command that its grammar finds by name (Parser/Gmsh.y) stands either
     * here or among the refused words below.
     */
    const Words allowed = {
        // numbers and strings
        "Abs", "Acos", "ArcCos", "ArcSin", "ArcTan", "ArcTan2", "Asin", "Atan",
        "Atan2", "Ceil", "Cos", "Cosh", "Exp", "Fabs", "Floor", "Fmod",
        "GMSH_MAJOR_VERSION", "GMSH_MINOR_VERSION", "GMSH_PATCH_VERSION",
        "Hypot", "LinSpace", "List", "Log", "Log10", "LogSpace", "LowerCase",
        "LowerCaseIn", "Max", "Min", "Modulo", "N2S", "NameToString", "Pi",
        "Rand", "Round", "Sin", "Sinh", "Sprintf", "Sqrt", "Str", "StrCat",
        "StrChoice", "StrCmp", "StrFind", "StrLen", "StrPrefix", "StrRelative",
        "StrReplace", "StrSub", "Tan", "Tanh", "UpperCase", "Find", "Unique",
        // variables and flow
        "Call", "DefineConstant", "DefineNumber", "DefineString", "Else",
        "ElseIf", "EndFor", "EndIf", "Error", "Exists", "For", "Function",
        "GetForced", "GetForcedStr", "If", "In", "Macro", "Printf", "Return",
        "UndefineConstant", "Warning", "Include",
        // shapes
        "BSpline", "Bezier", "Block", "Box", "CatmullRom", "Circle", "Compound",
        "Cone", "Coordinates", "Curve", "Cylinder", "Disk", "Ellipse",
        "Ellipsis", "Ellipsoid", "Elliptic", "Euclidian", "GeoEntity", "Hole",
        "Knots", "Line", "Loop", "Nurbs", "Order", "Parametric", "Parent",
        "Physical", "Plane", "Point", "PolarSphere", "Quadric", "Rectangle",
        "Ruled", "SetFactory", "SetMaxTag", "SetName", "Sphere", "Spline",
        "Surface", "ThickSolid", "ThruSections", "Torus", "Volume", "Wedge",
        "Wire", "newc", "newf", "newl", "newll", "newp", "newreg", "news",
        "newsl", "newv",
        // what is done with them
        "Affine", "BooleanCoherence", "BooleanCommon", "BooleanCut",
        "BooleanDifference", "BooleanFragments", "BooleanFuse",
        "BooleanIntersection", "BooleanSection", "BooleanUnion", "Boundary",
        "BoundingBox", "CenterOfMass", "Chamfer", "Coherence", "Combined",
        "CombinedBoundary", "Degenerated", "Delete", "Dilate", "Duplicata",
        "Extrude", "Fillet", "Intersect", "Mass", "MatrixOfInertia", "PointsOf",
        "Recursive", "Rotate", "Sewing", "Slide", "Split", "Symmetry",
        "Translate", "Using",
        // meshing
        "Alternate", "AlternateLeft", "AlternateRight", "Alternated",
        "Background", "Beta", "BoundaryLayer", "Bump", "Characteristic",
        "Field", "Layers", "Left", "Length", "Mesh", "MeshAlgorithm",
        "MeshSize", "MeshSizeFromBoundary", "OptimizeMesh", "Periodic", "Power",
        "Progression", "QuadTriAddVerts", "QuadTriNoNewVerts", "RecombLaterals",
        "Recombine", "RecombineMesh", "RefineMesh", "RelocateMesh",
        "RenumberMeshElements", "RenumberMeshNodes", "ReorientMesh", "Reverse",
        "ReverseMesh", "Right", "ScaleLastLayer", "SetOrder", "Smoother",
        "TransfQuadTri", "Transfinite",
        // pictures
        "Color", "Geometry", "General", "Hide", "Show"};

    const std::map<std::string, Words> refused = {
        {"runs a command",
         {"NonBlockingSystemCall", "OnelabRun", "Solver", "System",
          "SystemCall", "SendToServer", "OnelabAction"}},
        {"writes a file", {"Save", "Print", "Draw", "NewModel"}},
        {"makes a folder", {"CreateDir"}},
        {"reads another file",
         {"ListFromFile", "Merge", "MergeFile", "MergeWithBoundingBox",
          "ShapeFromFile"}},
        {"looks at the machine",
         {"AbsolutePath", "Cpu", "CurrentDir", "CurrentDirectory",
          "CurrentFileName", "DirName", "FileExists", "FixRelativePath",
          "GetEnv", "GmshExecutableName", "MPI_Rank", "MPI_Size", "Memory",
          "TIME", "Today", "TotalMemory"}},
        {"asks somebody or talks to another program",
         {"CodeName", "GetNumber", "GetString", "GetStringValue", "GetValue",
          "SetChanged", "SetNumber", "SetString"}},
        {"makes a word of a string",
         {"S2N", "StringToName", "Parse", "ParseString"}},
        {"ends or halts Gmsh", {"Abort", "Exit", "Sleep"}},
        {"runs a plugin", {"Plugin"}},
        {"belongs to results, not to a mesh",
         {"Alias", "AliasWithOptions", "ColorTable", "Combine", "CopyOptions",
          "INTERPOLATION_SCHEME", "PostProcessing", "T2", "T3",
          "TextAttributes", "View"}},
        {"is about windows",
         {"SetCurrentWindow", "SplitCurrentWindowHorizontal",
          "SplitCurrentWindowVertical", "UnsplitWindow"}},
        {"works on a mesh from elsewhere",
         {"AdaptMesh", "Betti", "ClassifySurfaces", "Cohomology",
          "CreateGeometry", "CreateTopology", "Homology", "PartitionMesh",
          "Remesh", "SetPartition"}},
        {"is not known to keep to geometry and meshing",
         {"Append", "Catenary", "DefineStruct", "DimNameSpace", "Levelset",
          "NameStruct", "SetTag", "Struct", "SyncModel", "TestLevel"}}};

    const Words fields = {"Attractor",
                          "AttractorAnisoCurve",
                          "Ball",
                          "BoundaryLayer",
                          "Box",
                          "Constant",
                          "Curvature",
                          "Cylinder",
                          "Distance",
                          "Extend",
                          "Frustum",
                          "Gradient",
                          "IntersectAniso",
                          "Laplacian",
                          "LonLat",
                          "MathEval",
                          "MathEvalAniso",
                          "Max",
                          "MaxEigenHessian",
                          "Mean",
                          "Min",
                          "MinAniso",
                          "Octree",
                          "Param",
                          "Restrict",
                          "Threshold"};

    const Words field_options = {"AnisoMax",
                                 "Beta",
                                 "BetaLaw",
                                 "CurvesList",
                                 "Delta",
                                 "DistMax",
                                 "DistMin",
                                 "EdgesList",
                                 "ExcludedFaceList",
                                 "ExcludedSurfacesList",
                                 "F",
                                 "FX",
                                 "FY",
                                 "FZ",
                                 "FacesList",
                                 "FanNodesList",
                                 "FanPointsList",
                                 "FanPointsSizesList",
                                 "FieldX",
                                 "FieldY",
                                 "FieldZ",
                                 "FieldsList",
                                 "FromStereo",
                                 "IField",
                                 "InField",
                                 "IncludeBoundary",
                                 "InnerR1",
                                 "InnerR2",
                                 "InnerV1",
                                 "InnerV2",
                                 "IntersectMetrics",
                                 "Kind",
                                 "LcMax",
                                 "LcMin",
                                 "M11",
                                 "M12",
                                 "M13",
                                 "M22",
                                 "M23",
                                 "M33",
                                 "NNodesByEdge",
                                 "NbLayers",
                                 "NodesList",
                                 "NumPointsPerCurve",
                                 "OuterR1",
                                 "OuterR2",
                                 "OuterV1",
                                 "OuterV2",
                                 "PointsList",
                                 "Power",
                                 "Quads",
                                 "R1_inner",
                                 "R1_outer",
                                 "R2_inner",
                                 "R2_outer",
                                 "Radius",
                                 "RadiusStereo",
                                 "Ratio",
                                 "RegionsList",
                                 "Sampling",
                                 "Sigmoid",
                                 "Size",
                                 "SizeFar",
                                 "SizeMax",
                                 "SizeMaxNormal",
                                 "SizeMaxTangent",
                                 "SizeMin",
                                 "SizeMinNormal",
                                 "SizeMinTangent",
                                 "SizesList",
                                 "StopAtDistMax",
                                 "SurfacesList",
                                 "Thickness",
                                 "V1_inner",
                                 "V1_outer",
                                 "V2_inner",
                                 "V2_outer",
                                 "VIn",
                                 "VOut",
                                 "VerticesList",
                                 "VolumesList",
                                 "X1",
                                 "X2",
                                 "XAxis",
                                 "XCenter",
                                 "XMax",
                                 "XMin",
                                 "Y1",
                                 "Y2",
                                 "YAxis",
                                 "YCenter",
                                 "YMax",
                                 "YMin",
                                 "Z1",
                                 "Z2",
                                 "ZAxis",
                                 "ZCenter",
                                 "ZMax",
                                 "ZMin",
                                 "dMax",
                                 "dMin",
                                 "hfar",
                                 "hwall_n",
                                 "hwall_n_nodes",
                                 "lMaxNormal",
                                 "lMaxTangent",
                                 "lMinNormal",
                                 "lMinTangent",
                                 "m11",
                                 "m12",
                                 "m13",
                                 "m22",
                                 "m23",
                                 "m33",
                                 "ratio",
                                 "thickness"};

    /// they say something, or set the view from which a picture is taken
    const char *const general_options[] = {"AbortOnError",
                                           "Axes",
                                           "BackgroundGradient",
                                           "BoundingBoxSize",
                                           "Clip",
                                           "Color",
                                           "DrawBoundingBoxes",
                                           "ExpertMode",
                                           "Light",
                                           "Max",
                                           "Min",
                                           "NumThreads",
                                           "Orthographic",
                                           "Rotation",
                                           "Scale",
                                           "SmallAxes",
                                           "Terminal",
                                           "Trackball",
                                           "Translation",
                                           "Verbosity"};

    /// GmshOption and ServerAction are left out: they act elsewhere
    const Words attributes = {
        "AutoCheck",    "Choices", "Closed",   "Help",          "Highlight",
        "Label",        "Loop",    "Max",      "Min",           "Name",
        "NumberFormat", "Range",   "ReadOnly", "ReadOnlyRange", "Step",
        "Units",        "Visible"};

    bool has(const Words &words, const std::string &word)
    {
      return words.count(word) > 0;
    }

    bool begins_with(const std::string &word, const std::string &head)
    {
      return word.compare(0, head.size(), head) == 0;
    }
  } // namespace

  GmshWord classify_gmsh_word(const std::string &word)
  {
    if (has(allowed, word))
      return GmshWord::allowed;
    for (const auto &[deed, words] : refused)
      if (has(words, word))
        return GmshWord::refused;
    return GmshWord::free;
  }

  std::string deed_of_gmsh_word(const std::string &word)
  {
    for (const auto &[deed, words] : refused)
      if (has(words, word))
        return deed;
    return "is not known here";
  }

  bool is_gmsh_field(const std::string &type) { return has(fields, type); }

  bool is_gmsh_field_option(const std::string &option)
  {
    return has(field_options, option);
  }

  bool is_gmsh_option(const std::string &category, const std::string &option)
  {
    // no option of meshing or geometry names a file; some of the latter are
    // commands for a click of the mouse
    if (category == "Mesh")
      return option != "PartitionTopologyFile";
    if (category == "Geometry")
      return option.find("Command") == std::string::npos;
    return category == "General" && option.find("File") == std::string::npos &&
           std::any_of(
               std::begin(general_options), std::end(general_options),
               [&](const char *head) { return begins_with(option, head); });
  }

  bool is_gmsh_attribute(const std::string &word)
  {
    return has(attributes, word);
  }
} // namespace nsfd
