#include "large_motion_model.h"

#include <algorithm>

namespace nsfd
{
  template <int dim>
  void LargeMotionModel<dim>::linearise()
  {
    tangent_velocity_ = bodies_.velocity();
    bodies_.set_middle();
    parts_.delassus.renew(time_step_, parts_.input.time.theta);
    set_problem();
    forecast(applied_.empty());
  }

  template <int dim>
  bool LargeMotionModel<dim>::predict(const bool starts_cold,
                                      std::vector<double> &impulse)
  {
    linearise();
    impulse = old_.impulse;
    if (starts_cold)
      std::fill(impulse.begin(), impulse.end(), 0.);
    else {
      history_.add_impulses(*start_, impulse);
      // what does not touch in this step has none
      for (std::size_t i = 0; i < problem_.n_points; ++i)
        if (problem_.kind[i] == PointKind::free && !problem_.contact[i])
          std::fill_n(impulse.begin() + long(i * dim), dim, 0.);
    }
    if (move(impulse, tangent_velocity_))
      return true;
    // those of the last step may be too much for a cell now
    std::fill(impulse.begin(), impulse.end(), 0.);
    return move(impulse, tangent_velocity_);
  }

  /**
   * Linear bodies may foretell impulses under which a cell would be turned
   * inside out: then only a part of the way to them is gone, from those of the
   * motion at hand, and the next round goes on from there.
   */
  template <int dim>
  bool LargeMotionModel<dim>::move(const std::vector<double> &impulse,
                                   const std::vector<double> &v)
  {
    std::vector<double> P(impulse), r(v.size());
    for (std::size_t k = 0; k < pressure_impulse_.size(); ++k)
      P[k] += pressure_impulse_[k];
    parts_.delassus.generalised_impulse(P.data(), r.data());
    constexpr double least_share = 1. / 64.;
    const Communicator &all = parts_.delassus.communicator();
    const std::vector<double> before(bodies_.velocity());
    share_ = 1.;
    if (!all.any(!bodies_.move(r, v))) {
      applied_ = r;
      return true;
    }
    if (applied_.empty())
      return false;
    std::vector<double> some_r(r.size()), some_v(v.size());
    while (share_ > least_share) {
      share_ /= 2.;
      for (std::size_t i = 0; i < r.size(); ++i) {
        some_r[i] = applied_[i] + share_ * (r[i] - applied_[i]);
        some_v[i] = before[i] + share_ * (v[i] - before[i]);
      }
      if (!all.any(!bodies_.move(some_r, some_v))) {
        applied_ = some_r;
        return true;
      }
    }
    return false;
  }

  template <int dim>
  double LargeMotionModel<dim>::error() const
  {
    std::vector<double> change(bodies_.velocity());
    for (std::size_t k = 0; k < change.size(); ++k)
      change[k] -= tangent_velocity_[k];
    return kinetic_product(change) / (share_ * share_);
  }

  /** Traces and frames are others now than those that the impulses of this
      motion have acted by: what these would do by the new ones is another
      motion. */
  template <int dim>
  std::vector<double>
  LargeMotionModel<dim>::free_velocity(const std::vector<double> &) const
  {
    std::vector<double> less(applied_.size()), v(bodies_.velocity()),
        change(v.size());
    if (!pressure_impulse_.empty())
      parts_.delassus.generalised_impulse(pressure_impulse_.data(),
                                          less.data());
    for (std::size_t i = 0; i < less.size(); ++i)
      less[i] -= applied_[i];
    parts_.delassus.apply(DelassusOperator<dim>::Operator::inverse, less.data(),
                          change.data());
    for (std::size_t i = 0; i < v.size(); ++i)
      v[i] += change[i];
    return v;
  }

#define INSTANTIATE(dim)                                                       \
  template void LargeMotionModel<dim>::linearise();                            \
  template bool LargeMotionModel<dim>::predict(bool, std::vector<double> &);   \
  template bool LargeMotionModel<dim>::move(const std::vector<double> &,       \
                                            const std::vector<double> &);      \
  template double LargeMotionModel<dim>::error() const;                        \
  template std::vector<double> LargeMotionModel<dim>::free_velocity(           \
      const std::vector<double> &) const

  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace nsfd
