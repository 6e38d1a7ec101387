#pragma once

#include "body_view.h"
#include "svg.h"

namespace nsfd
{
  /** What colours a polygon, NaN where there is no such value. */
  inline double coloured_value(const Snapshot::Polygon &polygon,
                               const PictureOptions::Colouring colouring)
  {
    switch (colouring) {
    case PictureOptions::Colouring::speed:
      return polygon.speed;
    case PictureOptions::Colouring::warmth:
      return polygon.warmth;
    default:
      return polygon.value;
    }
  }

  /** As a picture shows it. */
  enum class FaceState { intact, damaged, broken, contact };

  inline FaceState state_of(const Snapshot::FacePiece &face)
  {
    if (face.contact)
      return FaceState::contact;
    if (face.beta <= 1e-9)
      return FaceState::broken;
    return face.beta < 1. - 1e-9 ? FaceState::damaged : FaceState::intact;
  }
} // namespace nsfd
