#include "ghost_layer.h"

#include "discretization/cells.h"
#include "discretization/material_histories.h"
#include "discretization/point_places.h"
#include "nsfd/scene/scene_input.h"
#include "nsfd/state/point_kind.h"

#include <algorithm>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** Slots of every face, and of none more than that. */
    template <int dim>
    std::size_t most_at_a_face(const Cells<dim> &cells)
    {
      std::size_t most = 1;
      for (const auto &shape : cells.shapes)
        for (const unsigned int face : shape.slot_faces)
          most = std::max(
              most, std::size_t(std::count(shape.slot_faces.begin(),
                                           shape.slot_faces.end(), face)));
      return most;
    }

    /**
     * Points by cell, slot and, where several are at one slot, their order:
     * @p per_slot of them, @p per_face slots at each of @p n_faces. The same
     * for a cell in each discretization that has it: beyond a ghost there may
     * be cells of two sizes that only its own rank knows.
     */
    template <int dim>
    std::vector<unsigned int>
    points_at_slots(const Discretization<dim> &discretization,
                    const std::size_t n_faces, const std::size_t per_face,
                    const std::size_t per_slot)
    {
      const Cells<dim> &cells = discretization.cells();
      const Bodies &bodies = discretization.bodies();
      const auto none = unsigned(discretization.points().n_points);
      std::vector<unsigned int> result(
          bodies.size() * n_faces * per_face * per_slot, none);
      for_all_places(bodies, none,
                     [&](const std::size_t body, const unsigned int slot,
                         const std::size_t point, unsigned int) {
                       const auto &faces = cells.class_shape(body).slot_faces;
                       const unsigned int face = faces[slot];
                       const auto first =
                           std::find(faces.begin(), faces.end(), face);
                       const std::size_t at =
                           (body * n_faces + face) * per_face +
                           (slot - std::size_t(first - faces.begin()));
                       auto place = result.begin() + long(at * per_slot);
                       while (*place != none)
                         ++place;
                       *place = unsigned(point);
                     });
      return result;
    }

    /** The largest number of points at one slot. */
    std::size_t most_at_a_slot(const Bodies &bodies)
    {
      std::size_t most = 1;
      const auto &extra = bodies.extra_points;
      for (std::size_t k = 0, same = 1; k < extra.size(); ++k) {
        same = k > 0 && extra[k].first == extra[k - 1].first ? same + 1 : 1;
        most = std::max(most, same + 1);
      }
      return most;
    }

  } // namespace

  template <int dim>
  GhostLayer<dim>::GhostLayer(const Communicator &communicator,
                              const Discretization<dim> &own,
                              std::unique_ptr<const Discretization<dim>> all)
      : communicator_(communicator), own_(own), all_(std::move(all)),
        is_whole_(false)
  {
    match_cells(all_->cells().global_cell);
    match_points();
  }

  template <int dim>
  GhostLayer<dim>::GhostLayer(const Communicator &communicator,
                              const Discretization<dim> &own,
                              std::unique_ptr<const Discretization<dim>> whole,
                              const std::vector<unsigned long long> &numbers)
      : communicator_(communicator), own_(own), all_(std::move(whole)),
        is_whole_(true)
  {
    match_cells(numbers);
    match_points();
  }

  template <int dim>
  void
  GhostLayer<dim>::match_cells(const std::vector<unsigned long long> &numbers)
  {
    // both lists of cells are in the same order
    const auto &mine = own_.cells().global_cell;
    std::vector<std::uint8_t> ghost(numbers.size(), 1);
    for (std::size_t b = 0; b < numbers.size() && cell_.size() < mine.size();
         ++b)
      if (numbers[b] == mine[cell_.size()]) {
        ghost[b] = 0;
        cell_.push_back(b);
      }
    cells_.emplace(communicator_, numbers, std::move(ghost));
  }

  template <int dim>
  void GhostLayer<dim>::match_points()
  {
    const std::size_t n_faces =
        all_->cells().element->reference_cell().n_faces();
    const auto per_face =
        std::size_t(communicator_.max(double(most_at_a_face(all_->cells()))));
    const auto per_slot =
        std::size_t(communicator_.max(double(most_at_a_slot(all_->bodies()))));
    n_per_cell_ = n_faces * per_face * per_slot;
    points_of_cell_ = points_at_slots(*all_, n_faces, per_face, per_slot);
    const auto of_own = points_at_slots(own_, n_faces, per_face, per_slot);
    const auto none = unsigned(own_.points().n_points);
    point_.assign(none, unsigned(all_->points().n_points));
    for (std::size_t k = 0; k < of_own.size(); ++k)
      if (of_own[k] != none)
        point_[of_own[k]] =
            points_of_cell_[cell_[k / n_per_cell_] * n_per_cell_ +
                            k % n_per_cell_];
  }

  template <int dim>
  template <typename T>
  std::vector<T> GhostLayer<dim>::spread_points(const std::vector<T> &own,
                                                const unsigned int width) const
  {
    if (own.empty())
      return {};
    std::vector<T> all(all_->points().n_points * width, T());
    for (std::size_t i = 0; i < point_.size(); ++i)
      std::copy_n(&own[i * width], width, &all[std::size_t(point_[i]) * width]);
    return all;
  }

  template <int dim>
  template <typename T>
  std::vector<T> GhostLayer<dim>::own_points(const std::vector<T> &all,
                                             const unsigned int width) const
  {
    if (all.empty())
      return {};
    std::vector<T> own(point_.size() * width);
    for (std::size_t i = 0; i < point_.size(); ++i)
      std::copy_n(&all[std::size_t(point_[i]) * width], width, &own[i * width]);
    return own;
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::spread(const First &of_own, const First &of_all,
                          const std::vector<double> &own) const
  {
    std::vector<double> all(of_all.back(), 0.);
    for (std::size_t b = 0; b < cell_.size(); ++b)
      std::copy(own.begin() + long(of_own[b]),
                own.begin() + long(of_own[b + 1]),
                all.begin() + long(of_all[cell_[b]]));
    return all;
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::own_of(const First &of_own, const First &of_all,
                          const std::vector<double> &all) const
  {
    std::vector<double> own(of_own.back());
    for (std::size_t b = 0; b < cell_.size(); ++b)
      std::copy_n(all.begin() + long(of_all[cell_[b]]),
                  of_own[b + 1] - of_own[b], own.begin() + long(of_own[b]));
    return own;
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::spread_unknowns(const std::vector<double> &own) const
  {
    return spread(own_.bodies().first_dof, all_->bodies().first_dof, own);
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::own_unknowns(const std::vector<double> &all) const
  {
    return own_of(own_.bodies().first_dof, all_->bodies().first_dof, all);
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::own_cells(const std::vector<double> &all) const
  {
    std::vector<double> own;
    own.reserve(cell_.size());
    for (const std::size_t cell : cell_)
      own.push_back(all[cell]);
    return own;
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::spread_histories(const std::vector<double> &own) const
  {
    if (!own_.input().has_history())
      return own;
    return spread(first_histories(own_), first_histories(*all_), own);
  }

  template <int dim>
  std::vector<double>
  GhostLayer<dim>::own_histories(const std::vector<double> &all) const
  {
    if (!own_.input().has_history())
      return all;
    return own_of(first_histories(own_), first_histories(*all_), all);
  }

  template <int dim>
  template <typename T>
  void GhostLayer<dim>::fetch_points(const unsigned int width,
                                     std::vector<T> &all) const
  {
    if (!communicator_.any(!all.empty()))
      return; // there is no such field
    const std::size_t none = all_->points().n_points;
    all.resize(none * width);
    const auto per_cell = unsigned(n_per_cell_ * width);
    cells_->all().start(per_cell, [&](const std::size_t cell, double *values) {
      for (std::size_t k = 0; k < n_per_cell_; ++k) {
        const std::size_t i = points_of_cell_[cell * n_per_cell_ + k];
        for (unsigned int c = 0; i < none && c < width; ++c)
          values[k * width + c] = double(all[i * width + c]);
      }
    });
    cells_->all().finish(
        per_cell, [&](const std::size_t cell, const double *values) {
          for (std::size_t k = 0; k < n_per_cell_; ++k) {
            const std::size_t i = points_of_cell_[cell * n_per_cell_ + k];
            for (unsigned int c = 0; i < none && c < width; ++c)
              all[i * width + c] = T(values[k * width + c]);
          }
        });
  }

  template <int dim>
  void GhostLayer<dim>::fetch(const First &of_all,
                              std::vector<double> &all) const
  {
    std::size_t most = 0;
    for (std::size_t b = 0; b + 1 < of_all.size(); ++b)
      most = std::max(most, of_all[b + 1] - of_all[b]);
    const auto width = unsigned(communicator_.max(double(most)));
    const auto n = [&of_all](const std::size_t cell) {
      return of_all[cell + 1] - of_all[cell];
    };
    cells_->all().start(width, [&](const std::size_t cell, double *values) {
      std::copy_n(all.begin() + long(of_all[cell]), n(cell), values);
    });
    cells_->all().finish(
        width, [&](const std::size_t cell, const double *values) {
          std::copy_n(values, n(cell), all.begin() + long(of_all[cell]));
        });
  }

  template <int dim>
  void GhostLayer<dim>::fetch_unknowns(std::vector<double> &all) const
  {
    fetch(all_->bodies().first_dof, all);
  }

  template <int dim>
  void GhostLayer<dim>::fetch_histories(std::vector<double> &all) const
  {
    if (all_->input().has_history())
      fetch(first_histories(*all_), all);
  }

#define NSFD_INSTANTIATE_OF(dim, T)                                            \
  template std::vector<T> GhostLayer<dim>::spread_points(                      \
      const std::vector<T> &, unsigned int) const;                             \
  template std::vector<T> GhostLayer<dim>::own_points(const std::vector<T> &,  \
                                                      unsigned int) const;     \
  template void GhostLayer<dim>::fetch_points(unsigned int, std::vector<T> &)  \
      const
#define NSFD_INSTANTIATE(dim)                                                  \
  template class GhostLayer<dim>;                                              \
  NSFD_INSTANTIATE_OF(dim, double);                                            \
  NSFD_INSTANTIATE_OF(dim, std::uint8_t);                                      \
  NSFD_INSTANTIATE_OF(dim, PointKind)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
#undef NSFD_INSTANTIATE_OF
} // namespace nsfd
