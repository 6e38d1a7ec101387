#include "level_mesh.h"

#include "nsfd/parameters/section_reader.h"

#include <deal.II/grid/grid_generator.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    struct ListedGenerator {
      const char *name;
      unsigned int dimension = 0; ///< 0: two and three
    };

    /** Those of generate_from_name_and_arguments() that fill a volume. */
    constexpr ListedGenerator generators[] = {
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

    /** Refined along the generator's own curved boundaries, then straight. */
    template <int dim>
    CoarseMesh<dim> generated_mesh(const MeshInput &input,
                                   const unsigned int refinements,
                                   std::vector<std::string> &problems)
    {
      try {
        Triangulation<dim> triangulation;
        GridGenerator::generate_from_name_and_arguments(
            triangulation, input.type, input.generator_arguments);
        if (triangulation.n_active_cells() == 0) {
          problems.push_back(fmt::format("the generator `{}` makes no mesh in "
                                         "{} dimensions",
                                         input.type, dim));
          return {};
        }
        if (triangulation.n_active_cells() *
                std::ldexp(1., dim * int(refinements)) >
            5e8) {
          problems.push_back("too many cells; reduce `refinements`");
          return {};
        }
        triangulation.refine_global(refinements);
        if (triangulation.has_hanging_nodes() ||
            triangulation.is_mixed_mesh()) {
          problems.push_back(fmt::format("the generator `{}` makes a mesh with "
                                         "hanging nodes or mixed cells",
                                         input.type));
          return {};
        }
        return active_level(triangulation);
      } catch (const std::exception &exception) {
        problems.push_back(fmt::format(
            "the generator `{}` does not accept `{}`: {}", input.type,
            input.generator_arguments, level_mesh_message(exception)));
        return {};
      }
    }

    /** Numbers of the arguments of a generator: divisions, or lengths. */
    double largest_whole_number(const std::string &arguments)
    {
      double largest = 1.;
      for (std::size_t i = 0; i < arguments.size();) {
        char *end = nullptr;
        const double value = std::strtod(arguments.c_str() + i, &end);
        const std::size_t next = std::size_t(end - arguments.c_str());
        if (next == i) {
          ++i;
          continue;
        }
        if (value == std::floor(value) && std::isfinite(value))
          largest = std::max(largest, value);
        i = next;
      }
      return largest;
    }

    /** One of those generators, by its name there. */
    class Generator final : public MeshType
    {
    public:
      explicit Generator(const std::string &name)
          : listed_(std::find_if(std::begin(generators), std::end(generators),
                                 [&](const ListedGenerator &generator) {
                                   return generator.name == name;
                                 }))
      {
      }

      unsigned int place() const override
      {
        return 10 + unsigned(listed_ - std::begin(generators));
      }
      unsigned int dimension() const override { return listed_->dimension; }
      bool has_ids() const override { return true; }
      double n_cells(const MeshInput &mesh,
                     const unsigned int dimension) const override
      {
        if (mesh.type.compare(0, 11, "subdivided_") != 0)
          return 1.;
        return std::pow(largest_whole_number(mesh.generator_arguments),
                        dimension);
      }

      void read(SectionReader &reader, unsigned int,
                MeshInput &mesh) const override
      {
        mesh.generator_arguments = reader.word(
            "arguments", "", "of the generator, as deal.II takes them: a : b");
      }

    private:
      const ListedGenerator *listed_;

      void make(const MeshInput &input, const unsigned int refinements,
                std::vector<std::string> &problems,
                CoarseMesh<2> &mesh) const override
      {
        mesh = generated_mesh<2>(input, refinements, problems);
      }
      void make(const MeshInput &input, const unsigned int refinements,
                std::vector<std::string> &problems,
                CoarseMesh<3> &mesh) const override
      {
        mesh = generated_mesh<3>(input, refinements, problems);
      }
    };

    const bool generators_registered = [] {
      for (const ListedGenerator &generator : generators)
        MeshTypeRegistry::instance().add<Generator>(
            generator.name, generator.dimension == 0
                                ? "generator of deal.II"
                                : "generator of deal.II, dimension = " +
                                      std::to_string(generator.dimension));
      return true;
    }();
  } // namespace
} // namespace nsfd
