#include "core/mix_bits.h"
#include "mesh_topology.h"

#include <cmath>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** Uniform in the unit ball. */
    template <int dim>
    Tensor<1, dim> random_vector(std::uint64_t state)
    {
      Tensor<1, dim> result;
      do
        for (unsigned int d = 0; d < dim; ++d) {
          state = mixed(state);
          result[d] = 2. * std::ldexp(double(state >> 11), -53) - 1.;
        }
      while (result.norm_square() > 1.);
      return result;
    }
  } // namespace

  template <int dim>
  void distort(CoarseMesh<dim> &mesh, const double share,
               const unsigned int seed)
  {
    const std::vector<bool> at_boundary = boundary_vertices(mesh);
    const std::vector<double> edges = shortest_edges(mesh);
    const auto box = bounding_box(mesh.vertices);
    const double size = (box.second - box.first).norm();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      if (at_boundary[v])
        continue;
      Point<dim> &p = mesh.vertices[v];
      std::uint64_t state = mixed(seed);
      for (unsigned int d = 0; d < dim; ++d)
        state = mixed(state ^ std::uint64_t(std::llround(std::ldexp(
                                  (p[d] - box.first[d]) / size, 28))));
      p += share * edges[v] * random_vector<dim>(state);
    }
  }

  template void distort(CoarseMesh<2> &, double, unsigned int);
  template void distort(CoarseMesh<3> &, double, unsigned int);
} // namespace nsfd
