#pragma once

#include "vtu.h"

#include <string>
#include <vector>

namespace nsfd
{
  class Archive;
  class Communicator;

  /** The pieces of all ranks as one, on the first rank. Collective. */
  VtuGrid gather_grid(const Communicator &communicator, const VtuGrid &piece);

  /**
   * NAME.h5, a group `00012` per time with points, cells and data, and
   * NAME.xdmf, which tells ParaView what is where. Points and cells that stay
   * what they were are stored once, and linked. Both files are complete after
   * every add(). One process.
   */
  class XdmfSeries
  {
  public:
    /** @p path without an extension. Nothing is written yet. */
    explicit XdmfSeries(const std::string &path);

    /** @throws std::runtime_error if a file cannot be written. */
    void add(const VtuGrid &grid);

    /**
     * The entries so far. After reading, later ones of an earlier run are
     * removed from the files; a file that was cut off in the middle of a time
     * is put aside as NAME_damaged.h5.
     */
    void serialize(Archive &archive);

  private:
    struct Entry {
      double time;
      std::string text; ///< its grid in the XDMF file
    };
    void write_xdmf() const;
    void cut(std::size_t n) const;

    const std::string path_;
    std::vector<Entry> entries_;
    std::string mesh_;  ///< group of the points and cells in use
    VtuGrid last_mesh_; ///< without data
  };
} // namespace nsfd
