// What is wrong with meshes of other programs is said exactly, and nothing that
// a file claims about itself is believed.

#include "foreign_meshes.h"

#include <zlib.h>

#include <string>
#include <vector>

using namespace nsfd;
using namespace nsfd::test;

namespace test_bad_foreign_meshes
{
  struct Fault {
    const char *from, *to, *message;
  };

  void expect_faults(const std::string &file, const unsigned int dimension,
                     const std::vector<Fault> &faults)
  {
    const std::string good = content_of_test(file);
    for (const Fault &fault : faults)
      expect_part(errors_of_content(dimension, "bad_" + file,
                                    with(good, fault.from, fault.to)),
                  fault.message);
  }

  TEST(BadForeignMeshes, AbaqusDecks)
  {
    expect_faults(
        "plate_cae.inp", 2,
        {{"type=CPS4R", "type=COH2D4",
          "line 20: element type COH2D4: cohesive elements are not needed"},
         {"type=CPS4R", "type=CIN2D4",
          "line 20: element type CIN2D4: there is no such cell; mesh with "
          "CPE3, CPE4"},
         {"type=CPS4R", "type=C3D8",
          "line 20: elements of the type C3D8 are for three dimensions; write "
          "`set dimension = 3`"},
         {"1, 1, 2, 5, 4", "1, 1, 2, 55, 4", "line 20: there is no node 55"},
         {"1, 1, 2, 5, 4", "1, 1, 2, x, 4", "line 20: `x` is not an integer"},
         {"1, 1, 2, 5, 4", "1, 1, 2",
          "line 20: 2 nodes do not make an element of the type CPS4R"},
         {"      1,           0.,", "      1,         zero,",
          "line 10: `zero` is not a number"},
         {"part=Plate", "part=Slab", "line 44: there is no part `Slab` above"},
         {"instance=Plate-1, generate\n 1,  3,",
          "instance=Plate-9, generate\n 1,  3,",
          "line 50: there is no instance `Plate-9` above"},
         {"Lower, Upper", "Lower, Uper",
          "line 33: there is no element set `Uper` above"},
         {"_Loaded_S3, S3", "_Loaded_S3, S5",
          "line 56: element 3 has no face S5"},
         {"_Loaded_S3, S3", "_Loaded_S3, top", "line 56: `TOP` is not a face"},
         {"*Part,", "*INCLUDE, INPUT=/etc/passwd\n*Part,",
          "line 8: *INCLUDE is not followed"},
         {"*Node\n", "*Node, system=C\n",
          "line 9: coordinates that are not rectangular are not read"},
         {"*Nset, nset=Lower\n", "*NGEN, nset=Lower\n",
          "line 24: *NGEN is not read"}});
  }

  TEST(BadForeignMeshes, AbaqusSetsGrowWithTheFileOnly)
  {
    // to the last label that there could be, and sets of themselves
    std::string deck = with(content_of_test("plate_cae.inp"), " 4,  9,  1",
                            " 4,  9223372036854775807,  1");
    std::string lines;
    for (unsigned int i = 0; i < 200; ++i)
      lines += "Lower, Lower, Lower, Lower, Lower, Lower, Lower, Lower\n";
    deck = with(deck, "*Elset, elset=Lower\n 1, 2\n",
                "*Elset, elset=Lower\n 1, 2\n" + lines);
    const TemporaryFile file("growing.inp", deck);
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    ASSERT_TRUE(mesh.triangulation);
    EXPECT_NEAR(mesh.volume("Lower"), 2., 1e-12);
  }

  TEST(BadForeignMeshes, ShellsAreNoBody)
  {
    const std::string shells =
        with(content_of_test("plate_cae.inp"), "type=CPS4R", "type=S4R");
    expect_part(errors_of_content(3, "shells.inp", shells),
                "it has shells and faces, but no cells of 3 dimensions: "
                "element type S4R; write `set dimension = 2` if it lies in a "
                "plane, or mesh the body with C3D4, C3D6 or C3D8");
    const TemporaryFile file("shells.inp", shells);
    const BuiltMesh<2> mesh(mesh_scene(2, file.entries()));
    std::string notes;
    for (const std::string &note : mesh.named().notes)
      notes += note + "\n";
    expect_part(notes, "4 elements of the type S4R were taken for plane cells");
  }

