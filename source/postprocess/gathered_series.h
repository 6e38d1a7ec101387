#pragma once

#include "vtu.h"

namespace nsfd
{
  class Archive;
  class Communicator;

  /** The pieces of all ranks as one, on the first rank. Collective. */
  VtuGrid gather_grid(const Communicator &communicator, const VtuGrid &piece);

  /** Pictures in files that the first rank writes alone, behind each other. */
  class GatheredSeries
  {
  public:
    virtual ~GatheredSeries() = default;

    /**
     * A further time; the files are complete behind it. @throws OutputError if
     * a file cannot be written.
     */
    virtual void add(const VtuGrid &grid) = 0;

    /**
     * The times so far. After reading, later ones of an earlier run are removed
     * from the files; one that was cut off in the middle of a time is put aside
     * as NAME_damaged, and a new series begins.
     */
    virtual void serialize(Archive &archive) = 0;
  };
} // namespace nsfd
