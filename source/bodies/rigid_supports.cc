#include "rigid_supports.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    double dot(const std::vector<double> &a, const std::vector<double> &b)
    {
      return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
    }

    /** Orthonormal, of the range of @p columns: the longest that is left
        first. */
    std::vector<std::vector<double>>
    range_of(std::vector<std::vector<double>> columns)
    {
      constexpr double none = 1e-10;
      double longest = 0.;
      for (const auto &column : columns)
        longest = std::max(longest, std::sqrt(dot(column, column)));
      std::vector<std::vector<double>> basis;
      while (basis.size() < columns.size()) {
        const auto next = std::max_element(
            columns.begin(), columns.end(),
            [](const auto &a, const auto &b) { return dot(a, a) < dot(b, b); });
        const double length = std::sqrt(dot(*next, *next));
        if (!(length > none * longest))
          break;
        std::vector<double> unit(*next);
        for (double &x : unit)
          x /= length;
        for (auto &column : columns) {
          const double along = dot(unit, column);
          for (std::size_t i = 0; i < unit.size(); ++i)
            column[i] -= along * unit[i];
        }
        basis.push_back(std::move(unit));
      }
      return basis;
    }
  } // namespace

  template <int dim>
  RigidSupports<dim>::RigidSupports(const SceneInput &input,
                                    const Discretization<dim> &discretization,
                                    const BodyLayout<dim> &layout)
      : supports_(layout.size())
  {
    constexpr unsigned int n_rigid = BodyLayout<dim>::n_rigid;
    const auto &origins = discretization.origins();
    const auto &points = discretization.points();
    for (std::size_t b = 0; b < layout.size(); ++b) {
      if (!layout[b].is_rigid())
        continue;
      Support &support = supports_[b];
      const auto &slots = layout.slots(b);
      Block at_rest(unsigned(slots.size()) * dim, n_rigid);
      double size = 0.;
      for (unsigned int s = 0; s < slots.size(); ++s) {
        const unsigned int point = slots[s].point;
        if (origins[point].kind != PointOrigin::Kind::motion)
          continue;
        Tensor<1, dim> arm;
        for (unsigned int d = 0; d < dim; ++d)
          arm[d] = points.position[point * dim + d] - layout[b].centre[d];
        set_rigid_trace<dim>(arm, s, at_rest);
        size = std::max(size, arm.norm());
        const BoundaryInput &side = input.boundaries[origins[point].block];
        for (unsigned int c = 0; c < dim; ++c)
          if (side.velocity[c] || side.displacement[c])
            support.rows.push_back(
                {s, c, point, std::sqrt(points.weight[point])});
      }
      std::vector<std::vector<double>> columns(n_rigid);
      for (unsigned int j = 0; j < n_rigid; ++j)
        for (const Row &row : support.rows)
          columns[j].push_back(row.root *
                               at_rest(row.slot * dim + row.component, j) /
                               (j < dim || size == 0. ? 1. : size));
      support.basis = range_of(std::move(columns));
      // what is held altogether, or by one row for each motion, stays as it is
      if (support.basis.size() == n_rigid ||
          support.basis.size() == support.rows.size())
        support = {};
    }
  }

  template <int dim>
  void RigidSupports<dim>::project(const Support &support,
                                   std::vector<double> &values)
  {
    const auto &rows = support.rows;
    std::vector<double> result(rows.size(), 0.);
    for (const auto &unit : support.basis) {
      double along = 0.;
      for (std::size_t i = 0; i < rows.size(); ++i)
        along += unit[i] * rows[i].root * values[i];
      for (std::size_t i = 0; i < rows.size(); ++i)
        result[i] += along * unit[i] / rows[i].root;
    }
    values = std::move(result);
  }

  template <int dim>
  void RigidSupports<dim>::project(const std::size_t body, Block &trace) const
  {
    const Support &support = supports_[body];
    std::vector<double> values(support.rows.size());
    for (unsigned int j = 0; !values.empty() && j < BodyLayout<dim>::n_rigid;
         ++j) {
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] =
            trace(support.rows[i].slot * dim + support.rows[i].component, j);
      project(support, values);
      for (std::size_t i = 0; i < values.size(); ++i)
        trace(support.rows[i].slot * dim + support.rows[i].component, j) =
            values[i];
    }
  }

  template <int dim>
  void RigidSupports<dim>::project(
      const std::function<double &(std::size_t, unsigned int)> &given) const
  {
    for (const Support &support : supports_) {
      std::vector<double> values;
      for (const Row &row : support.rows)
        values.push_back(given(row.point, row.component));
      project(support, values);
      for (std::size_t i = 0; i < values.size(); ++i)
        given(support.rows[i].point, support.rows[i].component) = values[i];
    }
  }

  template class RigidSupports<2>;
  template class RigidSupports<3>;
} // namespace nsfd