  TEST(BadForeignMeshes, LegacyVtk)
  {
    expect_faults(
        "plate_vtk_ascii.vtk", 2,
        {{"POINTS 56", "POINTS 560000000",
          "it ends early: 1680000000 values of `POINTS` do not fit into"},
         {"CELL_TYPES", "CELL_TIPES",
          "`CELL_TIPES` is not known where a keyword is expected"},
         {"UNSTRUCTURED_GRID", "POLYDATA",
          "its data set is POLYDATA; an UNSTRUCTURED_GRID is needed"},
         {"CELL_TYPES 100\n3", "CELL_TYPES 100\n14",
          "it has cells that cannot be used: 1 pyramids"},
         {"CELL_TYPES 100\n3", "CELL_TYPES 100\n12",
          "it is a mesh of 3 dimensions, the scene has 2"},
         {"CELLS 100 386\n2 ", "CELLS 100 386\n9999 ",
          "CELLS ends early, in cell 0"},
         {"CELLS 100 386\n2 ", "CELLS 100 386\n2 -",
          "cell 0 has a vertex that is not there"}});
    expect_faults(
        "plate_vtk_binary.vtk", 2,
        {{"POINTS 56", "POINTS 5600000000000000000", "do not fit into"},
         {"vtktypeint64", "string",
          "the array `OFFSETS` is of the type `string`"}});
    const std::string whole = content_of_test("plate_vtk_binary.vtk");
    expect_part(errors_of_content(2, "half.vtk", whole.substr(0, 3000)),
                "it ends early");
  }

  TEST(BadForeignMeshes, Vtu)
  {
    expect_faults(
        "plate_vtk_ascii.vtu", 2,
        {{"\"UnstructuredGrid\"", "\"PolyData\"",
          "its data set is PolyData; an UnstructuredGrid is needed"},
         {"NumberOfCells=\"100\"", "NumberOfCells=\"99\"",
          "the array `MaterialID` has 100 values of 1 components for 99 cells"},
         {"NumberOfPoints=\"56\"", "NumberOfPoints=\"18446744073709551615\"",
          "is more than the file can hold"},
         {"<?xml version=\"1.0\"?>",
          "<!DOCTYPE a [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>",
          "it has a DOCTYPE, which no file of VTK has"},
         {"12 12 12", "12 1x2 12",
          "the array `MaterialID`: `1x2` is not a number"},
         {"type=\"Float64\" Name=\"quality\"", "type=\"Real\" Name=\"quality\"",
          "the array `quality`: the type `Real` is not read"},
         {"</CellData>", "</PointData>", "it is no XML: mismatched tag"}});
    expect_faults(
        "plate_meshio.vtu", 2,
        {{"vtkZLibDataCompressor", "vtkLZ4DataCompressor",
          "it is compressed by vtkLZ4DataCompressor; save it with zlib"},
         {"eJ", "aJ", "its block cannot be unpacked by zlib"},
         // one block, of 2^31 bytes
         {"AQAAAACAAABABQAA", "AQAAAAAAAIAAAACA", "its header cannot be right"},
         {"format=\"binary\"", "format=\"appended\" offset=\"0\"",
          "there are no appended data"},
         {"AQAAAACAAABABQAA", "AQAAAA*CAABABQAA", "it is not base64"}});
    expect_faults("plate_vtk_raw.vtu", 2,
                  {{"offset=\"0\"", "offset=\"99999999999\"",
                    "the array `MaterialID`: it ends early"}});
    for (const char *content :
         {"", "<a>", "<VTKFile type=\"UnstructuredGrid\"/>"})
      EXPECT_NE(errors_of_content(2, "short.vtu", content), "") << content;
  }

