#include "leapfrog_contacts.h"

#include "local_product.h"
#include "passing_bodies.h"

#include "nsfd/scene/scene_input.h"

#include <algorithm>
#include <cmath>

// LeapfrogContacts: the end of a step.

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /** To the end of a step of length @p h from @p time. */
    void move_obstacles(const SceneInput &input, const double time,
                        const double h, std::vector<double> &shift)
    {
      for (std::size_t k = 0; k < shift.size(); ++k)
        if (const auto &v = input.obstacles[k / 3].velocity[k % 3])
          shift[k] += h * v->at(Point<3>(), time + h / 2.);
    }
  } // namespace

  template <int dim>
  std::optional<StepRejected>
  LeapfrogContacts<dim>::missed(const CornerGroups<dim> &groups)
  {
    after_.displacement.resize(state_.displacement.size());
    groups.scatter(groups.displacement, after_.displacement);
    if (rigid_)
      rigid_->show(after_);
    after_.obstacle_shift = state_.obstacle_shift;
    move_obstacles(input_, state_.time, time_step_, after_.obstacle_shift);
    const auto missed = surfaces_.missed(state_, after_);
    if (!missed)
      return std::nullopt;
    return passing_bodies(input_, discretization_.body_table(), *missed,
                          state_.time, time_step_);
  }

  template <int dim>
  auto LeapfrogContacts<dim>::account(const CornerGroups<dim> &groups)
      -> Balance
  {
    Balance balance;
    for (Contact &contact : contacts_) {
      contact.velocity = relative_velocity(contact, groups.velocity);
      const auto &row = contact.row;
      const Vector &P = contact.impulse;
      Vector mean;
      for (unsigned int c = 0; c < dim; ++c)
        mean[c] = (contact.velocity[c] + contact.before[c]) / 2.;
      const double rubbing = tangential_dot<dim>(P, mean);
      // to push apart what slides is a part of what friction takes
      const double pushing = P[0] * mean[0],
                   of_friction =
                       contact.friction > 0. ? std::max(0., pushing) : 0.;
      balance.impact -= pushing - of_friction;
      balance.friction -= rubbing + of_friction;
      balance.positive_friction += std::max(0., rubbing);
      balance.work += product<dim>(P, contact.obstacle);
      balance.active += P[0] > 0.;
      balance.penetration = std::max(balance.penetration, -row.gap);
      balance.excess =
          std::max(balance.excess, -row.gap - 1.001 * contact.known);
    }
    return balance;
  }

  template <int dim>
  void LeapfrogContacts<dim>::accept()
  {
    surfaces_.store_facets(state_);
    std::fill(state_.surface_impulse.begin(), state_.surface_impulse.end(), 0.);
    std::fill(state_.surface_contact.begin(), state_.surface_contact.end(), 0);
    state_.touches.clear();
    for (const Contact &contact : contacts_) {
      const auto &row = contact.row;
      const std::size_t place = row.place;
      const Vector &U = contact.velocity;
      // facets that turn take any motion to a part across them
      const double way =
          time_step_ *
          std::sqrt(std::max(product<dim>(U, U),
                             product<dim>(contact.before, contact.before)));
      for (const std::size_t one : contact.places) {
        double &approach = state_.surface_approach[one],
               &overlap = state_.surface_overlap[one];
        approach = std::max({approach, row.approach, way});
        overlap =
            std::max({overlap, row.overlap, row.released ? -row.gap : 0.});
      }
      if (contact.impulse[0] <= 0.)
        continue;
      state_.surface_contact[place] |= SurfaceContacts<dim>::touches;
      state_.surface_slip[place] +=
          time_step_ * std::sqrt(tangential_dot<dim>(U, U));
      SurfaceTouch touch;
      touch.obstacle = row.partner == MovingRow<dim>::Partner::obstacle;
      touch.block = row.block;
      touch.material_2 =
          discretization_.body_table().bodies[row.body_2].material;
      touch.weight = row.weight;
      touch.opening = row.gap + time_step_ * U[0];
      for (unsigned int c = 0; c < dim; ++c) {
        touch.position[c] = contact.place[c];
        touch.normal[c] = contact.frame[c];
        for (unsigned int r = 0; r < dim; ++r)
          touch.impulse[c] += contact.frame[r * dim + c] * contact.impulse[r];
        state_.surface_impulse[place * dim + c] += touch.impulse[c];
      }
      state_.touches.push_back(touch);
    }
    move_obstacles(input_, state_.time, time_step_, state_.obstacle_shift);
    state_.last_step = time_step_;
  }

  template <int dim>
  void LeapfrogContacts<dim>::add_impulses(const std::vector<int> &row_of_group,
                                           std::vector<double> &rows) const
  {
    for (const Contact &contact : contacts_)
      for (const auto &[group, share] : contact.ends) {
        const int row = group < row_of_group.size() ? row_of_group[group] : -1;
        if (row < 0)
          continue;
        for (unsigned int r = 0; r < dim; ++r)
          for (unsigned int c = 0; c < dim; ++c)
            rows[std::size_t(row) * dim + c] +=
                share * contact.frame[r * dim + c] * contact.impulse[r];
      }
  }

  template <int dim>
  void LeapfrogContacts<dim>::show(State &state) const
  {
    state.obstacle_shift = state_.obstacle_shift;
    state.surface_impulse = state_.surface_impulse;
    state.surface_slip = state_.surface_slip;
    state.surface_worn = state_.surface_worn;
    state.surface_wear_speed = state_.surface_wear_speed;
    state.surface_overlap = state_.surface_overlap;
    state.surface_approach = state_.surface_approach;
    state.surface_contact = state_.surface_contact;
    state.surface_facet = state_.surface_facet;
    state.surface_gap = state_.surface_gap;
    state.touches = state_.touches;
  }

  template <int dim>
  void
  LeapfrogContacts<dim>::fill_counters(std::map<std::string, double> &c) const
  {
    const auto &contacts = surfaces_.counters();
    c["contact_searches"] = double(contacts.searches);
    c["contact_facets"] = double(contacts.facets);
    c["contact_rows"] = double(contacts.rows);
    c["contact_overlap"] = contacts.largest_overlap;
    c["contact_problems_above_tolerance"] = double(inexact_);
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::optional<StepRejected> LeapfrogContacts<dim>::missed(          \
      const CornerGroups<dim> &);                                              \
  template auto LeapfrogContacts<dim>::account(const CornerGroups<dim> &)      \
      ->Balance;                                                               \
  template void LeapfrogContacts<dim>::accept();                               \
  template void LeapfrogContacts<dim>::add_impulses(                           \
      const std::vector<int> &, std::vector<double> &) const;                  \
  template void LeapfrogContacts<dim>::show(State &) const;                    \
  template void LeapfrogContacts<dim>::fill_counters(                          \
      std::map<std::string, double> &) const
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
