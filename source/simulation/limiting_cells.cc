#include "limiting_cells.h"

#include "core/gather.h"
#include "discretization/body_frequency.h"
#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"
#include "records/engineering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nsfd
{
  namespace
  {
    /** A cell, by its longest stable step; of equal ones, by its place. */
    template <int dim>
    struct BoundedCell {
      double step;
      std::array<double, dim> centre;
      unsigned int material;

      bool operator<(const BoundedCell &other) const
      {
        return step != other.step ? step < other.step : centre < other.centre;
      }
    };

    template <int dim>
    std::string place_of(const BoundedCell<dim> &cell)
    {
      std::string text;
      for (const double x : cell.centre)
        text += (text.empty() ? "" : ", ") + engineering(x, "m");
      return "(" + text + ")";
    }
  } // namespace

  template <int dim>
  std::string limiting_cells(const SceneInput &input,
                             const Discretization<dim> &discretization,
                             const Communicator &communicator)
  {
    if (input.time.scheme != Scheme::leapfrog)
      return "";
    const Cells<dim> &cells = discretization.cells();
    const auto steps = longest_steps(cells, input.front_viscosity());
    std::vector<BoundedCell<dim>> own;
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      if (!std::isfinite(steps[b]))
        continue; // rigid
      auto &cell = own.emplace_back();
      cell.step = steps[b];
      cell.material = cells.body_class(b).material;
      for (unsigned int c = 0; c < dim; ++c)
        cell.centre[c] = cells.centre(b)[c];
    }
    auto all = gather(communicator, own);
    if (all.empty())
      return "";
    std::sort(all.begin(), all.end());
    const BoundedCell<dim> &worst = all.front();
    const auto n_near =
        std::size_t(std::partition_point(all.begin(), all.end(),
                                         [&](const BoundedCell<dim> &cell) {
                                           return cell.step <= 1.1 * worst.step;
                                         }) -
                    all.begin());
    const std::size_t n_left_out =
        std::min(all.size() - 1, (all.size() + 99) / 100);
    const double ratio = all[n_left_out].step / worst.step;
    std::string text = fmt::format(
        "             it is stable up to {}, which the cell at {} decides; {} "
        "of {} are within 10 %\n"
        "             without the worst {} ({:.2g} %) it would be {}, {:.3g} "
        "times that: ",
        engineering(worst.step, "s", 4), place_of(worst), n_near, all.size(),
        n_left_out, 100. * double(n_left_out) / double(all.size()),
        engineering(all[n_left_out].step, "s", 4), ratio);
    if (ratio < 1.2)
      return text + "it is not a few cells that decide\n";
    text +=
        "a few cells hold all others back\n"
        "             change: the mesh there, so that no cell is lower than "
        "its neighbours";
    if (input.materials.size() > 1)
      text += fmt::format(", or the material `{}`, if it is much stiffer",
                          input.materials[worst.material].name);
    return text + "\n";
  }

  template std::string limiting_cells(const SceneInput &,
                                      const Discretization<2> &,
                                      const Communicator &);
  template std::string limiting_cells(const SceneInput &,
                                      const Discretization<3> &,
                                      const Communicator &);
} // namespace nsfd
