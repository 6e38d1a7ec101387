#pragma once

#include "face_nodes.h"
#include "moving_bodies.h"

#include "nsfd/contact/surface_search.h"

#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace nsfd
{
  /**
   * The surfaces of the moving bodies: sides of the mesh, lips of faces that
   * have broken between two bodies, balls. It says which of their places touch
   * another surface or an obstacle in a step.
   *
   * A place of a surface is a node on a face of a cell, a ball or, in space, an
   * edge; what it remembers (slip, wear, the last impulse) stays with it
   * whatever it touches, in the arrays `surface_...` of the state. Contacts of
   * two edges belong to that of body 2; those of one edge share what it
   * remembers.
   */
  template <int dim>
  class SurfaceContacts
  {
  public:
    SurfaceContacts(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    const MovingBodies<dim> &bodies);

    /** Nothing remembered; broken faces are surfaces from the start. */
    void set_initial(State &state) const;

    /** What State::surface_contact says of a place, added up. */
    enum Mark : std::uint8_t
    {
      touches = 1,
      released = 2 ///< something let go of its body in the last step
    };

    /**
     * Points between two bodies that nothing holds together any more are left
     * to the search: `parted`.
     */
    void part(State &state) const;

    /** What may touch in a step of @p time_step from @p old. */
    std::vector<MovingRow<dim>> rows(const State &old, double time_step);

    struct Counters
    {
      unsigned long long searches = 0, facets = 0, rows = 0;
      unsigned long long edge_rows = 0; ///< of these rows
      double largest_overlap = 0.; ///< of all pairs at starts of steps, m
    };
    const Counters &counters() const { return counters_; }

  private:
    using Row = MovingRow<dim>;
    using Vector = dealii::Tensor<1, dim>;
    using Pair = std::uint64_t;

    static Pair pair_of(const unsigned int a, const unsigned int b)
    {
      return a < b ? (Pair(a) << 32 | b) : (Pair(b) << 32 | a);
    }
    std::size_t place_of(unsigned int cell, unsigned int face,
                         unsigned int node) const;
    std::size_t place_of_edge(unsigned int node_1, unsigned int node_2) const;
    int block_of(unsigned int body_1, unsigned int body_2) const;
    void merge_nodes();
    void number_edges();
    void set_boundary();
    bool is_surface(unsigned int cell, unsigned int face,
                    const State &state) const;
    bool follow(const State &state);
    void set_sides(const State &state);
    bool is_corner(unsigned int cell, unsigned int face,
                   unsigned int node) const;
    void add_face(unsigned int cell, unsigned int face);
    void add_obstacle_faces(const State &state);
    void add_surface_rows(const State &old, double reach,
                          std::vector<Row> &rows);
    void add_obstacle_rows(const State &old, double reach,
                           std::vector<Row> &rows) const;
    void set_partner(const FacetPair<dim> &pair, const State &old,
                     Row &row) const;
    static constexpr std::size_t unseen = Row::nowhere;
    /** Which row sees it from the other side, or @p unseen; else it has that
        @p index. */
    std::size_t seen_from_there(const FacetPair<dim> &pair, const Row &row,
                                std::size_t index);
    Row edge_row(const EdgePair<dim> &pair, const State &old,
                 const std::vector<double> &x) const;
    std::uint8_t mark_of(const State &old, unsigned int facet) const;
    Vector velocity(const State &old, std::size_t node) const;
    Vector centre_velocity(const State &old, unsigned int body) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const MovingBodies<dim> &bodies_;
    std::vector<std::vector<FaceNodes<dim>>> faces_; ///< per class of cells
    std::vector<std::size_t> first_place_;      ///< per cell, then of balls
    static constexpr int boundary = -1, inside = -2;
    std::vector<std::vector<int>> mesh_face_; ///< per cell and face: that of
                                              ///< the points, or one of these
    std::vector<unsigned int> merged_; ///< node of the body at the same place
    std::vector<Pair> edges_; ///< in space: pairs of these nodes, sorted
    std::vector<int> block_by_materials_;

    // of the surfaces at hand
    struct Side
    {
      unsigned int cell, face;
      Vector normal;
    };
    std::unordered_map<unsigned int, std::vector<Side>> sides_at_;
    std::vector<char> parted_; ///< per face of the mesh points
    bool known_ = false;
    std::unordered_set<Pair> joined_;
    Surfaces<dim> surfaces_;
    struct Origin
    {
      unsigned int cell, face, node; ///< node of the face
    };
    std::vector<Origin> point_origins_;
    std::vector<unsigned int> facet_cells_;
    std::vector<ObstacleFace> obstacle_faces_;
    SurfaceSearch<dim> search_;
    NearPairs<dim> pairs_;
    /// normals of contacts between two corners, by own node and other one
    struct Seen
    {
      Vector normal;
      std::size_t row;
    };
    std::unordered_map<Pair, Seen> seen_;
    Counters counters_;
  };
} // namespace nsfd
