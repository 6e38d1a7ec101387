#pragma once

#include "core/disjoint_sets.h"
#include "linear_algebra/ghost_values.h"
#include "linear_algebra/spd_solver.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * Nodes at the same place on the two sides of a face, named by the first of
   * their unknowns. A face between two ranks is listed on both.
   */
  struct NodePairs {
    std::vector<std::size_t> start{0}; ///< per face and one more
    std::vector<int> own;              ///< on this rank
    std::vector<long long> other;      ///< global number, of any rank
    /// per face: every node on either side has its partner, so that there is
    /// no jump once it is joined
    std::vector<char> complete;
  };

  /**
   * Nodes of a cell at its face with a larger one where that one has no node,
   * or with a rigid one: they follow its trace there; and the motions of two
   * rigid ones, each of the other. By unknown, which may be on any rank;
   * weights are those of the unknowns that it follows. A face between two ranks
   * is listed on both.
   */
  struct NodeTies {
    enum class Kind : std::uint8_t {
      of_sizes,  ///< a smaller cell follows a larger one
      on_rigid,  ///< a cell follows a rigid one
      both_rigid ///< either follows the other one
    };
    struct Follower {
      long long unknown;
      long long body, other; ///< first unknowns: of its body, of the other one
      std::vector<std::pair<long long, double>> masters;
    };
    std::vector<std::vector<Follower>> of_face; ///< per face; most are empty
    std::vector<Kind> kind;                     ///< per face
    std::vector<std::uint64_t> key; ///< of faces, alike on all ranks
  };

  /** Where an unknown of a deformable body sits. */
  struct Unknowns {
    long long first = 0;                ///< global number of the first one
    std::vector<double> coordinates;    ///< of its node, along its component
    std::vector<signed char> component; ///< -1: not a nodal value
  };

  /**
   * The space in which nodes are one wherever the faces between them are
   * joined: continuous across joined faces, free to jump elsewhere.
   */
  class ConformingSpace
  {
  public:
    ConformingSpace(const Communicator &communicator, unsigned int dim,
                    Unknowns unknowns, NodePairs pairs, NodeTies ties = {});

    /**
     * Functions of the space no longer jump across the marked faces, alike on
     * both ranks of a shared face. The space is numbered again if one differs
     * from last time.
     */
    void conform(const std::vector<char> &faces);

    /** There would be no jump across the face if it were joined. */
    bool is_complete(const std::size_t face) const
    {
      return pairs_.complete[face] || is_tied(face);
    }

    /**
     * @p faces as they can be joined at once: not those with ties where what
     * the nodes are to follow follows others itself, or where they follow
     * another cell already. Collective.
     */
    std::vector<char> without_contradiction(std::vector<char> faces);

    /** Faces across which functions could jump if these ones were joined, alike
        on both ranks of a shared face; conform() is to be called then. */
    std::vector<char> jumping(const std::vector<char> &joined);

    /** Something else than the faces made its matrix outdated. */
    void touch() { ++space_.version; }

    const CoarseSpace &space() const { return space_; }

    /** Joined faces across which functions of the space do not jump. */
    std::vector<char> without_jump() const;

  private:
    void join(const std::vector<char> &faces);
    std::vector<double> names(const std::vector<char> &joined);
    void agree(std::vector<double> &value, bool smallest);
    void set_modes();
    bool is_tied(const std::size_t face) const
    {
      return !ties_.of_face.empty() && !ties_.of_face[face].empty();
    }
    double value_at(long long unknown, const std::vector<double> &own,
                    const std::vector<double> &ghosts) const;
    std::vector<CoarseSpace::Tie> ties_of(const std::vector<char> &faces,
                                          const std::vector<double> &own,
                                          std::vector<char> &contradicting);

    const Communicator &communicator_;
    const unsigned int dim_;
    const Unknowns unknowns_;
    const NodePairs pairs_;
    const NodeTies ties_;
    bool has_ties_ = false; ///< on any rank
    std::vector<char> conforming_;
    DisjointSets joined_; ///< unknowns, in between alone
    /// own roots and the ghosts they are joined to
    std::vector<std::pair<int, int>> across_;
    std::vector<long long> ghosts_;
    GhostValues exchange_;
    CoarseSpace space_;
  };
} // namespace nsfd
