#include "connected_cells.h"

#include "core/disjoint_sets.h"
#include "core/gather.h"
#include "core/neighbor_messages.h"
#include "discretization/cell_sampler.h"
#include "discretization/cells.h"
#include "state/state.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace nsfd
{
  template <int dim>
  Connection connection(const State &state,
                        const typename InterfacePoints<dim>::Face &face)
  {
    Connection result = Connection::open;
    for (unsigned int i = face.first; i < face.first + face.count; ++i) {
      const PointKind kind = state.kind[i];
      if (is_joined(kind))
        return Connection::joined;
      if (kind == PointKind::elastic ||
          (kind == PointKind::cohesive && state.beta[i] >= 1e-3))
        result = Connection::intact;
    }
    return result;
  }

  template <int dim>
  ConnectedCells<dim>::ConnectedCells(const Discretization<dim> &discretization,
                                      const Communicator &communicator,
                                      const GhostCells *ghosts)
      : discretization_(discretization), communicator_(communicator),
        ghosts_(ghosts)
  {
    const auto &points = discretization.points();
    for (unsigned int f = 0; f < points.faces.size(); ++f) {
      const auto &face = points.faces[f];
      const int a = face.bodies[0], b = face.bodies[1];
      // with ghosts the cells on both sides are here, or on another rank
      const bool counts =
          ghosts ? a >= 0 && b >= 0 : face.first < points.n_owned;
      if (!face.boundary && counts)
        links_.push_back(a >= 0 ? Link{f, unsigned(a), b}
                                : Link{f, unsigned(b), -1});
    }
  }

  template <int dim>
  void
  ConnectedCells<dim>::connect(const std::function<bool(const Face &)> &hold)
  {
    find_pieces(hold);
    count_ = unsigned(communicator_.sum_integer(n_pieces_));
    if (communicator_.size() > 1)
      join_pieces(pairs_between_ranks(hold));
  }

  /** Connected components of the cells of this rank. */
  template <int dim>
  void ConnectedCells<dim>::find_pieces(
      const std::function<bool(const Face &)> &hold)
  {
    const auto &faces = discretization_.points().faces;
    DisjointSets cells(discretization_.bodies().size());
    for (const Link &link : links_)
      if (link.other >= 0 && hold(faces[link.face]))
        cells.join(link.cell, unsigned(link.other));
    for (const InnerFace &face : discretization_.inner_faces())
      cells.join(face.bodies[0], face.bodies[1]);
    piece_ = cells.numbers(n_pieces_);
    const std::uint64_t mine = n_pieces_;
    std::uint64_t end = 0;
    MPI_Scan(&mine, &end, 1, MPI_UINT64_T, MPI_SUM, communicator_.mpi());
    first_piece_ = end - mine;
    stands_for_.resize(n_pieces_);
    std::iota(stands_for_.begin(), stands_for_.end(), first_piece_);
  }

  /** By face between ranks: the piece on its other side. */
  template <int dim>
  std::vector<std::uint64_t> ConnectedCells<dim>::pieces_beyond() const
  {
    const auto &points = discretization_.points();
    NeighborMessages<std::uint64_t> exchange;
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
    std::vector<std::uint64_t> beyond(points.faces.size());
    for (std::size_t k = 0; k < points.neighbors.size(); ++k)
      for (std::size_t j = 0; j < points.neighbors[k].points.size(); ++j)
        beyond[points.face_of[points.neighbors[k].points[j]]] =
            exchange.messages[k].in[j];
    return beyond;
  }

  /** Over the faces between ranks; of ghosts, over the cells themselves. */
  template <int dim>
  auto ConnectedCells<dim>::pairs_between_ranks(
      const std::function<bool(const Face &)> &hold) const -> std::vector<Pair>
  {
    std::vector<Pair> pairs;
    if (ghosts_) {
      std::vector<double> piece(piece_.size()); // below 2^53
      for (std::size_t c = 0; c < piece.size(); ++c)
        piece[c] = double(first_piece_ + piece_[c]);
      const std::vector<double> here = piece;
      ghosts_->fetch(piece);
      for (std::size_t c = 0; c < piece.size(); ++c)
        if (ghosts_->is_ghost(c))
          pairs.push_back({{std::uint64_t(here[c]), std::uint64_t(piece[c])}});
    } else {
      const auto beyond = pieces_beyond();
      for (const Link &link : links_)
        if (link.other < 0 && hold(discretization_.points().faces[link.face]))
          pairs.push_back(
              {{first_piece_ + piece_[link.cell], beyond[link.face]}});
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

  template <int dim>
  void ConnectedCells<dim>::join_pieces(std::vector<Pair> pairs)
  {
    const auto all = gather(communicator_, pairs);
    const auto first_pieces =
        gather(communicator_, std::vector<std::uint64_t>{first_piece_});

    // only rank 0 has anything in here; pieces in the order of their ranks
    std::vector<std::uint64_t> met;
    for (const Pair &pair : all)
      met.insert(met.end(), pair.begin(), pair.end());
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    DisjointSets pieces(met.size());
    const auto place = [&met](const std::uint64_t piece) {
      return unsigned(std::lower_bound(met.begin(), met.end(), piece) -
                      met.begin());
    };
    for (const Pair &pair : all)
      pieces.join(place(pair[0]), place(pair[1]));
    std::vector<Pair> answers;
    std::vector<int> n_answers(first_pieces.size(), 0);
    std::uint64_t joined = 0;
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
    MPI_Bcast(&joined, 1, MPI_UINT64_T, 0, communicator_.mpi());
    count_ -= unsigned(joined);
  }

  template <int dim>
  std::vector<unsigned int> ConnectedCells<dim>::numbers() const
  {
    struct Piece {
      std::uint64_t stands_for, cell;
      std::array<double, 3> centre;
      auto key() const { return std::tie(centre, cell); }
    };
    constexpr auto none = std::numeric_limits<std::uint64_t>::max();
    std::vector<Piece> own(n_pieces_);
    for (unsigned int k = 0; k < n_pieces_; ++k)
      own[k] = {stands_for_[k], none, {}};
    for (unsigned int c = 0; c < piece_.size(); ++c) {
      const Piece cell = {stands_for_[piece_[c]],
                          discretization_.cells().global_cell[c],
                          in_space<dim>(discretization_.cells().centre(c))};
      Piece &piece = own[piece_[c]];
      if (piece.cell == none || cell.key() < piece.key())
        piece = cell;
    }
    std::vector<int> n_per_rank;
    const auto all = gather(communicator_, own, n_per_rank);
    std::vector<unsigned int> order(all.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](const unsigned int a, const unsigned int b) {
                return all[a].key() < all[b].key();
              });
    // the first cell of a component comes first: pieces are numbered from 0
    // on, rank by rank, as they stand in `all`
    std::vector<unsigned int> number_of(all.size(), unsigned(-1)),
        of_pieces(all.size());
    unsigned int next = 0;
    for (const unsigned int k : order) {
      unsigned int &number = number_of[all[k].stands_for];
      if (number == unsigned(-1))
        number = next++;
      of_pieces[k] = number;
    }
    const auto mine = scatter(communicator_, of_pieces, n_per_rank);
    std::vector<unsigned int> result(piece_.size());
    for (std::size_t c = 0; c < piece_.size(); ++c)
      result[c] = mine[piece_[c]];
    return result;
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template Connection connection<dim>(                                         \
      const State &, const typename InterfacePoints<dim>::Face &);             \
  template class ConnectedCells<dim>
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