  // Nine million zeros in nine kilobytes, which would be 72 MB of numbers.
  TEST(BadForeignMeshes, WhatIsPackedIsNotUnpackedWithoutBound)
  {
    const std::string zeros(9000000, '\0');
    uLongf n_packed = compressBound(zeros.size());
    std::string packed(n_packed, '\0');
    ASSERT_EQ(compress(reinterpret_cast<Bytef *>(&packed[0]), &n_packed,
                       reinterpret_cast<const Bytef *>(zeros.data()),
                       zeros.size()),
              Z_OK);
    packed.resize(n_packed);
    std::string header;
    for (const std::size_t word :
         {std::size_t(1), zeros.size(), std::size_t(0), packed.size()})
      for (unsigned int byte = 0; byte < 4; ++byte)
        header += char(word >> (8 * byte) & 0xff);
    const auto file = [&](const std::string &type) {
      return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" "
             "compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><Piece "
             "NumberOfPoints=\"0\" NumberOfCells=\"1\"><Cells><DataArray "
             "type=\"" +
             type +
             "\" Name=\"types\" format=\"appended\" offset=\"0\"/></Cells>"
             "</Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_" +
             header + packed;
    };
    expect_part(errors_of_content(2, "bomb.vtu", file("UInt8")),
                "the array `types`: unpacked, the file is more than 200 times "
                "as large");
    // as doubles they are allowed, and too many
    expect_part(errors_of_content(2, "no_bomb.vtu", file("Float64")),
                "have 1125000 and 0 values for 1 cells");
  }

  TEST(BadForeignMeshes, TagsInTagsAreNoRecursion)
  {
    std::string deep = "<VTKFile type=\"UnstructuredGrid\">";
    for (unsigned int i = 0; i < 500000; ++i)
      deep += "<a>";
    expect_part(errors_of_content(2, "deep.vtu", deep), "it is no XML");
  }

  TEST(BadForeignMeshes, Exodus)
  {
    const std::string classic = content_of_test("plate_vtk.e"),
                      hdf5 = content_of_test("block_meshio.e");
    const auto errors = [](const unsigned int dimension,
                           const std::string &content) {
      return errors_of_content(dimension, "bad.e", content);
    };
    expect_part(errors(2, "hello"), "this is no Exodus file: it is neither "
                                    "netCDF nor HDF5");
    expect_part(errors(2, classic.substr(0, 2000)),
                "it ends early, in `its header`");
    expect_part(errors(2, classic.substr(0, classic.size() - 4000)),
                "it ends early, in `");
    expect_part(errors(2, "CDF\x02" + std::string(100, '\xff')),
                "its header ends early");
    expect_part(errors(3, classic), "write `set dimension = 2`");
    expect_part(errors(2, hdf5), "write `set dimension = 3`");
    expect_part(errors(3, hdf5.substr(0, 9000)), "HDF5 cannot open it");
    expect_part(
        errors(2, with(classic, "TRI", "PYR")),
        "element type PYRANGLE is not read; mesh with TRI, QUAD, TET, HEX "
        "or WEDGE");
  }

  TEST(BadForeignMeshes, SectionsOfNeper)
  {
    expect_faults("grains_neper.msh", 2,
                  {{"$NSets\n8\nx0\n5\n1", "$NSets\n8\nx0\n5\n99",
                    "section $NSets: there is no node 99"},
                   {"$NSets\n8", "$NSets\n80",
                    "section $NSets: the number of nodes of a set is missing"},
                   {"rodrigues:passive\n1    0.267949192431",
                    "homochoric\n1    0.267949192431",
                    "section $ElsetOrientations: orientation 1 has 3 values of "
                    "the descriptor `homochoric`"},
                   {"$ElsetOrientations\n2", "$ElsetOrientations\n5",
                    "section $ElsetOrientations: orientation 0 has 0 values"}});
  }
} // namespace test_bad_foreign_meshes
