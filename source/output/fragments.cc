#include "nsfd/output/fragments.h"

#include "cell_sampler.h"
#include "gather.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace nsfd
{
  using namespace dealii;

  template <int dim>
  bool carries(const State &state,
               const typename InterfacePoints<dim>::Face &face)
  {
    for (unsigned int i = face.first; i < face.first + face.count; ++i)
      switch (state.kind[i]) {
      case PointKind::prescribed:
      case PointKind::rigid:
      case PointKind::elastic:
      case PointKind::bonded:
        return true;
      case PointKind::cohesive:
        if (state.beta[i] >= 1e-3)
          return true;
        break;
      case PointKind::free:
        break;
      }
    return false;
  }

  template <int dim>
  Fragments<dim>::Fragments(const Discretization<dim> &discretization,
                            const Communicator &communicator)
      : discretization_(discretization), communicator_(communicator)
  {
    struct Cell {
      unsigned long long number;
      std::array<double, 3> centre;
    };
    const std::size_t n_bodies = discretization.bodies().size();
    std::vector<Cell> own_cells;
    for (unsigned int b = 0; b < n_bodies; ++b)
      own_cells.push_back({discretization.global_cell(b),
                           in_space<dim>(discretization.centre(b))});
    const auto &points = discretization.points();
    std::vector<std::array<unsigned long long, 2>> own_pairs;
    for (unsigned int f = 0; f < points.faces.size(); ++f)
      if (!points.faces[f].boundary && points.faces[f].first < points.n_owned) {
        faces_.push_back(f);
        own_pairs.push_back(points.faces[f].cells);
      }
    const auto cells = gather(communicator, own_cells, n_cells_);
    const auto pairs = gather(communicator, own_pairs);
    of_body_.assign(n_bodies, 0);

    // only rank 0 has anything from here on
    order_.resize(cells.size());
    std::iota(order_.begin(), order_.end(), 0);
    auto by_number = order_;
    std::sort(order_.begin(), order_.end(), [&](const auto a, const auto b) {
      return std::tie(cells[a].centre, cells[a].number) <
             std::tie(cells[b].centre, cells[b].number);
    });
    std::sort(by_number.begin(), by_number.end(),
              [&](const auto a, const auto b) {
                return cells[a].number < cells[b].number;
              });
    const auto index = [&](const unsigned long long number) {
      const auto found = std::lower_bound(
          by_number.begin(), by_number.end(), number,
          [&](const auto a, const auto n) { return cells[a].number < n; });
      AssertThrow(found != by_number.end() && cells[*found].number == number,
                  ExcMessage("a face of a cell that no rank has"));
      return *found;
    };
    for (const auto &pair : pairs)
      pairs_.push_back({{index(pair[0]), index(pair[1])}});
  }

  template <int dim>
  void Fragments<dim>::update(const State &state)
  {
    if (state.broken_area == broken_area_)
      return;
    broken_area_ = state.broken_area;

    const auto &faces = discretization_.points().faces;
    std::vector<unsigned char> own;
    for (const unsigned int f : faces_)
      own.push_back(carries<dim>(state, faces[f]));
    const auto carrying = gather(communicator_, own);

    // union-find on rank 0
    std::vector<unsigned int> parent(order_.size()), fragment(order_.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto find = [&](unsigned int cell) {
      while (parent[cell] != cell)
        cell = parent[cell] = parent[parent[cell]];
      return cell;
    };
    for (std::size_t f = 0; f < carrying.size(); ++f)
      if (carrying[f]) {
        const unsigned int a = find(pairs_[f][0]), b = find(pairs_[f][1]);
        parent[std::max(a, b)] = std::min(a, b);
      }
    constexpr unsigned int none = std::numeric_limits<unsigned int>::max();
    std::vector<unsigned int> number(order_.size(), none);
    count_ = 0;
    for (const unsigned int cell : order_) {
      unsigned int &n = number[find(cell)];
      if (n == none)
        n = count_++;
      fragment[cell] = n;
    }

    std::vector<int> first(n_cells_.size(), 0);
    std::partial_sum(n_cells_.begin(), n_cells_.end() - 1, first.begin() + 1);
    MPI_Scatterv(fragment.data(), n_cells_.data(), first.data(), MPI_UNSIGNED,
                 of_body_.data(), int(of_body_.size()), MPI_UNSIGNED, 0,
                 communicator_.mpi());
    MPI_Bcast(&count_, 1, MPI_UNSIGNED, 0, communicator_.mpi());
  }

  template bool carries<2>(const State &,
                           const typename InterfacePoints<2>::Face &);
  template bool carries<3>(const State &,
                           const typename InterfacePoints<3>::Face &);
  template class Fragments<2>;
  template class Fragments<3>;
} // namespace nsfd
