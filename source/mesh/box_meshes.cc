#include "lattice_mesh.h"
#include "mesh_entries.h"

#include "nsfd/parameters/section_reader.h"
#include "parameters/input_errors.h"

#include <fmt/format.h>

#include <cmath>

namespace nsfd
{
  namespace
  {
    std::string repeated(const std::string &value, const unsigned int count)
    {
      std::string result = value;
      for (unsigned int i = 1; i < count; ++i)
        result += ", " + value;
      return result;
    }

    void read_notch(SectionReader &reader, MeshInput &mesh,
                    const bool can_compare)
    {
      const unsigned int n_before = reader.errors().n_errors();
      mesh.notch_length =
          reader.number("notch length", "", units::length, Range::positive(),
                        "m, from the left side to the tip");
      mesh.notch_height = reader.number("notch height", "", units::length,
                                        Range::any(), "m, y of its middle");
      mesh.notch_width = reader.number(
          "notch width", "0", units::length, Range::non_negative(),
          "m; 0 removes no cells, for an Interface block with broken faces");
      if (!can_compare || reader.errors().n_errors() > n_before)
        return;
      if (mesh.notch_length >= mesh.upper[0] - mesh.lower[0])
        reader.error("notch length",
                     fmt::format("notch length = {:g} goes through the plate",
                                 mesh.notch_length),
                     "it must be shorter than the plate is long");
      if (mesh.notch_height - .5 * mesh.notch_width <= mesh.lower[1] ||
          mesh.notch_height + .5 * mesh.notch_width >= mesh.upper[1])
        reader.error(
            "notch height",
            fmt::format("notch height = {:g}, with a width of {:g}, is "
                        "not inside the plate",
                        mesh.notch_height, mesh.notch_width),
            "write a height between the lower and the upper corner");
    }

    /** More cells than any machine of today holds are a slip of the pen. */
    void check_size(SectionReader &reader, const MeshInput &mesh,
                    const double cells_per_brick)
    {
      constexpr double most_cells = 1e9;
      double n_cells = cells_per_brick *
                       std::pow(2., static_cast<double>(mesh.cells.size()) *
                                        mesh.refinements);
      for (const unsigned int n : mesh.cells)
        n_cells *= n;
      if (n_cells > most_cells)
        reader.error("cells",
                     fmt::format("the mesh would have {:.2g} cells after {} "
                                 "refinements",
                                 n_cells, mesh.refinements),
                     "write fewer cells or refinements");
    }

    void read_box(SectionReader &reader, const unsigned int dimension,
                  const double cells_per_brick, MeshInput &mesh)
    {
      const unsigned int n_before = reader.errors().n_errors();
      mesh.lower = reader.numbers("lower corner", repeated("0", dimension),
                                  units::length, Range::any(), dimension, "m");
      mesh.upper = reader.numbers("upper corner", "", units::length,
                                  Range::any(), dimension, "m");
      mesh.cells = reader.integers("cells", "", 1, dimension,
                                   "number per direction, before refinement");
      if (mesh.type != "notched plate")
        reader.refuse({"notch length", "notch width", "notch height"},
                      "the mesh `" + mesh.type + "` has no notch");
      // after an error, the numbers are not those of the user
      const bool can_compare = reader.errors().n_errors() == n_before;
      for (unsigned int d = 0; can_compare && d < dimension; ++d)
        if (mesh.upper[d] <= mesh.lower[d])
          reader.error("upper corner",
                       fmt::format("upper corner: {} = {:g} must be greater "
                                   "than {:g} of the lower corner",
                                   "xyz"[d], mesh.upper[d], mesh.lower[d]),
                       "exchange the two corners");
      if (can_compare)
        check_size(reader, mesh, cells_per_brick);
      if (mesh.type == "notched plate")
        read_notch(reader, mesh, can_compare);
    }

    /** Fills the box between two corners with a lattice, and cuts its cells. */
    class BoxMesh : public MeshType
    {
    public:
      unsigned int place() const override { return place_; }
      unsigned int dimension() const override { return dimension_; }
      bool fills_box() const override { return true; }
      bool has_simplices(const MeshInput &) const override
      {
        return cells_per_brick_ > 1;
      }
      double n_cells(const MeshInput &mesh, unsigned int) const override
      {
        double n = 1.;
        if (mesh.cells.empty())
          return n;
        for (const unsigned int cells : mesh.cells)
          n *= cells;
        return n * cells_per_brick_;
      }

