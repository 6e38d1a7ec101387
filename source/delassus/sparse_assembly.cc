#include "sparse_assembly.h"

#include "discretization/point_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  SparseAssembly<dim>::SparseAssembly(const Communicator &communicator,
                                      const Bodies &bodies,
                                      const InterfacePoints<dim> &points,
                                      const std::vector<double> &coordinates)
      : communicator_(communicator), bodies_(bodies), points_(points),
        coordinates_(coordinates)
  {
    const long long mine = static_cast<long long>(bodies.n_dofs());
    long long sum = 0;
    MPI_Scan(&mine, &sum, 1, MPI_LONG_LONG, MPI_SUM, communicator.mpi());
    matrix_.first_row = sum - mine;
    find_places();
    if (communicator.size() > 1)
      exchange_remote();
  }

  template <int dim>
  void SparseAssembly<dim>::find_places()
  {
    places_.fill(std::vector<Place>(points_.n_points));
    for_all_places(bodies_, points_.n_points,
                   [&](const std::size_t body, const unsigned int slot,
                       const std::size_t point, const unsigned int side) {
                     places_[side][point] = {int(body), -1, slot};
                   });
  }

  template <int dim>
  void SparseAssembly<dim>::exchange_remote()
  {
    double largest = 0.;
    for (const auto &body : bodies_.classes)
      largest = std::max(largest, double(body.n_dofs));
    const std::size_t width = std::size_t(communicator_.max(largest)),
                      stride = 3 + (dim + 1) * width;
    NeighborMessages<double> exchange;
    for (const auto &neighbor : points_.neighbors) {
      auto &message = exchange.messages.emplace_back();
      message.rank = neighbor.rank;
      message.in.resize(neighbor.points.size() * stride);
      message.out.assign(message.in.size(), 0.);
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        const Place &place = places_[neighbor.side[j]][neighbor.points[j]];
        const BodyClass &body = bodies_.classes[bodies_.class_of[place.body]];
        double *to = message.out.data() + j * stride;
        to[0] =
            double(matrix_.first_row) + double(bodies_.first_dof[place.body]);
        to[1] = body.n_dofs;
        to[2] = body.rigid;
        for (unsigned int i = 0; i < body.n_dofs; ++i) {
          for (unsigned int c = 0; c < dim; ++c)
            to[3 + c * width + i] = trace(place, c, i);
          to[3 + dim * width + i] = coordinate(place, i);
        }
      }
    }
    exchange.start(communicator_.mpi(), 23);
    exchange.finish();
    for (std::size_t k = 0; k < points_.neighbors.size(); ++k) {
      const auto &neighbor = points_.neighbors[k];
      for (std::size_t j = 0; j < neighbor.points.size(); ++j) {
        const double *from = exchange.messages[k].in.data() + j * stride;
        Remote remote;
        remote.first = static_cast<long long>(from[0]);
        remote.rigid = from[2] != 0.;
        const std::size_t m = std::size_t(from[1]);
        for (unsigned int c = 0; c < dim; ++c)
          remote.trace.insert(remote.trace.end(), from + 3 + c * width,
                              from + 3 + c * width + m);
        remote.coordinates.assign(from + 3 + dim * width,
                                  from + 3 + dim * width + m);
        Place &place = places_[1 - neighbor.side[j]][neighbor.points[j]];
        place.remote = int(remote_.size());
        remote_.push_back(std::move(remote));
      }
    }
  }

  template <int dim>
  double SparseAssembly<dim>::trace(const Place &place, const unsigned int c,
                                    const unsigned int j) const
  {
    if (place.body >= 0)
      return bodies_.classes[bodies_.class_of[place.body]].trace(
          place.slot * dim + c, j);
    const auto &trace = remote_[place.remote].trace;
    return trace[c * (trace.size() / dim) + j];
  }

  template <int dim>
  double SparseAssembly<dim>::coordinate(const Place &place,
                                         const unsigned int j) const
  {
    if (place.remote >= 0)
      return remote_[place.remote].coordinates[j];
    return coordinates_.empty()
               ? 0.
               : coordinates_[bodies_.first_dof[place.body] + j];
  }

  template <int dim>
  typename SparseAssembly<dim>::Side
  SparseAssembly<dim>::side(const std::size_t face, const unsigned int s) const
  {
    Side side;
    const auto &f = points_.faces[face];
    const Place &first = places_[s][f.first];
    unsigned int n;
    if (first.body >= 0) {
      const BodyClass &body = bodies_.classes[bodies_.class_of[first.body]];
      side.first = matrix_.first_row +
                   static_cast<long long>(bodies_.first_dof[first.body]);
      side.rigid = body.rigid;
      n = body.n_dofs;
    } else {
      const Remote &remote = remote_[first.remote];
      side.first = remote.first;
      side.rigid = remote.rigid;
      n = unsigned(remote.trace.size() / dim);
    }
    if (side.rigid) {
      for (unsigned int j = 0; j < n; ++j)
        side.support.push_back(static_cast<unsigned short>(j));
      return side;
    }
    // nodal functions are of order one somewhere on the face or vanish on it;
    // by the last component, which moves on the axis of a scene, too
    constexpr unsigned int last = dim - 1;
    for (unsigned int j = 0; j < n; j += dim) {
      double largest = 0.;
      for (unsigned int p = f.first; p < f.first + f.count; ++p)
        largest =
            std::max(largest, std::abs(trace(places_[s][p], last, j + last)));
      if (largest > 1e-10)
        for (unsigned int c = 0; c < dim; ++c)
          side.support.push_back(static_cast<unsigned short>(j + c));
    }
    return side;
  }

  template <int dim>
  void SparseAssembly<dim>::build_pattern()
  {
    const std::size_t n = bodies_.n_dofs();
    const long long first = matrix_.first_row,
                    end = first + static_cast<long long>(n);
    // columns across the faces, row by row: count, then fill
    std::vector<int> count(n + 1, 0);
    std::vector<long long> across;
    for (const bool fill : {false, true}) {
      for (std::size_t f = 0; f < points_.faces.size(); ++f) {
        const unsigned int p = points_.faces[f].first;
        if (!places_[0][p].exists() || !places_[1][p].exists())
          continue;
        const std::array<Side, 2> sides{side(f, 0), side(f, 1)};
        for (unsigned int s = 0; s < 2; ++s) {
          if (places_[s][p].body < 0)
            continue;
          const Side &rows = sides[s], &columns = sides[1 - s];
          for (const unsigned short i : rows.support) {
            const std::size_t row = std::size_t(rows.first - first) + i;
            if (!fill)
              count[row + 1] += int(columns.support.size());
            else
              for (const unsigned short j : columns.support)
                across[count[row]++] = columns.first + j;
          }
        }
      }
      if (fill)
        break;
      for (std::size_t i = 0; i < n; ++i)
        count[i + 1] += count[i];
      across.resize(count[n]);
    }
    // after filling, count[i] is where row i + 1 starts
    for (const long long column : across)
      if (column < first || column >= end)
        matrix_.ghosts.push_back(column);
    std::sort(matrix_.ghosts.begin(), matrix_.ghosts.end());
    matrix_.ghosts.erase(
        std::unique(matrix_.ghosts.begin(), matrix_.ghosts.end()),
        matrix_.ghosts.end());
    matrix_.start.assign(n + 1, 0);
    std::size_t own_blocks = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const std::size_t m = bodies_.first_dof[b + 1] - bodies_.first_dof[b];
      own_blocks += m * m;
    }
    matrix_.column.reserve(across.size() + own_blocks);
    std::vector<int> row;
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t i = bodies_.first_dof[b]; i < bodies_.first_dof[b + 1];
           ++i) {
        row.clear();
        for (std::size_t j = bodies_.first_dof[b]; j < bodies_.first_dof[b + 1];
             ++j)
          row.push_back(int(j));
        for (int k = i == 0 ? 0 : count[i - 1]; k < count[i]; ++k)
          row.push_back(local_column(across[k]));
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
        matrix_.column.insert(matrix_.column.end(), row.begin(), row.end());
        matrix_.start[i + 1] = int(matrix_.column.size());
      }
    matrix_.column.shrink_to_fit();
    matrix_.value.assign(matrix_.column.size(), 0.);
  }

  template <int dim>
  int SparseAssembly<dim>::local_column(const long long global) const
  {
    const long long n = static_cast<long long>(bodies_.n_dofs());
    if (global >= matrix_.first_row && global < matrix_.first_row + n)
      return int(global - matrix_.first_row);
    return int(n + (std::lower_bound(matrix_.ghosts.begin(),
                                     matrix_.ghosts.end(), global) -
                    matrix_.ghosts.begin()));
  }

  template <int dim>
  void SparseAssembly<dim>::add(const int row, const long long column,
                                const double *values, const unsigned int n)
  {
    const auto begin = matrix_.column.begin() + matrix_.start[row],
               end = matrix_.column.begin() + matrix_.start[row + 1];
    const auto at = std::lower_bound(begin, end, local_column(column));
    double *to = matrix_.value.data() + (at - matrix_.column.begin());
    for (unsigned int k = 0; k < n; ++k)
      to[k] += values[k];
  }

  template <int dim>
  void SparseAssembly<dim>::assemble(const StepShares &s,
                                     const std::vector<double> &k,
                                     const std::vector<char> &left_out)
  {
    if (matrix_.start.empty())
      build_pattern(); // where nodes alone are asked for, it is not needed
    std::fill(matrix_.value.begin(), matrix_.value.end(), 0.);
    std::vector<double> row;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const BodyClass &body = bodies_.classes[bodies_.class_of[b]];
      const unsigned int n = body.n_dofs;
      row.resize(n);
      for (unsigned int i = 0; i < n; ++i) {
        for (unsigned int j = 0; j < n; ++j)
          row[j] = step_entry(body, s, i, j);
        add(int(bodies_.first_dof[b] + i),
            matrix_.first_row + static_cast<long long>(bodies_.first_dof[b]),
            row.data(), n);
      }
    }
    for (std::size_t f = 0; f < points_.faces.size(); ++f)
      if (left_out.empty() || !left_out[f])
        add_springs(f, k);
  }

  template <int dim>
  void SparseAssembly<dim>::add_springs(const std::vector<double> &k,
                                        const std::vector<char> &faces)
  {
    for (std::size_t f = 0; f < points_.faces.size(); ++f)
      if (faces[f])
        add_springs(f, k);
  }

  template <int dim>
  void SparseAssembly<dim>::add_springs(const std::size_t face,
                                        const std::vector<double> &k)
  {
    const auto &f = points_.faces[face];
    bool any = false;
    for (std::size_t i = std::size_t(f.first) * dim;
         i < std::size_t(f.first + f.count) * dim; ++i)
      any = any || k[i] != 0.;
    if (!any)
      return;
    std::array<Side, 2> sides;
    for (unsigned int s = 0; s < 2; ++s)
      if (places_[s][f.first].exists())
        sides[s] = side(face, s);
    // per side: signed rows of Q T, (point, component) x support
    std::array<std::vector<double>, 2> H;
    const unsigned int n_rows = f.count * dim;
    for (unsigned int s = 0; s < 2; ++s) {
      const std::size_t m = sides[s].support.size();
      H[s].assign(n_rows * m, 0.);
      for (unsigned int p = 0; m > 0 && p < f.count; ++p) {
        const double *Q = points_.axes(f.first + p);
        const Place &place = places_[s][f.first + p];
        for (std::size_t j = 0; j < m; ++j)
          for (unsigned int c = 0; c < dim; ++c) {
            const double value =
                (s == 1 ? 1. : -1.) * trace(place, c, sides[s].support[j]);
            if (value != 0.)
              for (unsigned int r = 0; r < dim; ++r)
                H[s][(p * dim + r) * m + j] += Q[r * dim + c] * value;
          }
      }
    }
    for (unsigned int s = 0; s < 2; ++s) {
      if (places_[s][f.first].body < 0)
        continue;
      const std::size_t n = sides[s].support.size();
      for (unsigned int t = 0; t < 2; ++t) {
        const std::size_t m = sides[t].support.size();
        if (m == 0)
          continue;
        work_.assign(n * m, 0.);
        for (unsigned int r = 0; r < n_rows; ++r) {
          const double stiffness = k[std::size_t(f.first) * dim + r];
          if (stiffness == 0.)
            continue;
          const double *a = &H[s][r * n], *c = &H[t][r * m];
          for (std::size_t i = 0; i < n; ++i) {
            if (a[i] == 0.)
              continue;
            const double scaled = stiffness * a[i];
            double *to = &work_[i * m];
            for (std::size_t j = 0; j < m; ++j)
              to[j] += scaled * c[j];
          }
        }
        const unsigned int step = sides[t].rigid ? unsigned(m) : dim;
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t j = 0; j < m; j += step)
            add(int(sides[s].first - matrix_.first_row) + sides[s].support[i],
                sides[t].first + sides[t].support[j], &work_[i * m + j], step);
      }
    }
  }

  template <int dim>
  std::vector<char>
  SparseAssembly<dim>::carrying(const StepShares &s,
                                const std::vector<double> &k) const
  {
    std::vector<char> result(points_.faces.size(), 0);
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      const auto &face = points_.faces[f];
      if (!places_[0][face.first].exists() || !places_[1][face.first].exists())
        continue;
      for (unsigned int side_number = 0; side_number < 2; ++side_number) {
        const int b = places_[side_number][face.first].body;
        if (b < 0)
          continue;
        const BodyClass &body = bodies_.classes[bodies_.class_of[b]];
        if (body.rigid)
          continue;
        const Side own = side(f, side_number);
        bool carries = true;
        for (std::size_t j = 0; j < own.support.size() && carries; j += dim) {
          double springs[dim] = {}, diagonal = 0.;
          for (unsigned int p = face.first; p < face.first + face.count; ++p) {
            const double N = trace(places_[side_number][p], dim - 1,
                                   own.support[j] + dim - 1);
            for (unsigned int r = 0; r < dim; ++r)
              springs[r] += k[std::size_t(p) * dim + r] * N * N;
          }
          for (unsigned int c = 0; c < dim; ++c) {
            const unsigned int i = own.support[j] + c;
            diagonal = std::max(diagonal, step_entry(body, s, i, i));
          }
          carries = *std::min_element(springs, springs + dim) > diagonal;
        }
        result[f] = result[f] || carries;
      }
    }
    if (communicator_.size() == 1)
      return result;
    // either rank may have the softer body
    NeighborMessages<char> exchange;
    for (const auto &neighbor : points_.neighbors) {
      auto &message = exchange.messages.emplace_back();
      message.rank = neighbor.rank;
      message.in.resize(neighbor.points.size());
      for (const unsigned int p : neighbor.points)
        message.out.push_back(result[points_.face_of[p]]);
    }
    exchange.start(communicator_.mpi(), 24);
    exchange.finish();
    for (std::size_t j = 0; j < points_.neighbors.size(); ++j) {
      const auto &in = exchange.messages[j].in;
      for (std::size_t i = 0; i < in.size(); ++i)
        if (in[i])
          result[points_.face_of[points_.neighbors[j].points[i]]] = 1;
    }
    return result;
  }

  template <int dim>
  std::array<std::vector<double>, 2>
  SparseAssembly<dim>::own_stiffness(const StepShares &s) const
  {
    std::array<std::vector<double>, 2> result;
    result.fill(std::vector<double>(points_.n_points + 1,
                                    std::numeric_limits<double>::infinity()));
    for (std::size_t f = 0; f < points_.faces.size(); ++f) {
      const auto &face = points_.faces[f];
      for (unsigned int t = 0; t < 2; ++t) {
        const int b = places_[t][face.first].body;
        if (b < 0)
          continue;
        const BodyClass &body = bodies_.classes[bodies_.class_of[b]];
        if (body.rigid)
          continue;
        double largest = 0.;
        for (const unsigned short i : side(f, t).support) {
          double sum = 0.;
          for (unsigned int p = face.first; p < face.first + face.count; ++p) {
            const double N = trace(places_[t][p], i % dim, i);
            sum += N * N;
          }
          if (sum > 0.) // it moves
            largest = std::max(largest, step_entry(body, s, i, i) / sum);
        }
        for (unsigned int p = face.first; p < face.first + face.count; ++p)
          result[t][p] = largest;
      }
    }
    return result;
  }

  template class SparseAssembly<2>;
  template class SparseAssembly<3>;
} // namespace nsfd
