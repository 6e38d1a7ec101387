#include "simd_system.h"

#include "core/cost.h"
#include "linear_algebra/gmres.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  using simd::ExactSum;
  using simd::width;

  template <int dim>
  SimdSystem<dim>::SimdSystem(const Communicator &communicator,
                              const Bodies &bodies,
                              const InterfacePoints<dim> &points)
      : communicator_(communicator), points_(points), layout_(bodies, points),
        X_(layout_.n_places, 0.f), Y_(layout_.n_places, 0.f)
  {
    for (Floats *v : {&x_, &r_, &z_, &p_, &w_})
      v->assign(layout_.size, 0.f);
  }

  template <int dim>
  void SimdSystem<dim>::prepare(const std::vector<double> &D)
  {
    const Charge charge(Cost::preconditioner);
    for (auto &group : layout_.face_groups) {
      const unsigned int n = group.n(), packed = group.packed();
      const auto &blocks =
          layout_.face_blocks[std::size_t(&group - layout_.face_groups.data())];
      part_.assign(group.D.size(), 0.);
      diagonal_.assign(group.D.size(), 0.);
      layout_.for_components(
          group, [&](const std::size_t k, const std::size_t at) {
            if (!(D[k] >= 0.))
              return;
            part_[at] = 1.;
            // beyond that nothing moves
            diagonal_[at] =
                std::min(D[k] / (layout_.scale[k] * layout_.scale[k]), 1e15);
          });
      for (std::size_t k = 0; k < group.D.size(); ++k)
        group.D[k] = float(diagonal_[k]);
      work_.resize(std::size_t(packed) * 16);
      for (std::size_t b = 0; b < group.n_batches; ++b)
        simd::invert(n, &blocks[b * packed * width], &diagonal_[b * n * width],
                     &part_[b * n * width], work_.data(),
                     &group.inverse[b * packed * width]);
    }
  }

  template <int dim>
  void SimdSystem<dim>::apply(const Floats &p)
  {
    ++applications_;
    for (const auto &group : layout_.face_groups)
      simd::scatter(group, p.data(), X_.data());
    for (const auto &extra : layout_.extras)
      for (unsigned int c = 0; c < dim; ++c)
        X_[extra.slot + c * width] += X_[extra.place + c * width];
    for (const auto &group : layout_.body_groups)
      simd::multiply_bodies(group, 0, group.n_shared, X_.data(), Y_.data());
    const auto copy_extras = [this]() {
      for (const auto &extra : layout_.extras)
        for (unsigned int c = 0; c < dim; ++c)
          Y_[extra.place + c * width] = Y_[extra.slot + c * width];
    };
    copy_extras();
    start_exchange();
    for (const auto &group : layout_.body_groups)
      simd::multiply_bodies(group, group.n_shared, group.n_batches, X_.data(),
                            Y_.data());
    copy_extras();
    finish_exchange();
  }

  template <int dim>
  void SimdSystem<dim>::start_exchange()
  {
    auto &messages = messages_.messages;
    messages.resize(points_.neighbors.size());
    for (std::size_t k = 0; k < messages.size(); ++k) {
      const auto &neighbor = points_.neighbors[k];
      messages[k].rank = neighbor.rank;
      messages[k].in.resize(neighbor.points.size() * dim);
      messages[k].out.clear();
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        for (unsigned int c = 0; c < dim; ++c)
          messages[k].out.push_back(
              Y_[layout_.place[neighbor.side[j]][neighbor.points[j]] +
                 c * width]);
    }
    messages_.start(communicator_.mpi(), 8);
  }

  template <int dim>
  void SimdSystem<dim>::finish_exchange()
  {
    messages_.finish();
    for (std::size_t k = 0; k < points_.neighbors.size(); ++k) {
      const auto &neighbor = points_.neighbors[k];
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        for (unsigned int c = 0; c < dim; ++c)
          Y_[layout_.place[1 - neighbor.side[j]][neighbor.points[j]] +
             c * width] = messages_.messages[k].in[j * dim + c];
    }
  }

  /** The first product, whose size nothing tells. */
  template <int dim>
  double SimdSystem<dim>::product(const Floats &a, const Floats &b)
  {
    std::size_t n = 0;
    for (const auto &group : layout_.face_groups)
      n += group.faces.size();
    terms_.resize(n);
    n = 0;
    for (const auto &group : layout_.face_groups) {
      simd::face_products(group, a.data(), b.data(), terms_.data() + n);
      n += group.faces.size();
    }
    return communicator_.sum(terms_);
  }

  template <int dim>
  void SimdSystem<dim>::reduce(ExactSum *sums, const unsigned int count) const
  {
    if (communicator_.size() == 1)
      return;
    std::vector<double> values(count);
    for (unsigned int k = 0; k < count; ++k)
      values[k] = sums[k].value;
    MPI_Allreduce(MPI_IN_PLACE, values.data(), int(count), MPI_DOUBLE, MPI_SUM,
                  communicator_.mpi());
    for (unsigned int k = 0; k < count; ++k)
      sums[k].value = values[k];
  }

  template <int dim>
  double SimdSystem<dim>::scale_of(const std::vector<double> &r,
                                   const bool by_velocity) const
  {
    double largest = 0.;
    for (std::size_t k = 0; k < r.size(); ++k)
      largest =
          std::max(largest, by_velocity ? std::abs(r[k]) / layout_.scale[k]
                                        : std::abs(r[k]) * layout_.scale[k]);
    return communicator_.max(largest);
  }

  /** For krylov::conjugate_gradients(), in the fused loops of the kernels. */
  template <int dim>
  struct SimdSystem<dim>::Directions {
    SimdSystem &s;
    double alpha = 0., rz = 0.;
    bool first = true;

    bool is_solved() { return false; }

    /** Makes up for the last advance() in the same loop. */
    double precondition()
    {
      ExactSum sum(first ? 1. : rz);
      for (const auto &group : s.layout_.face_groups)
        simd::advance(group, float(alpha), s.p_.data(), s.w_.data(),
                      s.x_.data(), s.r_.data(), s.z_.data(), sum);
      if (first) // nothing tells its size
        rz = s.product(s.r_, s.z_);
      else {
        s.reduce(&sum, 1);
        rz = sum.value;
      }
      first = false;
      return rz;
    }

    void turn(const double beta)
    {
      if (beta == 0.)
        s.p_ = s.z_;
      else
        simd::combine(s.layout_.size, float(beta), s.z_.data(), s.p_.data());
    }

    double multiply()
    {
      ExactSum sum(rz);
      {
        const Charge product(Cost::delassus_single);
        s.apply(s.p_);
        for (const auto &group : s.layout_.face_groups)
          simd::gather(group, s.Y_.data(), s.p_.data(), s.w_.data(), sum);
      }
      s.reduce(&sum, 1);
      return sum.value;
    }

    void advance(const double step) { alpha = step; }
  };

  template <int dim>
  unsigned int
  SimdSystem<dim>::conjugate_gradients(const InnerSystem &system,
                                       const std::vector<double> &r,
                                       std::vector<double> &x)
  {
    prepare(system.D);
    const Charge charge(Cost::solver);
    // units of the largest entry: what is left stays in the range of floats
    const double largest = scale_of(r, true);
    std::fill(x.begin(), x.end(), 0.);
    if (!(largest > 0.) || !std::isfinite(largest))
      return 0;
    for (const auto &group : layout_.face_groups)
      layout_.for_components(
          group, [&](const std::size_t k, const std::size_t at) {
            r_[group.first + at] = float(r[k] / (layout_.scale[k] * largest));
          });
    for (Floats *v : {&x_, &p_, &w_})
      set_zero(*v);
    Directions directions{*this};
    const auto outcome = krylov::conjugate_gradients(
        directions, {system.tolerance, system.limit});
    for (const auto &group : layout_.face_groups)
      layout_.for_components(
          group, [&](const std::size_t j, const std::size_t at) {
            x[j] = largest * double(x_[group.first + at]) / layout_.scale[j];
          });
    return outcome.iterations;
  }

  template <int dim>
  void SimdSystem<dim>::prepare_coupled(const InnerSystem &system)
  {
    const auto &J = *system.jacobian, &R = *system.majorant, &D = system.D;
    for (auto &group : layout_.face_groups)
      layout_.for_components(
          group, [&](const std::size_t k, const std::size_t at) {
            const double square = layout_.scale[k] * layout_.scale[k];
            const bool part = D[k] >= 0.;
            group.weight[at] =
                part ? float(std::min((D[k] + R[k]) / square, 1e15)) : 0.f;
            group.idle[at] = part ? 0.f : 1.f;
            group.ratio[at] = float((1. - system.shift) * R[k] / square);
            // `at` counts rows of one lane; the blocks have dim entries in each
            const std::size_t row = at / width * dim * width + at % width,
                              first = k - k % dim;
            for (unsigned int c = 0; c < dim; ++c)
              group.jacobian[row + c * width] = float(
                  layout_.scale[k] * J[k * dim + c] * layout_.scale[first + c]);
          });
  }

  /**
   * Makes vector k + 1 of the basis orthogonal to those before it, in h their
   * products; returns its norm, of which @p scale holds the size before and
   * after. Twice where most of it goes: the first time leaves rounding errors.
   */
  template <int dim>
  double SimdSystem<dim>::orthogonalise(const unsigned int k, double &scale,
                                        double *h)
  {
    std::vector<const float *> V(k + 2);
    for (unsigned int j = 0; j < k + 2; ++j)
      V[j] = basis_[j].data();
    float *w = basis_[k + 1].data();
    std::vector<float> share(k + 1);
    std::fill(h, h + k + 1, 0.);
    double before = 0., after = 0.;
    for (unsigned int round = 0; round < 2; ++round) {
      std::vector<ExactSum> sums(k + 2, ExactSum(scale));
      for (const auto &group : layout_.face_groups)
        simd::dots(group, V.data(), k + 2, w, sums.data());
      reduce(sums.data(), k + 2);
      before = std::sqrt(std::max(0., sums[k + 1].value));
      if (round == 0)
        scale = before * before;
      for (unsigned int j = 0; j <= k; ++j) {
        share[j] = float(sums[j].value);
        h[j] += double(share[j]);
      }
      simd::subtract(layout_.size, V.data(), share.data(), k + 1, w);
      ExactSum norm(before * before);
      const float *self = w;
      for (const auto &group : layout_.face_groups)
        simd::dots(group, &self, 1, w, &norm);
      reduce(&norm, 1);
      after = std::sqrt(std::max(0., norm.value));
      if (!(after < 0.1 * before))
        break;
    }
    return after;
  }

  /** For krylov::gmres(), with coefficients in single precision. */
  template <int dim>
  struct SimdSystem<dim>::Basis {
    using Number = float;

    SimdSystem &s;
    double scale = 0.;

    double start()
    {
      Floats &v = s.basis_[0];
      const double length = std::sqrt(s.product(v, v));
      for (float &value : v)
        value /= float(length);
      return length;
    }

    double extend(const unsigned int k, double *h)
    {
      if (s.basis_.size() < k + 2)
        s.basis_.emplace_back(s.layout_.size, 0.f);
      for (const auto &group : s.layout_.face_groups)
        simd::precondition(group, s.basis_[k].data(), s.z_.data());
      {
        const Charge product(Cost::delassus_single);
        s.apply(s.z_);
        for (const auto &group : s.layout_.face_groups)
          simd::gather_coupled(group, s.Y_.data(), s.z_.data(),
                               s.basis_[k + 1].data());
      }
      if (k == 0)
        scale = s.product(s.basis_[1], s.basis_[1]);
      const double length = s.orthogonalise(k, scale, h);
      if (length > 0.)
        for (float &value : s.basis_[k + 1])
          value *= float(1. / length);
      return length;
    }

    /** Into z. */
    void combine(Floats y)
    {
      std::vector<const float *> V(y.size());
      for (std::size_t j = 0; j < y.size(); ++j) {
        V[j] = s.basis_[j].data();
        y[j] = -y[j];
      }
      s.set_zero(s.r_);
      simd::subtract(s.layout_.size, V.data(), y.data(),
                     static_cast<unsigned int>(y.size()), s.r_.data());
      for (const auto &group : s.layout_.face_groups)
        simd::precondition(group, s.r_.data(), s.z_.data());
    }
  };

  template <int dim>
  unsigned int SimdSystem<dim>::gmres(const InnerSystem &system,
                                      const std::vector<double> &r,
                                      std::vector<double> &x)
  {
    prepare(system.D);
    const Charge charge(Cost::solver);
    prepare_coupled(system);
    std::fill(x.begin(), x.end(), 0.);
    const double largest = scale_of(r, false);
    if (!(largest > 0.) || !std::isfinite(largest))
      return 0;
    if (basis_.empty())
      basis_.emplace_back(layout_.size, 0.f);
    for (const auto &group : layout_.face_groups)
      layout_.for_components(group, [&](const std::size_t k,
                                        const std::size_t at) {
        basis_[0][group.first + at] = float(r[k] * layout_.scale[k] / largest);
      });
    Basis basis{*this};
    const auto outcome = krylov::gmres(basis, {system.tolerance, system.limit});
    for (const auto &group : layout_.face_groups)
      layout_.for_components(
          group, [&](const std::size_t j, const std::size_t at) {
            x[j] = largest * double(z_[group.first + at]) / layout_.scale[j];
          });
    return outcome.iterations;
  }

  template class SimdSystem<2>;
  template class SimdSystem<3>;
} // namespace nsfd
