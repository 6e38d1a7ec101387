#include "joined_start.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace nsfd
{
  template <int dim>
  std::vector<std::uint8_t>
  joined_points(const Discretization<dim> &discretization, const State &state)
  {
    const auto &origins = discretization.origins();
    std::vector<std::uint8_t> joined(origins.size());
    for (std::size_t i = 0; i < origins.size(); ++i)
      joined[i] = origins[i].kind == PointOrigin::Kind::interface &&
                  (state.kind[i] == PointKind::bonded ||
                   state.kind[i] == PointKind::rigid ||
                   state.kind[i] == PointKind::prescribed);
    return joined;
  }

  namespace
  {
    /** Of what hangs nothing is prescribed that is not where it hangs from. */
    template <int dim>
    bool moves_differ(const HangingNodes<dim> &hanging,
                      const CornerGroups<dim> &groups,
                      const std::vector<std::uint8_t> &mask)
    {
      bool differ = false;
      for (const auto &tie : hanging.ties()) {
        if (!hanging.is_own(tie)) // all of its nodes are whole on its rank
          continue;
        unsigned int common = ~0u;
        for (std::size_t k = tie.first; k < tie.last; ++k)
          common &= mask[groups.of(hanging.master(k))];
        differ = differ || (mask[tie.group] & ~common) != 0;
      }
      return differ;
    }
  } // namespace

  template <int dim>
  void check_hanging(const Communicator &communicator,
                     const Discretization<dim> &discretization,
                     const JoinedMesh<dim> &mesh, const State &state,
                     HangingNodes<dim> &hanging,
                     PrescribedGroups<dim> &supports)
  {
    const auto refuse = [&](const bool here, const std::string &what) {
      if (communicator.any(here))
        throw std::runtime_error(
            "scheme = explicit joins cells of two sizes: " + what);
    };
    const auto &origins = discretization.origins();
    const auto joined = joined_points(discretization, state);
    bool open = false, springs = false;
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (joined[i] || origins[i].kind != PointOrigin::Kind::interface)
        continue;
      open |= mesh.between_sizes(i);
      springs |=
          hanging.hangs(mesh.a_corner(i)) && state.kind[i] != PointKind::free;
    }
    refuse(open, "the law of a face between them must be extrinsic or joined, "
                 "and the face not be broken from the start; or let cells of "
                 "one size be on both sides");
    refuse(springs, "a node in the middle of a larger face lies on a face with "
                    "springs; take an extrinsic law there, or cells of one "
                    "size");
    CornerGroups<dim> groups(mesh, joined);
    refuse(!hanging.tie(groups),
           "those that are larger meet at an edge of smaller ones without "
           "being joined there; refine them, too, or take degree <= 2");
    refuse(std::isinf(hanging.mass_share()),
           "the smaller ones are so much heavier that nodes of larger ones "
           "have no positive mass; refine where the density jumps");
    supports.find(groups);
    refuse(moves_differ(hanging, groups, supports.mask()),
           "a prescribed motion ends at an edge between them; let it hold on "
           "both sides, or for cells of one size");
  }

#define NSFD_INSTANTIATE(dim)                                                  \
  template std::vector<std::uint8_t> joined_points(                            \
      const Discretization<dim> &, const State &);                             \
  template void check_hanging(const Communicator &,                            \
                              const Discretization<dim> &,                     \
                              const JoinedMesh<dim> &, const State &,          \
                              HangingNodes<dim> &, PrescribedGroups<dim> &)
  NSFD_INSTANTIATE(2);
  NSFD_INSTANTIATE(3);
#undef NSFD_INSTANTIATE
} // namespace nsfd
