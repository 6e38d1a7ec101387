#include "fragments.h"

#include "core/disjoint_sets.h"
#include "core/gather.h"
#include "discretization/cell_sampler.h"
#include "discretization/cells.h"

#include "core/neighbor_messages.h"

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
      case PointKind::separated:
        break;
      }
    return false;
  }

  namespace
  {
    using Number = unsigned long long;
  } // namespace

  template <int dim>
  Fragments<dim>::Fragments(const Discretization<dim> &discretization,
                            const Communicator &communicator)
      : discretization_(discretization), communicator_(communicator)
  {
    const auto &points = discretization.points();
    for (unsigned int f = 0; f < points.faces.size(); ++f) {
      const auto &face = points.faces[f];
      if (face.boundary || face.first >= points.n_owned)
        continue;
      const int a = face.bodies[0], b = face.bodies[1];
      links_.push_back(a >= 0 ? Link{f, unsigned(a), b}
                              : Link{f, unsigned(b), -1});
    }
  }

  template <int dim>
  void Fragments<dim>::update(const State &state)
  {
    if (state.broken_area == broken_area_)
      return;
    broken_area_ = state.broken_area;
    find_pieces(state);
    join_pieces(state);
  }

  /** Connected components of the bodies of this rank. */
  template <int dim>
  void Fragments<dim>::find_pieces(const State &state)
  {
    const std::size_t n = discretization_.bodies().size();
    const auto &faces = discretization_.points().faces;
    DisjointSets bodies(n);
    for (const Link &link : links_)
      if (link.other >= 0 && carries<dim>(state, faces[link.face]))
        bodies.join(link.body, unsigned(link.other));
    for (const InnerFace &face : discretization_.inner_faces())
      bodies.join(face.bodies[0], face.bodies[1]);
    piece_ = bodies.numbers(n_pieces_);
    const Number mine = n_pieces_;
    Number end = 0;
    MPI_Scan(&mine, &end, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM,
             communicator_.mpi());
    first_piece_ = end - mine;
    stands_for_.resize(n_pieces_);
    std::iota(stands_for_.begin(), stands_for_.end(), first_piece_);
  }

  /** Over the faces between ranks. */
  template <int dim>
  void Fragments<dim>::join_pieces(const State &state)
  {
    Number count = communicator_.sum_integer(n_pieces_);
    if (communicator_.size() > 1) {
      const auto &points = discretization_.points();
      NeighborMessages<Number> exchange;
      for (const auto &neighbor : points.neighbors) {
        auto &message = exchange.messages.emplace_back();
        message.rank = neighbor.rank;
        message.in.resize(neighbor.points.size());
        for (std::size_t j = 0; j < neighbor.points.size(); ++j)
          message.out.push_back(
              first_piece_ +
              piece_[points.faces[points.face_of[neighbor.points[j]]]
                         .bodies[neighbor.side[j]]]);
      }
      exchange.start(communicator_.mpi(), 31);
      exchange.finish();
      std::vector<Number> beyond(points.faces.size());
      for (std::size_t k = 0; k < points.neighbors.size(); ++k)
        for (std::size_t j = 0; j < points.neighbors[k].points.size(); ++j)
          beyond[points.face_of[points.neighbors[k].points[j]]] =
              exchange.messages[k].in[j];

      using Pair = std::array<Number, 2>;
      std::vector<Pair> pairs;
      for (const Link &link : links_)
        if (link.other < 0 && carries<dim>(state, points.faces[link.face]))
          pairs.push_back(
              {{first_piece_ + piece_[link.body], beyond[link.face]}});
      std::sort(pairs.begin(), pairs.end());
      pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
      const auto all = gather(communicator_, pairs);
      const auto first_pieces =
          gather(communicator_, std::vector<Number>{first_piece_});

      // only rank 0 has anything in here; pieces in the order of their ranks
      std::vector<Number> met;
      for (const Pair &pair : all)
        met.insert(met.end(), pair.begin(), pair.end());
      std::sort(met.begin(), met.end());
      met.erase(std::unique(met.begin(), met.end()), met.end());
      DisjointSets pieces(met.size());
      const auto place = [&met](const Number piece) {
        return unsigned(std::lower_bound(met.begin(), met.end(), piece) -
                        met.begin());
      };
      for (const Pair &pair : all)
        pieces.join(place(pair[0]), place(pair[1]));
      std::vector<Pair> answers;
      std::vector<int> n_answers(first_pieces.size(), 0);
      Number joined = 0;
      for (unsigned int k = 0; k < met.size(); ++k) {
        answers.push_back({{met[k], met[pieces.first(k)]}});
        joined += pieces.first(k) != k;
        // ranks without a piece begin where the next one does
        ++n_answers[std::upper_bound(first_pieces.begin(), first_pieces.end(),
                                     met[k]) -
                    first_pieces.begin() - 1];
      }
      for (const Pair &answer : scatter(communicator_, answers, n_answers))
        stands_for_[answer[0] - first_piece_] = answer[1];
      MPI_Bcast(&joined, 1, MPI_UNSIGNED_LONG_LONG, 0, communicator_.mpi());
      count -= joined;
    }
    count_ = unsigned(count);
  }

  template <int dim>
  std::vector<unsigned int> Fragments<dim>::number_bodies() const
  {
    struct Piece {
      Number stands_for, cell;
      std::array<double, 3> centre;
      auto key() const { return std::tie(centre, cell); }
    };
    constexpr Number none = std::numeric_limits<Number>::max();
    std::vector<Piece> own(n_pieces_);
    for (unsigned int k = 0; k < n_pieces_; ++k)
      own[k] = {stands_for_[k], none, {}};
    for (unsigned int b = 0; b < piece_.size(); ++b) {
      const Piece body = {stands_for_[piece_[b]],
                          discretization_.cells().global_cell[b],
                          in_space<dim>(discretization_.cells().centre(b))};
      Piece &piece = own[piece_[b]];
      if (piece.cell == none || body.key() < piece.key())
        piece = body;
    }
    std::vector<int> n_per_rank;
    const auto all = gather(communicator_, own, n_per_rank);
    std::vector<unsigned int> order(all.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](const unsigned int a, const unsigned int b) {
                return all[a].key() < all[b].key();
              });
    // the first cell of a fragment comes first: pieces are numbered from 0 on,
    // rank by rank, as they stand in `all`
    std::vector<unsigned int> number_of(all.size(), unsigned(-1)),
        numbers(all.size());
    unsigned int next = 0;
    for (const unsigned int k : order) {
      unsigned int &number = number_of[all[k].stands_for];
      if (number == unsigned(-1))
        number = next++;
      numbers[k] = number;
    }
    const auto mine = scatter(communicator_, numbers, n_per_rank);
    std::vector<unsigned int> result(piece_.size());
    for (std::size_t b = 0; b < piece_.size(); ++b)
      result[b] = mine[piece_[b]];
    return result;
  }

  template bool carries<2>(const State &,
                           const typename InterfacePoints<2>::Face &);
  template bool carries<3>(const State &,
                           const typename InterfacePoints<3>::Face &);
  template class Fragments<2>;
  template class Fragments<3>;
} // namespace nsfd
