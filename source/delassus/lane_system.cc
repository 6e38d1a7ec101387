#include "lane_system.h"

#include "core/cost.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd
{
  using lane::ExactSum;
  using lane::FaceGroup;
  using lane::width;

  namespace
  {
    constexpr unsigned int none = static_cast<unsigned int>(-1);

    /** Entries of H that are not zero, column by column. */
    std::vector<unsigned int> pattern_of(const Block &trace)
    {
      std::vector<unsigned int> pattern;
      for (unsigned int k = 0; k < trace.cols; ++k)
        for (unsigned int r = 0; r < trace.rows; ++r)
          if (trace(r, k) != 0.)
            pattern.push_back(k * trace.rows + r);
      return pattern;
    }

    void set_pattern(const Block &trace, lane::BodyGroup &group)
    {
      group.rows = trace.rows;
      group.dofs = trace.cols;
      group.column_first = group.row_first = {0};
      for (unsigned int k = 0; k < trace.cols; ++k) {
        for (unsigned int r = 0; r < trace.rows; ++r)
          if (trace(r, k) != 0.)
            group.column_row.push_back(r);
        group.column_first.push_back(
            static_cast<unsigned int>(group.column_row.size()));
      }
      for (unsigned int r = 0; r < trace.rows; ++r) {
        for (unsigned int k = 0; k < trace.cols; ++k)
          if (trace(r, k) != 0.)
            group.row_column.push_back(k);
        group.row_first.push_back(
            static_cast<unsigned int>(group.row_column.size()));
      }
      const std::size_t factored =
          2 * group.row_column.size() + std::size_t(group.dofs) * group.dofs;
      group.dense = std::size_t(group.rows) * group.rows <= factored;
    }
  } // namespace

  template <int dim>
  LaneSystem<dim>::LaneSystem(const Communicator &communicator,
                              const Bodies &bodies,
                              const InterfacePoints<dim> &points)
      : communicator_(communicator), bodies_(bodies), points_(points)
  {
    group_bodies();
    group_faces();
    place_points();
  }

  /** Large classes by themselves, others by the pattern of their traces. */
  template <int dim>
  void LaneSystem<dim>::group_bodies()
  {
    std::map<std::vector<unsigned int>, std::vector<unsigned int>> mixed;
    std::vector<unsigned int> leaders;
    for (const BodyClass &body : bodies_.classes) {
      if (body.bodies.empty() || body.n_slots == 0)
        continue;
      if (body.bodies.size() >= width / 2) {
        set_pattern(body.trace, body_groups_.emplace_back());
        body_groups_.back().shared = true;
        members_.push_back(body.bodies);
        continue;
      }
      auto key = pattern_of(body.trace);
      key.push_back(body.trace.rows);
      key.push_back(body.trace.cols);
      auto &members = mixed[key];
      members.insert(members.end(), body.bodies.begin(), body.bodies.end());
    }
    for (const auto &[key, members] : mixed) {
      set_pattern(bodies_.classes[bodies_.class_of[members.front()]].trace,
                  body_groups_.emplace_back());
      members_.push_back(members);
    }
    const std::vector<char> shared = shared_bodies(bodies_, points_);
    for (std::size_t g = 0; g < body_groups_.size(); ++g) {
      auto &group = body_groups_[g];
      // first what other ranks wait for
      const auto others = std::stable_partition(
          members_[g].begin(), members_[g].end(),
          [&](const unsigned int b) { return shared[b] != 0; });
      group.n_shared =
          (std::size_t(others - members_[g].begin()) + width - 1) / width;
      group.n_batches = (members_[g].size() + width - 1) / width;
      group.first = n_slots_;
      n_slots_ += group.n_batches * group.rows * width;
    }
  }

  template <int dim>
  void LaneSystem<dim>::group_faces()
  {
    std::map<unsigned int, std::vector<unsigned int>> by_count;
    for (std::size_t f = 0; f < points_.faces.size(); ++f)
      by_count[points_.faces[f].count].push_back(static_cast<unsigned int>(f));
    for (auto &[count, faces] : by_count) {
      FaceGroup &group = face_groups_.emplace_back();
      group.dim = dim;
      group.count = count;
      group.n_batches = (faces.size() + width - 1) / width;
      group.first = size_;
      faces.resize(group.n_batches * width, none);
      group.faces = std::move(faces);
      size_ += group.n_batches * group.n() * width;
      group.owned.assign(group.n_batches * width, 0.f);
      for (std::size_t l = 0; l < group.faces.size(); ++l)
        if (group.faces[l] != none &&
            points_.faces[group.faces[l]].first < points_.n_owned)
          group.owned[l] = 1.f;
    }
  }

  /**
   * Behind the slots of the bodies: one place that is zero and read by sides
   * without a body, one per side that another rank computes, one per further
   * point of a slot.
   */
  template <int dim>
  void LaneSystem<dim>::place_points()
  {
    const int nowhere = int(n_slots_);
    std::size_t end = n_slots_ + dim * width;
    for (auto &side : place_)
      side.assign(points_.n_points, nowhere);
    std::vector<std::size_t> first_row(bodies_.size());
    for (std::size_t g = 0; g < body_groups_.size(); ++g)
      for (std::size_t m = 0; m < members_[g].size(); ++m) {
        const unsigned int b = members_[g][m];
        first_row[b] = body_groups_[g].first +
                       m / width * body_groups_[g].rows * width + m % width;
        for (std::size_t s = bodies_.first_slot[b];
             s < bodies_.first_slot[b + 1]; ++s)
          if (bodies_.slot_point[s] < points_.n_points)
            place_[bodies_.slot_sign[s] > 0][bodies_.slot_point[s]] =
                int(first_row[b] + (s - bodies_.first_slot[b]) * dim * width);
      }
    for (const auto &[slot, point] : bodies_.extra_points) {
      const std::size_t b = std::upper_bound(bodies_.first_slot.begin(),
                                             bodies_.first_slot.end(), slot) -
                            bodies_.first_slot.begin() - 1;
      extras_.push_back(
          {int(first_row[b] + (slot - bodies_.first_slot[b]) * dim * width),
           int(end)});
      place_[1][point] = int(end);
      end += dim * width;
    }
    for (const auto &neighbor : points_.neighbors)
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        place_[1 - neighbor.side[j]][neighbor.points[j]] = int(end);
        end += dim * width;
      }
    X_.assign(end, 0.f);
    Y_.assign(end, 0.f);
    for (auto &group : face_groups_) {
      group.place.assign(group.n_batches * group.count * 2 * width, nowhere);
      for (std::size_t l = 0; l < group.faces.size(); ++l)
        if (group.faces[l] != none)
          for (unsigned int q = 0; q < group.count; ++q)
            for (unsigned int s = 0; s < 2; ++s)
              group.place[((l / width * group.count + q) * 2 + s) * width +
                          l % width] =
                  place_[s][points_.faces[group.faces[l]].first + q];
    }
    for (Floats *v : {&x_, &r_, &z_, &p_, &w_})
      v->assign(size_, 0.f);
  }

  /** Calls function(component of the points, where it is in the group). */
  template <int dim>
  template <typename Function>
  void LaneSystem<dim>::for_components(const FaceGroup &group,
                                       const Function &function) const
  {
    const unsigned int n = group.n();
    for (std::size_t l = 0; l < group.faces.size(); ++l)
      if (group.faces[l] != none) {
        const std::size_t first =
            std::size_t(points_.faces[group.faces[l]].first) * dim;
        const std::size_t at = l / width * n * width + l % width;
        for (unsigned int k = 0; k < n; ++k)
          function(first + k, at + k * width);
      }
  }

  template <int dim>
  void LaneSystem<dim>::reinit(const Dynamics<dim> &dynamics)
  {
    // by the root of the diagonal of W
    scale_.assign(points_.n_points * dim, 1.);
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      const unsigned int n = points_.faces[f].count * dim;
      const double *W = dynamics.face_block(f);
      for (unsigned int k = 0; k < n; ++k)
        if (W[k * n + k] > 0.)
          scale_[std::size_t(points_.faces[f].first) * dim + k] =
              std::sqrt(W[k * n + k]);
    }
    unit_ = 0.;
    for (const double s : scale_)
      unit_ = std::max(unit_, s * s);
    unit_ = std::ldexp(1., std::ilogb(communicator_.max(unit_)));
    for (std::size_t g = 0; g < body_groups_.size(); ++g)
      set_values(dynamics, body_groups_[g], members_[g]);
    face_blocks_.resize(face_groups_.size());
    for (auto &group : face_groups_)
      set_faces(dynamics, group);
  }

  /** The blocks in units in which those of the traces are of order one. */
  template <int dim>
  void LaneSystem<dim>::set_values(const Dynamics<dim> &dynamics,
                                   lane::BodyGroup &group,
                                   const std::vector<unsigned int> &members)
  {
    const unsigned int order = group.dense ? group.rows : group.dofs;
    const std::size_t lanes = group.shared ? 1 : group.n_batches * width;
    const unsigned int step = group.shared ? 1 : width;
    group.matrix.assign(lanes * order * order, 0.f);
    group.by_column.assign(lanes * group.column_row.size(), 0.f);
    group.by_row.assign(lanes * group.row_column.size(), 0.f);
    for (std::size_t m = 0; m < (group.shared ? 1 : members.size()); ++m) {
      const unsigned int k = bodies_.class_of[members[m]];
      const auto &blocks = dynamics.class_blocks()[k];
      const Block &A = group.dense ? blocks.delassus : blocks.inverse,
                  &H = bodies_.classes[k].trace;
      const auto at = [&](const std::size_t entries, const std::size_t e) {
        return (m / width * entries + e) * step + m % width;
      };
      for (unsigned int c = 0; c < order; ++c)
        for (unsigned int r = 0; r < order; ++r)
          group.matrix[at(std::size_t(order) * order, c * order + r)] =
              float(A(r, c) / unit_);
      std::size_t e = 0;
      for (unsigned int c = 0; c < group.dofs; ++c)
        for (; e < group.column_first[c + 1]; ++e)
          group.by_column[at(group.column_row.size(), e)] =
              float(H(group.column_row[e], c));
      e = 0;
      for (unsigned int r = 0; r < group.rows; ++r)
        for (; e < group.row_first[r + 1]; ++e)
          group.by_row[at(group.row_column.size(), e)] =
              float(H(r, group.row_column[e]));
    }
  }

  template <int dim>
  void LaneSystem<dim>::set_faces(const Dynamics<dim> &dynamics,
                                  FaceGroup &group)
  {
    const unsigned int n = group.n(), packed = group.packed();
    const double root = std::sqrt(unit_);
    auto &blocks = face_blocks_[std::size_t(&group - face_groups_.data())];
    blocks.assign(group.n_batches * packed * width, 0.);
    group.frame.assign(group.n_batches * group.count * dim * dim * width, 0.f);
    group.inverse.assign(group.n_batches * packed * width, 0.f);
    for (Floats *v : {&group.D, &group.weight, &group.ratio})
      v->assign(group.n_batches * n * width, 0.f);
    group.idle.assign(group.n_batches * n * width, 1.f);
    group.jacobian.assign(group.frame.size(), 0.f);
    for (std::size_t l = 0; l < group.faces.size(); ++l) {
      const std::size_t batch = l / width, lane = l % width;
      const unsigned int f = group.faces[l];
      if (f == none)
        continue;
      const std::size_t first = points_.faces[f].first;
      const double *W = dynamics.face_block(f), *s = &scale_[first * dim];
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          blocks[(batch * packed + i * (i + 1) / 2 + j) * width + lane] =
              W[i * n + j] / (s[i] * s[j]);
      for (unsigned int q = 0; q < group.count; ++q)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int c = 0; c < dim; ++c)
            group.frame[(((batch * group.count + q) * dim + k) * dim + c) *
                            width +
                        lane] =
                float(points_.frame[((first + q) * dim + k) * dim + c] * root /
                      s[q * dim + k]);
    }
  }

  template <int dim>
  void LaneSystem<dim>::prepare(const std::vector<double> &D)
  {
    const Charge charge(Cost::preconditioner);
    for (auto &group : face_groups_) {
      const unsigned int n = group.n(), packed = group.packed();
      const auto &blocks =
          face_blocks_[std::size_t(&group - face_groups_.data())];
      part_.assign(group.D.size(), 0.);
      diagonal_.assign(group.D.size(), 0.);
      for_components(group, [&](const std::size_t k, const std::size_t at) {
        if (!(D[k] >= 0.))
          return;
        part_[at] = 1.;
        // beyond that nothing moves
        diagonal_[at] = std::min(D[k] / (scale_[k] * scale_[k]), 1e15);
      });
      for (std::size_t k = 0; k < group.D.size(); ++k)
        group.D[k] = float(diagonal_[k]);
      work_.resize(std::size_t(packed) * 16);
      for (std::size_t b = 0; b < group.n_batches; ++b)
        lane::invert(n, &blocks[b * packed * width], &diagonal_[b * n * width],
                     &part_[b * n * width], work_.data(),
                     &group.inverse[b * packed * width]);
    }
  }

  template <int dim>
  void LaneSystem<dim>::apply(const Floats &p)
  {
    ++applications_;
    for (const auto &group : face_groups_)
      lane::scatter(group, p.data(), X_.data());
    for (const auto &extra : extras_)
      for (unsigned int c = 0; c < dim; ++c)
        X_[extra.slot + c * width] += X_[extra.place + c * width];
    for (const auto &group : body_groups_)
      lane::multiply_bodies(group, 0, group.n_shared, X_.data(), Y_.data());
    const auto copy_extras = [this]() {
      for (const auto &extra : extras_)
        for (unsigned int c = 0; c < dim; ++c)
          Y_[extra.place + c * width] = Y_[extra.slot + c * width];
    };
    copy_extras();
    start_exchange();
    for (const auto &group : body_groups_)
      lane::multiply_bodies(group, group.n_shared, group.n_batches, X_.data(),
                            Y_.data());
    copy_extras();
    finish_exchange();
  }

  template <int dim>
  void LaneSystem<dim>::start_exchange()
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
              Y_[place_[neighbor.side[j]][neighbor.points[j]] + c * width]);
    }
    messages_.start(communicator_.mpi(), 8);
  }

  template <int dim>
  void LaneSystem<dim>::finish_exchange()
  {
    messages_.finish();
    for (std::size_t k = 0; k < points_.neighbors.size(); ++k) {
      const auto &neighbor = points_.neighbors[k];
      for (std::size_t j = 0; j < neighbor.points.size(); ++j)
        for (unsigned int c = 0; c < dim; ++c)
          Y_[place_[1 - neighbor.side[j]][neighbor.points[j]] + c * width] =
              messages_.messages[k].in[j * dim + c];
    }
  }

  /** The first product, whose size nothing tells. */
  template <int dim>
  double LaneSystem<dim>::product(const Floats &a, const Floats &b)
  {
    std::size_t n = 0;
    for (const auto &group : face_groups_)
      n += group.faces.size();
    terms_.resize(n);
    n = 0;
    for (const auto &group : face_groups_) {
      lane::face_products(group, a.data(), b.data(), terms_.data() + n);
      n += group.faces.size();
    }
    return communicator_.sum(terms_);
  }

  template <int dim>
  void LaneSystem<dim>::reduce(ExactSum *sums, const unsigned int count) const
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
  unsigned int
  LaneSystem<dim>::conjugate_gradients(const InnerSystem &system,
                                       const std::vector<double> &r,
                                       std::vector<double> &x)
  {
    prepare(system.D);
    const Charge charge(Cost::solver);
    // units of the largest entry: what is left stays in the range of floats
    double largest = 0.;
    for (std::size_t k = 0; k < r.size(); ++k)
      largest = std::max(largest, std::abs(r[k]) / scale_[k]);
    largest = communicator_.max(largest);
    std::fill(x.begin(), x.end(), 0.);
    if (!(largest > 0.) || !std::isfinite(largest))
      return 0;
    for (const auto &group : face_groups_)
      for_components(group, [&](const std::size_t k, const std::size_t at) {
        r_[group.first + at] = float(r[k] / (scale_[k] * largest));
      });
    for (Floats *v : {&x_, &p_, &w_})
      set_zero(*v);
    {
      ExactSum unused(1.);
      for (const auto &group : face_groups_)
        lane::advance(group, 0.f, p_.data(), w_.data(), x_.data(), r_.data(),
                      z_.data(), unused);
    }
    double rz = product(r_, z_);
    const double target = system.tolerance * system.tolerance * rz;
    p_ = z_;
    unsigned int k = 0;
    for (; k < system.limit && rz > target; ++k) {
      ExactSum pw(rz), next(rz);
      {
        const Charge product(Cost::delassus_single);
        apply(p_);
        for (const auto &group : face_groups_)
          lane::gather(group, Y_.data(), p_.data(), w_.data(), pw);
      }
      reduce(&pw, 1);
      if (!(pw.value > 0.))
        break;
      const double alpha = rz / pw.value;
      for (const auto &group : face_groups_)
        lane::advance(group, float(alpha), p_.data(), w_.data(), x_.data(),
                      r_.data(), z_.data(), next);
      reduce(&next, 1);
      const double beta = next.value / rz;
      rz = next.value;
      lane::combine(size_, float(beta), z_.data(), p_.data());
    }
    for (const auto &group : face_groups_)
      for_components(group, [&](const std::size_t j, const std::size_t at) {
        x[j] = largest * double(x_[group.first + at]) / scale_[j];
      });
    return k;
  }

  template <int dim>
  void LaneSystem<dim>::prepare_coupled(const InnerSystem &system)
  {
    const auto &J = *system.jacobian, &R = *system.majorant, &D = system.D;
    for (auto &group : face_groups_)
      for_components(group, [&](const std::size_t k, const std::size_t at) {
        const double square = scale_[k] * scale_[k];
        const bool part = D[k] >= 0.;
        group.weight[at] =
            part ? float(std::min((D[k] + R[k]) / square, 1e15)) : 0.f;
        group.idle[at] = part ? 0.f : 1.f;
        group.ratio[at] = float((1. - system.shift) * R[k] / square);
        // `at` counts rows of one lane; the blocks have dim entries in each
        const std::size_t row = at / width * dim * width + at % width,
                          first = k - k % dim;
        for (unsigned int c = 0; c < dim; ++c)
          group.jacobian[row + c * width] =
              float(scale_[k] * J[k * dim + c] * scale_[first + c]);
      });
  }

  /**
   * Makes vector k + 1 of the basis orthogonal to those before it, in h their
   * products; returns its norm, of which @p scale holds the size before and
   * after. Twice where most of it goes: the first time leaves rounding errors.
   */
  template <int dim>
  double LaneSystem<dim>::orthogonalise(const unsigned int k, double &scale,
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
      for (const auto &group : face_groups_)
        lane::dots(group, V.data(), k + 2, w, sums.data());
      reduce(sums.data(), k + 2);
      before = std::sqrt(std::max(0., sums[k + 1].value));
      if (round == 0)
        scale = before * before;
      for (unsigned int j = 0; j <= k; ++j) {
        share[j] = float(sums[j].value);
        h[j] += double(share[j]);
      }
      lane::subtract(size_, V.data(), share.data(), k + 1, w);
      ExactSum norm(before * before);
      const float *self = w;
      for (const auto &group : face_groups_)
        lane::dots(group, &self, 1, w, &norm);
      reduce(&norm, 1);
      after = std::sqrt(std::max(0., norm.value));
      if (!(after < 0.1 * before))
        break;
    }
    return after;
  }

  template <int dim>
  unsigned int LaneSystem<dim>::gmres(const InnerSystem &system,
                                      const std::vector<double> &r,
                                      std::vector<double> &x)
  {
    prepare(system.D);
    const Charge charge(Cost::solver);
    prepare_coupled(system);
    std::fill(x.begin(), x.end(), 0.);
    double largest = 0.;
    for (std::size_t k = 0; k < r.size(); ++k)
      largest = std::max(largest, std::abs(r[k]) * scale_[k]);
    largest = communicator_.max(largest);
    if (!(largest > 0.) || !std::isfinite(largest))
      return 0;
    if (basis_.empty())
      basis_.emplace_back(size_, 0.f);
    for (const auto &group : face_groups_)
      for_components(group, [&](const std::size_t k, const std::size_t at) {
        basis_[0][group.first + at] = float(r[k] * scale_[k] / largest);
      });
    const double beta = std::sqrt(product(basis_[0], basis_[0]));
    for (float &value : basis_[0])
      value /= float(beta);

    std::vector<std::vector<double>> H;
    std::vector<double> g{beta}, cosines, sines;
    unsigned int k = 0;
    double scale = 0.;
    for (; k < system.limit && std::abs(g[k]) > system.tolerance * beta; ++k) {
      if (basis_.size() < k + 2)
        basis_.emplace_back(size_, 0.f);
      for (const auto &group : face_groups_)
        lane::precondition(group, basis_[k].data(), z_.data());
      {
        const Charge product(Cost::delassus_single);
        apply(z_);
        for (const auto &group : face_groups_)
          lane::gather_coupled(group, Y_.data(), z_.data(),
                               basis_[k + 1].data());
      }
      if (k == 0)
        scale = product(basis_[1], basis_[1]);
      H.emplace_back(k + 2);
      const double norm = orthogonalise(k, scale, H[k].data());
      H[k][k + 1] = norm;
      if (norm > 0.)
        for (float &value : basis_[k + 1])
          value *= float(1. / norm);
      for (unsigned int j = 0; j < k; ++j) {
        const double a = H[k][j], b = H[k][j + 1];
        H[k][j] = cosines[j] * a + sines[j] * b;
        H[k][j + 1] = -sines[j] * a + cosines[j] * b;
      }
      const double length = std::hypot(H[k][k], norm);
      if (!(length > 0.))
        break;
      cosines.push_back(H[k][k] / length);
      sines.push_back(norm / length);
      H[k][k] = length;
      g.push_back(-sines[k] * g[k]);
      g[k] *= cosines[k];
      if (norm == 0.) {
        ++k;
        break;
      }
    }
    std::vector<float> y(k);
    for (unsigned int i = k; i-- > 0;) {
      double value = g[i];
      for (unsigned int j = i + 1; j < k; ++j)
        value -= H[j][i] * y[j];
      y[i] = float(value / H[i][i]);
    }
    std::vector<const float *> V(k);
    for (unsigned int j = 0; j < k; ++j) {
      V[j] = basis_[j].data();
      y[j] = -y[j];
    }
    set_zero(r_);
    lane::subtract(size_, V.data(), y.data(), k, r_.data());
    for (const auto &group : face_groups_)
      lane::precondition(group, r_.data(), z_.data());
    for (const auto &group : face_groups_)
      for_components(group, [&](const std::size_t j, const std::size_t at) {
        x[j] = largest * double(z_[group.first + at]) / scale_[j];
      });
    return k;
  }

  template class LaneSystem<2>;
  template class LaneSystem<3>;
} // namespace nsfd
