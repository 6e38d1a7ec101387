#include "surface_history.h"

#include "bodies/surface_contacts.h"
#include "core/gather.h"

#include <algorithm>

namespace nsfd
{
  /** What a contact leaves to its place. */
  template <int dim>
  struct SurfaceHistory<dim>::OfContact {
    std::size_t index, place, twin; ///< index of the row
    std::size_t place_of_impulse;
    std::array<double, dim> impulse;
    double slip, overlap, approach, worn, wear_speed;
    std::uint8_t contact;
  };

  template <int dim>
  void SurfaceHistory<dim>::take(const State &old, State &with_contacts) const
  {
    for (std::size_t k = 0; k < contacts_.rows().size(); ++k)
      if (contacts_.rows()[k].place != MovingRow<dim>::nowhere)
        take(k, old, with_contacts);
  }

  template <int dim>
  void SurfaceHistory<dim>::take(const std::size_t k, const State &old,
                                 State &to) const
  {
    const MovingRow<dim> &row = contacts_.rows()[k];
    const std::size_t i = contacts_.row_point(k);
    to.slip[i] = old.surface_slip[row.place];
    to.approach[i] = std::max(row.approach, old.surface_approach[row.place]);
    to.released_overlap[i] =
        std::max(row.overlap, old.surface_overlap[row.place]);
    if (row.twin != row.nowhere) {
      to.approach[i] = std::max(to.approach[i], old.surface_approach[row.twin]);
      to.released_overlap[i] =
          std::max(to.released_overlap[i], old.surface_overlap[row.twin]);
    }
    // crack faces of springs that were closed are born with their overlap
    if (row.released)
      to.released_overlap[i] = std::max(to.released_overlap[i], -row.gap);
    to.contact[i] =
        old.surface_contact[row.place] & SurfaceContacts<dim>::touches;
    if (!to.worn.empty()) {
      to.worn[i] = old.surface_worn[row.place];
      to.wear_speed[i] = old.surface_wear_speed[row.place];
    }
  }

  template <int dim>
  void SurfaceHistory<dim>::add_impulses(const State &old,
                                         std::vector<double> &impulse) const
  {
    const auto &rows = contacts_.rows();
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (unsigned int a = 0; a < dim && rows[k].place != rows[k].nowhere; ++a)
        for (unsigned int d = 0; d < dim; ++d) {
          const std::size_t i = contacts_.row_point(k);
          impulse[i * dim + a] +=
              rows[k].share * contacts_.points().axes(i)[a * dim + d] *
              old.surface_impulse[place_of_impulse(rows[k]) * dim + d];
        }
  }

  template <int dim>
  std::vector<typename SurfaceHistory<dim>::OfContact>
  SurfaceHistory<dim>::own_contacts(const State &next) const
  {
    std::vector<OfContact> result;
    for (std::size_t k = 0; k < contacts_.n_own_rows(); ++k) {
      const MovingRow<dim> &row = contacts_.rows()[k];
      const std::size_t i = contacts_.row_point(k);
      if (row.place == row.nowhere)
        continue;
      OfContact contact{};
      contact.index = row.index;
      contact.place = row.place;
      contact.twin = row.twin;
      contact.place_of_impulse = place_of_impulse(row);
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          contact.impulse[d] += contacts_.points().axes(i)[a * dim + d] *
                                next.impulse[i * dim + a];
      contact.slip = next.slip[i];
      contact.overlap = next.released_overlap[i];
      contact.approach = next.approach[i];
      contact.contact = next.contact[i];
      if (!next.worn.empty()) {
        contact.worn = next.worn[i];
        contact.wear_speed = next.wear_speed[i];
      }
      result.push_back(contact);
    }
    return result;
  }

  template <int dim>
  void SurfaceHistory<dim>::leave(const State &old, State &next) const
  {
    next.surface_impulse.assign(old.surface_impulse.size(), 0.);
    next.surface_slip = old.surface_slip;
    next.surface_worn = old.surface_worn;
    next.surface_wear_speed.assign(old.surface_wear_speed.size(), 0.);
    next.surface_overlap = old.surface_overlap;
    next.surface_approach = old.surface_approach;
    next.surface_contact.assign(old.surface_contact.size(), 0);
    const auto raise = [](std::vector<double> &values, const std::size_t place,
                          const double value) {
      values[place] = std::max(values[place], value);
    };
    auto contacts = gather_all(all_, own_contacts(next));
    std::sort(contacts.begin(), contacts.end(),
              [](const auto &a, const auto &b) { return a.index < b.index; });
    for (const OfContact &contact : contacts) {
      for (unsigned int d = 0; d < dim; ++d)
        next.surface_impulse[contact.place_of_impulse * dim + d] +=
            contact.impulse[d];
      next.surface_slip[contact.place] = contact.slip;
      for (const std::size_t place : {contact.place, contact.twin})
        if (place != MovingRow<dim>::nowhere) {
          raise(next.surface_overlap, place, contact.overlap);
          raise(next.surface_approach, place, contact.approach);
        }
      next.surface_contact[contact.place] |= contact.contact;
      if (!next.worn.empty()) {
        next.surface_worn[contact.place] = contact.worn;
        next.surface_wear_speed[contact.place] = contact.wear_speed;
      }
    }
  }

  template <int dim>
  std::vector<SurfaceTouch>
  SurfaceHistory<dim>::touches(const State &next) const
  {
    std::vector<SurfaceTouch> result;
    const auto &points = contacts_.points();
    for (std::size_t k = 0; k < contacts_.n_own_rows(); ++k) {
      const MovingRow<dim> &row = contacts_.rows()[k];
      const std::size_t i = contacts_.row_point(k);
      if (row.partner == MovingRow<dim>::Partner::pin || !next.contact[i])
        continue;
      SurfaceTouch &touch = result.emplace_back();
      touch.obstacle = row.partner == MovingRow<dim>::Partner::obstacle;
      touch.block = row.block;
      touch.material_2 =
          discretization_.body_table().bodies[row.body_2].material;
      touch.weight = row.weight;
      touch.opening = next.jump[i * dim];
      for (unsigned int d = 0; d < dim; ++d) {
        touch.position[d] = points.position[i * dim + d];
        touch.normal[d] = points.axes(i)[d];
        for (unsigned int a = 0; a < dim; ++a)
          touch.impulse[d] +=
              points.axes(i)[a * dim + d] * next.impulse[i * dim + a];
      }
    }
    return result;
  }

  template class SurfaceHistory<2>;
  template class SurfaceHistory<3>;
} // namespace nsfd
