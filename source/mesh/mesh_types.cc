#include "mesh_types.h"

namespace nsfd
{
  namespace
  {
    using Kind = MeshType::Kind;

    const std::vector<MeshType> own_types = {
        {"rectangle", "quadrilaterals in a rectangle", Kind::box, 2},
        {"brick", "hexahedra in a box", Kind::box, 3},
        {"notched plate", "a box with a slot from the left side", Kind::box},
        {"crossed triangles", "four triangles per quadrilateral", Kind::box, 2,
         4, true},
        {"diagonal triangles", "two triangles per quadrilateral", Kind::box, 2,
         2, true},
        {"tetrahedra", "six tetrahedra per hexahedron", Kind::box, 3, 6, true},
        {"bodies", "the meshes of all blocks `Body: name`", Kind::bodies},
        {"file", "a mesh or geometry file: Gmsh, STEP, Abaqus, UCD, VTK",
         Kind::named},
        {"voronoi", "quadrilaterals in the grains of a polycrystal",
         Kind::named, 2},
    };

    struct Generator {
      const char *name;
      unsigned int dimension = 0; ///< 0: two and three
    };

    /** Those of generate_from_name_and_arguments() that fill a volume. */
    const Generator generators[] = {
        {"hyper_cube"},
        {"subdivided_hyper_cube"},
        {"hyper_rectangle"},
        {"subdivided_hyper_rectangle"},
        {"hyper_ball"},
        {"hyper_ball_balanced"},
        {"half_hyper_ball"},
        {"quarter_hyper_ball"},
        {"hyper_shell"},
        {"half_hyper_shell"},
        {"quarter_hyper_shell"},
        {"concentric_hyper_shells"},
        {"eccentric_hyper_shell"},
        {"hyper_L"},
        {"hyper_cross"},
        {"hyper_cube_slit"},
        {"hyper_cube_with_cylindrical_hole"},
        {"enclosed_hyper_cube"},
        {"plate_with_a_hole"},
        {"channel_with_cylinder"},
        {"cheese"},
        {"general_cell"},
        {"simplex"},
        {"cylinder"},
        {"subdivided_cylinder", 3},
        {"cylinder_shell", 3},
        {"truncated_cone"},
        {"moebius", 3},
        {"torus", 3},
    };

    std::vector<MeshType> all_types()
    {
      std::vector<MeshType> types = own_types;
      for (const Generator &generator : generators)
        types.push_back({generator.name,
                         generator.dimension == 0
                             ? "generator of deal.II"
                             : "generator of deal.II, dimension = " +
                                   std::to_string(generator.dimension),
                         Kind::generator, generator.dimension});
      return types;
    }
  } // namespace

  const std::vector<MeshType> &mesh_types()
  {
    static const std::vector<MeshType> types = all_types();
    return types;
  }

  const MeshType *find_mesh_type(const std::string &name)
  {
    for (const MeshType &type : mesh_types())
      if (type.name == name)
        return &type;
    return nullptr;
  }
} // namespace nsfd
