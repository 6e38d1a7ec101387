#pragma once

#include "body_layout.h"
#include "contact_places.h"
#include "surface_motion.h"

#include "contact_detection/surface_search.h"

#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * The surfaces that there are in a step, of all ranks: sides of the mesh and
   * crack faces that have separated, and where they are.
   */
  template <int dim>
  class ActiveSurfaces
  {
  public:
    using Vector = dealii::Tensor<1, dim>;
    /// more than there are; keys of facets begin with the place of their face
    static constexpr std::uint64_t pieces_per_face = 64;

    ActiveSurfaces(const SceneInput &input,
                   const Discretization<dim> &discretization,
                   const BodyLayout<dim> &bodies,
                   const Communicator &communicator,
                   const SurfaceCells<dim> &cells,
                   const ContactPlaces<dim> &places,
                   const ContactBlocks &blocks);

    /** Surfaces and their motion in @p state; true if they are others than in
        the last step. Collective. */
    bool follow(const State &state);

    /** Cells hang together by common nodes: the node that has the motion of a
        node of SurfaceCells, and a number of the whole that a cell is in. */
    struct Wholes {
      std::vector<unsigned int> node, of_cell;
    };
    /** To be called before follow() where they are others. */
    void set_wholes(Wholes wholes)
    {
      wholes_ = std::move(wholes);
      known_ = false;
    }
    const Wholes &wholes() const { return wholes_; }
    /** See SurfaceCells::merged(). */
    unsigned int merged(const std::size_t node) const
    {
      return wholes_.node.empty() ? cells_.merged(node) : wholes_.node[node];
    }

    struct Origin {
      unsigned int cell, face, node; ///< node of the face
    };
    /** What is searched, and where its parts come from. */
    struct Set {
      Surfaces<dim> surfaces;
      std::vector<Origin> point_origins;
      std::vector<std::size_t> point_places;
      /// of all faces that are surfaces or have begun to open
      std::vector<std::pair<unsigned int, std::size_t>> places_by_vertex;
      std::vector<unsigned int> facet_cells, facet_faces; ///< of the cell
    };
    Set &set() { return set_; }
    const Set &set() const { return set_; }
    /** Faces that obstacles may touch. */
    const std::vector<ObstacleFace> &obstacle_faces() const
    {
      return obstacle_faces_;
    }
    /** Faces between these bodies still hold. */
    bool are_joined(const unsigned int body_1, const unsigned int body_2) const
    {
      return joined_.count(pair_of(body_1, body_2)) > 0;
    }
    /** Faces that hold lead from one to the other. */
    bool are_one_piece(const unsigned int cell_1,
                       const unsigned int cell_2) const
    {
      return piece_of_cell_[cell_1] == piece_of_cell_[cell_2];
    }
    /**
     * Flat sides of a rigid body touch with their corners: not with nodes
     * inside of them and, where several of its faces meet, with one of each
     * direction.
     */
    bool is_corner(unsigned int cell, unsigned int face,
                   unsigned int node) const;
    /** How far a face that still holds, and is a surface since one of its
        points has broken or slid by this, has slid before, m; 0: it does not
        hold. */
    double unseen_slip(unsigned int cell, unsigned int face) const;
    /** Where they are. */
    const SurfaceMotion<dim> &motion() const { return motion_; }

  private:
    /// how far a face that still holds somewhere has opened
    enum class Opening : char {
      none,
      begun, ///< corners that it frees may touch an obstacle
      half   ///< free at one of its points: nothing covers its sides there
    };
    struct Change {
      unsigned int face;
      char separated;
      Opening opening;
    };
    Opening opening_of(const State &state, std::size_t face) const;
    bool is_surface(unsigned int cell, unsigned int face) const;
    bool has_opened(unsigned int cell, unsigned int face) const;
    bool share_separated(const State &state);
    void set_surfaces();
    void set_sides();
    void set_moving_nodes();
    void set_pieces();
    void add_face(unsigned int cell, unsigned int face, bool touches);
    bool is_behind(unsigned int vertex, unsigned int facet) const;
    void add_obstacle_faces();

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const BodyTable &table_;
    const Communicator &all_;
    const SurfaceCells<dim> &cells_;
    const ContactPlaces<dim> &places_;
    const ContactBlocks &blocks_;
    const bool obstacle_for_all_; ///< one of them
    SurfaceMotion<dim> motion_;

    struct Side {
      unsigned int cell, face;
      Vector normal;
    };
    std::unordered_map<unsigned int, std::vector<Side>> sides_at_;
    std::vector<char> separated_;  ///< per mesh face
    std::vector<Opening> opening_; ///< per mesh face, of all ranks
    Wholes wholes_;                ///< empty: every body is one
    /// by cell: what hangs together, in wholes or else by faces that hold
    std::vector<unsigned int> piece_of_cell_;
    bool known_ = false;
    std::unordered_set<UnorderedPair> joined_;
    Set set_;
    std::vector<ObstacleFace> obstacle_faces_;
  };
} // namespace nsfd
