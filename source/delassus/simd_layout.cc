#include "simd_layout.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd
{
  using simd::FaceGroup;
  using simd::width;

  namespace
  {
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

    void set_pattern(const Block &trace, simd::BodyGroup &group)
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
  SimdLayout<dim>::SimdLayout(const Bodies &bodies,
                              const InterfacePoints<dim> &points)
      : bodies_(bodies), points_(points)
  {
    group_bodies();
    group_faces();
    place_points();
  }

  /** Large classes by themselves, others by the pattern of their traces. */
  template <int dim>
  void SimdLayout<dim>::group_bodies()
  {
    std::map<std::vector<unsigned int>, std::vector<unsigned int>> mixed;
    std::vector<unsigned int> leaders;
    for (const BodyClass &body : bodies_.classes) {
      if (body.bodies.empty() || body.n_slots == 0)
        continue;
      if (body.bodies.size() >= width / 2) {
        set_pattern(body.trace, body_groups.emplace_back());
        body_groups.back().shared = true;
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
                  body_groups.emplace_back());
      members_.push_back(members);
    }
    const std::vector<char> shared = shared_bodies(bodies_, points_);
    for (std::size_t g = 0; g < body_groups.size(); ++g) {
      auto &group = body_groups[g];
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
  void SimdLayout<dim>::group_faces()
  {
    std::map<unsigned int, std::vector<unsigned int>> by_count;
    for (std::size_t f = 0; f < points_.faces.size(); ++f)
      by_count[points_.faces[f].count].push_back(static_cast<unsigned int>(f));
    for (auto &[count, faces] : by_count) {
      FaceGroup &group = face_groups.emplace_back();
      group.dim = dim;
      group.count = count;
      group.n_batches = (faces.size() + width - 1) / width;
      group.first = size;
      faces.resize(group.n_batches * width, none);
      group.faces = std::move(faces);
      size += group.n_batches * group.n() * width;
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
  void SimdLayout<dim>::place_points()
  {
    const int nowhere = int(n_slots_);
    std::size_t end = n_slots_ + dim * width;
    for (auto &side : place)
      side.assign(points_.n_points, nowhere);
    std::vector<std::size_t> first_row(bodies_.size());
    for (std::size_t g = 0; g < body_groups.size(); ++g)
      for (std::size_t m = 0; m < members_[g].size(); ++m) {
        const unsigned int b = members_[g][m];
        first_row[b] = body_groups[g].first +
                       m / width * body_groups[g].rows * width + m % width;
        for (std::size_t s = bodies_.first_slot[b];
             s < bodies_.first_slot[b + 1]; ++s)
          if (bodies_.slot_point[s] < points_.n_points)
            place[bodies_.slot_sign[s] > 0][bodies_.slot_point[s]] =
                int(first_row[b] + (s - bodies_.first_slot[b]) * dim * width);
      }
    for (const auto &[slot, point] : bodies_.extra_points) {
      const std::size_t b = std::upper_bound(bodies_.first_slot.begin(),
                                             bodies_.first_slot.end(), slot) -
                            bodies_.first_slot.begin() - 1;
      extras.push_back(
          {int(first_row[b] + (slot - bodies_.first_slot[b]) * dim * width),
           int(end)});
      place[1][point] = int(end);
      end += dim * width;
    }
    for (const auto &neighbor : points_.neighbors)
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        place[1 - neighbor.side[j]][neighbor.points[j]] = int(end);
        end += dim * width;
      }
    n_places = end;
    for (auto &group : face_groups) {
      group.place.assign(group.n_batches * group.count * 2 * width, nowhere);
      for (std::size_t l = 0; l < group.faces.size(); ++l)
        if (group.faces[l] != none)
          for (unsigned int q = 0; q < group.count; ++q)
            for (unsigned int s = 0; s < 2; ++s)
              group.place[((l / width * group.count + q) * 2 + s) * width +
                          l % width] =
                  place[s][points_.faces[group.faces[l]].first + q];
    }
  }

  template <int dim>
  void SimdLayout<dim>::set_values(const DelassusOperator<dim> &delassus)
  {
    // by the root of the diagonal of W
    scale.assign(points_.n_points * dim, 1.);
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      const unsigned int n = points_.faces[f].count * dim;
      const double *W = delassus.face_block(f);
      for (unsigned int k = 0; k < n; ++k)
        if (W[k * n + k] > 0.)
          scale[std::size_t(points_.faces[f].first) * dim + k] =
              std::sqrt(W[k * n + k]);
    }
    unit = 0.;
    for (const double s : scale)
      unit = std::max(unit, s * s);
    unit = std::ldexp(1., std::ilogb(delassus.communicator().max(unit)));
    for (std::size_t g = 0; g < body_groups.size(); ++g)
      set_bodies(delassus, body_groups[g], members_[g]);
    face_blocks.resize(face_groups.size());
    for (auto &group : face_groups)
      set_faces(delassus, group);
  }

  /** The blocks in units in which those of the traces are of order one. */
  template <int dim>
  void SimdLayout<dim>::set_bodies(const DelassusOperator<dim> &delassus,
                                   simd::BodyGroup &group,
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
      const auto &blocks = delassus.class_blocks()[k];
      const Block &A = group.dense ? blocks.delassus : blocks.inverse,
                  &H = bodies_.classes[k].trace;
      const auto at = [&](const std::size_t entries, const std::size_t e) {
        return (m / width * entries + e) * step + m % width;
      };
      for (unsigned int c = 0; c < order; ++c)
        for (unsigned int r = 0; r < order; ++r)
          group.matrix[at(std::size_t(order) * order, c * order + r)] =
              float(A(r, c) / unit);
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
  void SimdLayout<dim>::set_faces(const DelassusOperator<dim> &delassus,
                                  FaceGroup &group)
  {
    const unsigned int n = group.n(), packed = group.packed();
    const double root = std::sqrt(unit);
    auto &blocks = face_blocks[std::size_t(&group - face_groups.data())];
    blocks.assign(group.n_batches * packed * width, 0.);
    group.frame.assign(group.n_batches * group.count * dim * dim * width, 0.f);
    group.inverse.assign(group.n_batches * packed * width, 0.f);
    for (std::vector<float> *v : {&group.D, &group.weight, &group.ratio})
      v->assign(group.n_batches * n * width, 0.f);
    group.idle.assign(group.n_batches * n * width, 1.f);
    group.jacobian.assign(group.frame.size(), 0.f);
    for (std::size_t l = 0; l < group.faces.size(); ++l) {
      const std::size_t batch = l / width, lane = l % width;
      const unsigned int f = group.faces[l];
      if (f == none)
        continue;
      const std::size_t first = points_.faces[f].first;
      const double *W = delassus.face_block(f), *s = &scale[first * dim];
      for (unsigned int i = 0; i < n; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          blocks[(batch * packed + i * (i + 1) / 2 + j) * width + lane] =
              W[i * n + j] / (s[i] * s[j]);
      for (unsigned int q = 0; q < group.count; ++q)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int c = 0; c < dim; ++c)
            group.frame[(((batch * group.count + q) * dim + k) * dim + c) *
                            width +
                        lane] = float(points_.axes(first + q)[k * dim + c] *
                                      root / s[q * dim + k]);
    }
  }

  template class SimdLayout<2>;
  template class SimdLayout<3>;
} // namespace nsfd
