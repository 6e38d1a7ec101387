#pragma once

namespace nsfd
{
  class Archive;
  struct State;

  /** All of a state, to or from an archive. Collective. */
  void serialize(State &state, Archive &archive);
} // namespace nsfd
