#pragma once

#include "gathered_series.h"

#include <string>
#include <vector>

namespace nsfd
{
  /**
   * NAME.h5, a group `00012` per time with points, cells and data, and
   * NAME.xdmf, which tells ParaView what is where. Points and cells that stay
   * what they were are stored once, and linked. Both files are complete after
   * every add(). One process.
   */
  class XdmfSeries final : public GatheredSeries
  {
  public:
    /** @p path without an extension. Nothing is written yet. */
    explicit XdmfSeries(const std::string &path);

    void add(const VtuGrid &grid) override;
    void serialize(Archive &archive) override;

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
