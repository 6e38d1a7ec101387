#include "obstacle_motion.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>

namespace nsfd
{
  std::vector<double> initial_shifts(const SceneInput &input)
  {
    const auto &obstacles = input.obstacles;
    const bool moves =
        std::any_of(obstacles.begin(), obstacles.end(),
                    [](const auto &obstacle) { return obstacle.moves(); });
    return std::vector<double>(moves ? 3 * obstacles.size() : 0, 0.);
  }

  template <int dim>
  std::vector<double> ObstacleMotion<dim>::shifts(const State &old,
                                                  const double h) const
  {
    std::vector<double> result = old.obstacle_shift;
    const double theta = input_.time.theta;
    for (std::size_t k = 0; k < result.size(); ++k)
      if (const auto &velocity = input_.obstacles[k / 3].velocity[k % 3])
        result[k] +=
            h * (theta * velocity->at(dealii::Point<dim>(), old.time + h) +
                 (1. - theta) * velocity->at(dealii::Point<dim>(), old.time));
    return result;
  }

  /** Of the obstacle of a contact, in its frame; zero for others. */
  template <int dim>
  std::array<double, dim> ObstacleMotion<dim>::velocity(const std::size_t k,
                                                        const double time) const
  {
    std::array<double, dim> result{};
    const MovingRow<dim> &row = contacts_.rows()[k];
    if (row.partner != MovingRow<dim>::Partner::obstacle)
      return result;
    const auto &obstacle = input_.obstacles[row.obstacle];
    const std::size_t i = contacts_.row_point(k);
    for (unsigned int d = 0; d < dim; ++d)
      if (obstacle.velocity[d]) {
        const double v = obstacle.velocity[d]->at(dealii::Point<dim>(), time);
        for (unsigned int a = 0; a < dim; ++a)
          result[a] += contacts_.points().axes(i)[a * dim + d] * v;
      }
    return result;
  }

  template <int dim>
  void ObstacleMotion<dim>::subtract_velocity(const double time,
                                              std::vector<double> &U) const
  {
    for (std::size_t k = 0; k < contacts_.rows().size(); ++k) {
      const auto own = velocity(k, time);
      for (unsigned int a = 0; a < dim; ++a)
        U[contacts_.row_point(k) * dim + a] -= own[a];
    }
  }

  template <int dim>
  std::vector<double>
  ObstacleMotion<dim>::work(const std::vector<double> &impulse,
                            const double start, const double h) const
  {
    const double theta = input_.time.theta;
    std::vector<double> result;
    for (std::size_t k = 0; k < contacts_.n_own_rows(); ++k) {
      double &work = result.emplace_back();
      const auto before = velocity(k, start), after = velocity(k, start + h);
      for (unsigned int a = 0; a < dim; ++a)
        work += impulse[contacts_.row_point(k) * dim + a] *
                (theta * after[a] + (1. - theta) * before[a]);
    }
    return result;
  }

  template class ObstacleMotion<2>;
  template class ObstacleMotion<3>;
} // namespace nsfd
