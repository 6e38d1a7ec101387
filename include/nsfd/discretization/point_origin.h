#pragma once

namespace nsfd
{
  /** Where a point on a face comes from. */
  struct PointOrigin {
    enum class Kind : unsigned char {
      interface, ///< between two cells, `block` of SceneInput::interfaces
      motion,    ///< prescribed motion, `block` of boundaries
      obstacle,  ///< `block` of obstacles
      surface,   ///< of large motions, for one step: `block` of contacts
      pin        ///< of large motions: `block` of pins
    };
    Kind kind = Kind::interface;
    unsigned int block = 0;
    /// of the springs of an interface over that of its law, in (0, 1]: less on
    /// faces of refined cells where springs keep the modulus of the body
    double compliance = 1.;
  };
} // namespace nsfd
