#pragma once

#include "core/dice.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace wall
{
  /** Draws of a scene. */
  class Draw
  {
  public:
    explicit Draw(const unsigned int seed) : dice_(seed) {}

    double between(const double low, const double high)
    {
      return dice_(low, high);
    }
    /** Every decade is as likely. */
    double decades(const double low, const double high)
    {
      return std::exp(dice_(std::log(low), std::log(high)));
    }
    bool chance(const double share) { return dice_(0., 1.) < share; }
    int whole(const int low, const int high)
    {
      return std::min(high, low + int(dice_(0., 1.) * (high - low + 1)));
    }
    /** The place of a share in a list of them. */
    std::size_t one_of(const std::vector<double> &shares)
    {
      double sum = 0.;
      for (const double share : shares)
        sum += share;
      double rest = dice_(0., sum);
      for (std::size_t i = 0; i < shares.size(); ++i)
        if ((rest -= shares[i]) <= 0. && shares[i] > 0.)
          return i;
      return shares.size() - 1;
    }

  private:
    nsfd::Dice dice_;
  };

  enum class Kind { rigid, elastic, breakable, mixed };

  using Vector = std::array<double, 3>;

  struct Substance {
    const char *name;
    double young, poisson, density;
    /** Of pressure. */
    double wave_speed() const
    {
      return std::sqrt(young * (1. - poisson) / (1. + poisson) /
                       (1. - 2. * poisson) / density);
    }
  };

  struct Body {
    std::string name;
    Vector low{}, high{};
    std::array<int, 3> cells{{1, 1, 1}};
    std::string shape = "box"; ///< or notched, ball, gmsh, or a type of mesh
    double distortion = 0.;    ///< of the mesh
    bool rigid = false, breakable = false;
    Substance substance{};
    Vector velocity{};
    double angle = 0.; ///< rad, in the plane

    Vector centre() const
    {
      return {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]),
              0.5 * (low[2] + high[2])};
    }
    /** Its cells are quadrilaterals or hexahedra. */
    bool is_boxes() const { return shape == "box" || shape == "notched"; }
    int n_cells(int dim) const;
    /** The shortest edge. */
    double edge(int dim) const;
  };

  /** A block of a parameter file that acts on the bodies. */
  struct Block {
    std::string name;                 ///< Boundary: left
    std::vector<std::string> entries; ///< velocity x = 0
  };

  /** A scene before it is text. Lengths in m, times in s. */
  struct Draft {
    /// of the bodies, the one with the slowest waves: speeds and loads are
    /// counted from it
    Substance slowest{};
    int dim = 2;
    bool large = true, touches = true, plane_stress = false;
    Kind kind = Kind::elastic;
    std::string integrator;
    double unit = 1.;      ///< a length that bodies are about as large as
    Substance substance{}; ///< of all bodies, or of most
    double speed = 0.;
    double gap = 0.; ///< that closes first
    std::vector<Body> bodies;
    std::vector<Block> blocks;
    double gravity = 0.;
    bool jointed =
        false; ///< parts of one mesh do not all touch: some are joined
    bool keeps_momentum = true;
    /// until what is driven has gone half a body: no user drives on
    double longest = 1e30;

    double wave_speed() const;
    double smallest_edge() const;
    /** For Gmsh. */
    double mesh_size() const;
    int n_cells() const;
    bool is_rigid() const;
    /** Implicit steps of large motions of what breaks: the dearest. */
    bool iterates_on_cracks() const;
    /** Something goes at @p speed from @p start on, along direction @p d, @p
        away from what it meets. */
    void end_at_half(double speed, int d, double start, double away);
  };

  /** Bodies, supports and drives. */
  void lay_out(Draft &draft, Draw &draw);

  /** Holds a side of all bodies, or only what is upright to it. */
  void hold(Draft &draft, const std::string &side, bool fully);
  /** A plane below all bodies, at rest. */
  void add_floor(Draft &draft, Draw &draw, double height);
  /** A ball or a disc that comes from above. */
  void add_hammer(Draft &draft, Draw &draw, const Vector &place, double radius);
  /** Motion or load of a side that grows, starts at once or oscillates. */
  void drive(Draft &draft, Draw &draw, const std::string &side, int direction,
             double sign);
  /** Holds a place of a rigid body. */
  void add_pin(Draft &draft, Draw &draw);

  struct Touch {
    double friction = 0., restitution = 0.;
    std::vector<std::string> entries() const;
  };
  Touch draw_touch(Draw &draw);

  /** The direction that is up, and its sides. */
  inline int up(const Draft &draft) { return draft.dim - 1; }
  inline char axis(const int d) { return "xyz"[d]; }
  std::string corner(const Vector &point, int dim);

  /** Material, Interface and Contact blocks. */
  std::vector<Block> material_blocks(const Draft &draft, Draw &draw);
  std::vector<Block> interface_blocks(const Draft &draft, Draw &draw);

  /** A number with a unit, as users write it. */
  std::string length(double metres);
  std::string speed(double metres_per_second);
  std::string pressure(double pascals);
  std::string time(double seconds);
} // namespace wall
