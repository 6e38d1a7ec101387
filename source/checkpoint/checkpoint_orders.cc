#include "checkpoint_archive.h"

#include "core/gather.h"
#include "core/mix_bits.h"
#include "discretization/cells.h"
#include "discretization/material_histories.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nsfd
{
  template <int dim>
  CheckpointOrders<dim>::CheckpointOrders(
      const Discretization<dim> &discretization,
      const Communicator &communicator)
      : discretization_(discretization), communicator_(communicator)
  {
    const auto &points = discretization.points();
    unknowns_ = order_of_cells(discretization.bodies().first_dof);
    histories_ = order_of_cells(first_histories(discretization));
    std::vector<std::size_t> one_by_one(discretization.bodies().size() + 1);
    std::iota(one_by_one.begin(), one_by_one.end(), std::size_t(0));
    single_cells_ = order_of_cells(one_by_one);
    std::vector<RankOrder::Key> keys;
    for (const auto &face : points.faces)
      for (unsigned int k = 0; k < face.count; ++k)
        keys.push_back({{face.key, k, 0}});
    points_ = std::make_unique<RankOrder>(communicator, keys, points.n_owned);
    set_fingerprint();
  }

  /** Of the items first[c] to first[c + 1] of the cells c. */
  template <int dim>
  std::unique_ptr<RankOrder> CheckpointOrders<dim>::order_of_cells(
      const std::vector<std::size_t> &first) const
  {
    std::vector<RankOrder::Key> keys;
    keys.reserve(first.back());
    for (unsigned int c = 0; c + 1 < first.size(); ++c) {
      const auto &id = discretization_.cells().cell_id[c];
      const auto word = [&](const unsigned int k) {
        return (std::uint64_t(id[k]) << 32) | id[k + 1];
      };
      for (std::size_t i = first[c]; i < first[c + 1]; ++i)
        keys.push_back({{word(0), word(2), i - first[c]}});
    }
    return std::make_unique<RankOrder>(communicator_, keys, keys.size());
  }

  template <int dim>
  std::vector<std::uint32_t> CheckpointOrders<dim>::cells() const
  {
    std::vector<std::array<unsigned int, 4>> own;
    for (std::size_t b = 0; b < discretization_.bodies().size(); ++b)
      own.push_back(discretization_.cells().cell_id[unsigned(b)]);
    auto all = gather(communicator_, own);
    std::sort(all.begin(), all.end());
    std::vector<std::uint32_t> flat;
    for (const auto &id : all)
      flat.insert(flat.end(), id.begin(), id.end());
    return flat;
  }

  template <int dim>
  std::vector<std::uint64_t> CheckpointOrders<dim>::faces() const
  {
    const auto &points = discretization_.points();
    std::vector<std::array<std::uint64_t, 2>> own;
    for (const auto &face : points.faces)
      if (face.first < points.n_owned)
        own.push_back({{face.key, face.count}});
    auto all = gather(communicator_, own);
    std::sort(all.begin(), all.end());
    std::vector<std::uint64_t> flat;
    for (const auto &face : all)
      flat.insert(flat.end(), face.begin(), face.end());
    return flat;
  }

  template <int dim>
  void CheckpointOrders<dim>::set_fingerprint()
  {
    const auto &points = discretization_.points();
    const double unit = std::ldexp(discretization_.extent(), -26);
    std::uint64_t hash = 0;
    const auto add = [&](const std::uint64_t value) {
      hash = mixed(hash ^ value);
    };
    const auto add_place = [&](const double x) {
      add(std::uint64_t(std::llround(x / unit)));
    };
    std::uint64_t sums[2] = {0, 0};
    for (std::size_t b = 0; b < discretization_.bodies().size(); ++b) {
      hash = 0;
      for (const unsigned int part :
           discretization_.cells().cell_id[unsigned(b)])
        add(part);
      add(discretization_.cells().body_class(unsigned(b)).material);
      for (const auto &corner : discretization_.cells().corners[unsigned(b)])
        for (unsigned int c = 0; c < dim; ++c)
          add_place(corner[c]);
      sums[0] += hash;
    }
    for (std::size_t i = 0; i < points.n_owned; ++i) {
      const auto &face = points.faces[points.face_of[i]];
      const PointOrigin origin = discretization_.origins()[i];
      hash = face.key;
      add(i - face.first);
      add(std::uint64_t(origin.kind));
      add(origin.block);
      for (unsigned int c = 0; c < dim; ++c)
        add_place(points.position[i * dim + c]);
      sums[1] += hash;
    }
    for (const std::uint64_t sum : sums)
      fingerprint_.push_back(communicator_.sum_integer(sum));
  }

  template class CheckpointOrders<2>;
  template class CheckpointOrders<3>;
} // namespace nsfd
