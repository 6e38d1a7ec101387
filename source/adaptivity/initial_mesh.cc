#include "initial_mesh.h"

#include "mesh/owned_cells.h"
#include "nsfd/adaptivity/indicator.h"
#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** Cells without any state. */
    template <int dim>
    class PlacesOnly final : public MeshView
    {
    public:
      explicit PlacesOnly(const ActiveCells<dim> &cells)
      {
        for (const auto &cell : cells) {
          Body &body = bodies_.emplace_back();
          const auto centre = cell->center();
          for (unsigned int c = 0; c < dim; ++c)
            body.centre[c] = centre[c];
          for (const unsigned int v : cell->vertex_indices())
            for (unsigned int d = 0; d < dim; ++d)
              if (!(v >> d & 1u))
                body.size = std::max(body.size, cell->vertex(v).distance(
                                                    cell->vertex(v | 1u << d)));
          body.level = unsigned(cell->level());
          body.largest = std::ldexp(body.size, cell->level());
        }
      }

      const std::vector<Body> &bodies() const override { return bodies_; }
      const std::vector<double> &energy() const override { return none(); }
      const std::vector<double> &stress_jump() const override { return none(); }
      const std::vector<Point> &points() const override
      {
        none();
        return points_;
      }
      double sum(const std::vector<double> &) const override
      {
        return none().size();
      }
      double max(double) const override { return none().size(); }
      std::vector<double> gather(const std::vector<double> &) const override
      {
        return none();
      }

    private:
      const std::vector<double> &none() const
      {
        throw std::logic_error("an indicator asks for a state before the run");
      }

      std::vector<Body> bodies_;
      std::vector<Point> points_;
    };
  } // namespace

  template <int dim>
  void refine_by_place(const SceneInput &input,
                       dealii::Triangulation<dim, dim> &triangulation)
  {
    constexpr double round_off = 1. + 1e-6; // sizes were halved and compared
    const auto &adaptivity = *input.adaptivity;
    for (unsigned int level = 0; level < adaptivity.levels; ++level) {
      const auto cells = owned_cells(triangulation);
      const PlacesOnly<dim> view(cells);
      std::vector<double> size(cells.size(),
                               std::numeric_limits<double>::max());
      for (const auto &indicator : adaptivity.indicators)
        indicator->limit(view, size);
      for (std::size_t b = 0; b < cells.size(); ++b)
        if (view.bodies()[b].size > size[b] * round_off &&
            view.bodies()[b].level < adaptivity.levels)
          cells[b]->set_refine_flag();
      triangulation.execute_coarsening_and_refinement();
    }
  }

  template void refine_by_place(const SceneInput &,
                                dealii::Triangulation<2, 2> &);
  template void refine_by_place(const SceneInput &,
                                dealii::Triangulation<3, 3> &);
} // namespace nsfd