      void read(SectionReader &reader, const unsigned int dimension,
                MeshInput &mesh) const override
      {
        read_box(reader, dimension, cells_per_brick_, mesh);
        if (cells_per_brick_ > 1)
          mesh.split_simplices = read_split(reader);
      }

    protected:
      /** @p dimension 0: two and three. */
      BoxMesh(const unsigned int place, const unsigned int dimension,
              const unsigned int cells_per_brick)
          : place_(place), dimension_(dimension),
            cells_per_brick_(cells_per_brick)
      {
      }

      virtual void cut(const MeshInput &, CoarseMesh<2> &,
                       std::vector<std::string> &) const
      {
      }
      virtual void cut(const MeshInput &, CoarseMesh<3> &,
                       std::vector<std::string> &) const
      {
      }

    private:
      unsigned int place_, dimension_, cells_per_brick_;

      template <int dim>
      void make_lattice(const MeshInput &input, const unsigned int refinements,
                        std::vector<std::string> &problems,
                        CoarseMesh<dim> &mesh) const
      {
        const std::size_t n_before = problems.size();
        mesh = lattice_mesh<dim>(input, refinements, problems);
        if (problems.size() == n_before)
          cut(input, mesh, problems);
      }
      void make(const MeshInput &input, const unsigned int refinements,
                std::vector<std::string> &problems,
                CoarseMesh<2> &mesh) const override
      {
        make_lattice(input, refinements, problems, mesh);
      }
      void make(const MeshInput &input, const unsigned int refinements,
                std::vector<std::string> &problems,
                CoarseMesh<3> &mesh) const override
      {
        make_lattice(input, refinements, problems, mesh);
      }
    };

    struct Rectangle final : BoxMesh {
      explicit Rectangle(const std::string &) : BoxMesh(0, 2, 1) {}
    };

    struct Brick final : BoxMesh {
      explicit Brick(const std::string &) : BoxMesh(1, 3, 1) {}
    };

    class NotchedPlate final : public BoxMesh
    {
    public:
      explicit NotchedPlate(const std::string &) : BoxMesh(2, 0, 1) {}
      bool fills_box() const override { return false; }

    private:
      void cut(const MeshInput &input, CoarseMesh<2> &mesh,
               std::vector<std::string> &problems) const override
      {
        cut_notch(input, mesh, problems);
      }
      void cut(const MeshInput &input, CoarseMesh<3> &mesh,
               std::vector<std::string> &problems) const override
      {
        cut_notch(input, mesh, problems);
      }
    };

    class CrossedTriangles final : public BoxMesh
    {
    public:
      explicit CrossedTriangles(const std::string &) : BoxMesh(3, 2, 4) {}

    private:
      using BoxMesh::cut;
      void cut(const MeshInput &, CoarseMesh<2> &mesh,
               std::vector<std::string> &) const override
      {
        mesh = cut_in_four(mesh);
      }
    };

    class DiagonalTriangles final : public BoxMesh
    {
    public:
      explicit DiagonalTriangles(const std::string &) : BoxMesh(4, 2, 2) {}

    private:
      using BoxMesh::cut;
      void cut(const MeshInput &, CoarseMesh<2> &mesh,
               std::vector<std::string> &) const override
      {
        mesh = cut_along_diagonal(mesh);
      }
    };

    class Tetrahedra final : public BoxMesh
    {
    public:
      explicit Tetrahedra(const std::string &) : BoxMesh(5, 3, 6) {}

    private:
      using BoxMesh::cut;
      void cut(const MeshInput &, CoarseMesh<3> &mesh,
               std::vector<std::string> &) const override
      {
        mesh = cut_along_diagonal(mesh);
      }
    };

    NSFD_REGISTER(MeshTypeRegistry, Rectangle, "rectangle",
                  "quadrilaterals in a rectangle");
    NSFD_REGISTER(MeshTypeRegistry, Brick, "brick", "hexahedra in a box");
    NSFD_REGISTER(MeshTypeRegistry, NotchedPlate, "notched plate",
                  "a box with a slot from the left side");
    NSFD_REGISTER(MeshTypeRegistry, CrossedTriangles, "crossed triangles",
                  "four triangles per quadrilateral");
    NSFD_REGISTER(MeshTypeRegistry, DiagonalTriangles, "diagonal triangles",
                  "two triangles per quadrilateral");
    NSFD_REGISTER(MeshTypeRegistry, Tetrahedra, "tetrahedra",
                  "six tetrahedra per hexahedron");
  } // namespace
} // namespace nsfd
