#include "conforming_space.h"

#include <algorithm>

namespace nsfd
{
  ConformingSpace::ConformingSpace(const Communicator &communicator,
                                   const unsigned int dim, Unknowns unknowns,
                                   NodePairs pairs, NodeTies ties)
      : communicator_(communicator), dim_(dim), unknowns_(std::move(unknowns)),
        pairs_(std::move(pairs)), ties_(std::move(ties))
  {
    const long long n = static_cast<long long>(unknowns_.component.size());
    const auto note = [&](const long long unknown) {
      if (unknown < unknowns_.first || unknown >= unknowns_.first + n)
        ghosts_.push_back(unknown);
    };
    for (const long long other : pairs_.other)
      for (unsigned int c = 0; c < dim; ++c)
        note(other + c);
    bool tied = false;
    for (const auto &face : ties_.of_face)
      for (const auto &tie : face) {
        tied = true;
        note(tie.unknown);
        note(tie.body);
        note(tie.other);
        for (const auto &master : tie.masters)
          note(master.first);
      }
    has_ties_ = communicator.any(tied);
    std::sort(ghosts_.begin(), ghosts_.end());
    ghosts_.erase(std::unique(ghosts_.begin(), ghosts_.end()), ghosts_.end());
    const auto &component = unknowns_.component;
    const bool other_kinds =
        std::find(component.begin(), component.end(), -1) != component.end();
    space_.per_node = communicator.any(other_kinds) ? 1 : dim;
    exchange_ =
        GhostValues(communicator, unknowns_.first, std::size_t(n), ghosts_);
  }

  void ConformingSpace::join(const std::vector<char> &faces)
  {
    const long long n = static_cast<long long>(unknowns_.component.size());
    joined_ = DisjointSets(std::size_t(n));
    across_.clear();
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t k = pairs_.start[f]; faces[f] && k < pairs_.start[f + 1];
           ++k)
        for (unsigned int c = 0; c < dim_; ++c) {
          const int own = pairs_.own[k] + int(c);
          const long long other = pairs_.other[k] + c;
          if (other >= unknowns_.first && other < unknowns_.first + n)
            joined_.join(unsigned(own), unsigned(other - unknowns_.first));
          else
            across_.emplace_back(
                own,
                int(std::lower_bound(ghosts_.begin(), ghosts_.end(), other) -
                    ghosts_.begin()));
        }
  }

  /**
   * Make @p value, one per unknown and valid at the roots, the smallest
   * (largest) one over all that is joined together on any rank. As many
   * exchanges as ranks lie around a node.
   */
  void ConformingSpace::agree(std::vector<double> &value, const bool smallest)
  {
    std::vector<double> ghosts(ghosts_.size());
    bool changed = true;
    while (communicator_.any(changed)) {
      changed = false;
      for (std::size_t i = 0; i < value.size(); ++i)
        value[i] = value[joined_.first(unsigned(i))];
      exchange_.fetch(value.data(), ghosts.data());
      for (const auto &[own, ghost] : across_) {
        double &mine = value[joined_.first(unsigned(own))];
        if (smallest ? ghosts[ghost] < mine : ghosts[ghost] > mine) {
          mine = ghosts[ghost];
          changed = true;
        }
      }
    }
  }

  void ConformingSpace::conform(const std::vector<char> &faces)
  {
    if (!communicator_.any(space_.version == 0 || faces != conforming_))
      return;
    conforming_ = faces;
    ++space_.version;
    join(faces);
    const std::size_t n = unknowns_.component.size();
    std::vector<double> value(n); // integers below 2^53
    for (std::size_t i = 0; i < n; ++i)
      value[i] = double(unknowns_.first) + double(i);
    agree(value, true);
    // numbered by the rank that owns the smallest of them
    long long own = 0, end = 0;
    for (std::size_t i = 0; i < n; ++i)
      own += value[i] == double(unknowns_.first) + double(i);
    MPI_Scan(&own, &end, 1, MPI_LONG_LONG, MPI_SUM, communicator_.mpi());
    space_.first = end - own;
    space_.n_own = own;
    space_.n_global = static_cast<long long>(
        communicator_.sum_integer(static_cast<unsigned long long>(own)));
    double next = double(space_.first);
    for (std::size_t i = 0; i < n; ++i)
      value[i] = value[i] == double(unknowns_.first) + double(i) ? next++ : -1.;
    agree(value, false);
    space_.number.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      space_.number[i] = static_cast<long long>(value[i]);
    joined_ = DisjointSets();
    std::vector<char> contradicting; // none, see without_contradiction()
    space_.ties = ties_of(faces, {space_.number.begin(), space_.number.end()},
                          contradicting);
    set_modes();
  }

  std::vector<char> ConformingSpace::without_jump() const
  {
    std::vector<char> result(conforming_);
    for (std::size_t f = 0; f < result.size(); ++f)
      result[f] = result[f] && pairs_.complete[f];
    return result;
  }

  /** Translations and rotations of the deformable bodies. */
  void ConformingSpace::set_modes()
  {
    const unsigned int n_modes = dim_ == 2 ? 3 : 6;
    // none keeps the room that a larger space took before
    space_.modes.clear();
    space_.modes.resize(n_modes, std::vector<double>(space_.n_own, 0.));
    for (std::size_t i = 0; i < space_.number.size(); ++i) {
      const long long k = space_.number[i] - space_.first;
      const int c = unknowns_.component[i];
      if (k < 0 || k >= space_.n_own || c < 0)
        continue;
      const double *x = unknowns_.coordinates.data() + i - c;
      space_.modes[c][k] = 1.;
      if (dim_ == 2)
        space_.modes[2][k] = c == 0 ? -x[1] : x[0];
      else
        for (int a = 0; a < 3; ++a) {
          // e_a x r
          const int b = (a + 1) % 3, d = (a + 2) % 3;
          space_.modes[3 + a][k] = c == b ? -x[d] : c == d ? x[b] : 0.;
        }
    }
    // what follows has a row of its own, without motion
    for (const CoarseSpace::Tie &tie : space_.ties)
      for (auto &mode : space_.modes)
        if (tie.number >= space_.first &&
            tie.number < space_.first + space_.n_own)
          mode[std::size_t(tie.number - space_.first)] = 0.;
  }
} // namespace nsfd
